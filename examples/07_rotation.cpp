// Why extended modes (Figure 5 of the paper): a rotation in the linear modes of a cube inflates it; under all linear maps of
// the same modes it is there exactly.

#include <io/builtin/builtin_meshes.hpp>
#include <io/picture/picture.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/editing/handles.hpp>

#include <cstdio>
#include <numbers>

using namespace supple;

int main() {
  const TetMesh mesh = builtin_mesh("cube:5");
  const FullSystem system(
      TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.4})),
      lumped_mass(mesh, 1000.0));
  const DenseBasis linear = ModalBasis{.num_modes = 7}(system);  // six rigid ones, linearised, and one more
  const NodalBasis extended = ExtendedModalBasis{.num_modes = 7}(system);

  const RigidMotion turn = RigidMotion::turn({0, 0, 1}, std::numbers::pi / 3, {0.5, 0.5, 0.5});
  Vector rotation(3 * mesh.num_nodes());
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    const Point x = mesh.nodes.row(v).transpose();
    rotation.segment<3>(3 * v) = turn(x) - x;
  }
  std::vector<PictureObject> objects;
  double errors[2] = {};
  const auto show = [&](const char* name, const auto& basis, double& error) {
    Vector weighted = rotation;  // the closest displacement in the subspace, by mass
    for (Index v = 0; v < mesh.num_nodes(); ++v) weighted.segment<3>(3 * v) *= system.nodal_mass()[v];
    const Vector u = basis.reconstruct(basis.project(weighted));
    TetMesh moved = mesh;
    moved.nodes += Eigen::Map<const Points>(u.data(), mesh.num_nodes(), 3);
    double volume = 0;
    for (Index e = 0; e < moved.num_cells(); ++e) volume += tet_volume(moved, e);
    error = (u - rotation).norm() / rotation.norm();
    std::printf("%s: d = %ld, volume %.3f of 1, energy %.2g J, off by %.1e\n", name, static_cast<long>(basis.dim()),
                volume, system.energy(u), error);
    PictureObject object{.positions = moved.nodes, .triangles = boundary_faces(mesh)};
    object.caption = name;
    objects.push_back(std::move(object));
  };
  show("linear modes", linear, errors[0]);
  show("extended modes", extended, errors[1]);
  write_png("rotation.png", draw_picture(objects));
  return errors[1] < 1e-10 && errors[0] > 0.01 ? 0 : 1;
}
