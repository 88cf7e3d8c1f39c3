// A spring pulls at a bar (Figure 8 of the paper): the full system, the reduced model with fitted forces, and as many linear
// modes with exact forces.

#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/picture/picture.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/statics/static_solver.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/system/galerkin_system.hpp>

#include <cstdio>

using namespace supple;

int main() {
  using Model = TetElasticity<StVenantKirchhoff>;
  const TetMesh mesh = builtin_mesh("bar:24x6x4");
  const Solid solid = isotropic_solid(mesh, {.young = 2e5, .poisson = 0.4}, select_nodes(mesh.nodes, "x<=0"));
  Loads pull;  // the end of the bar to half its length aside
  for (const Index v : select_nodes(mesh.nodes, "x>=1")) pull.springs.push_back({v, 50.0, Point(-0.2, 0, 0.5)});

  std::vector<PictureObject> objects;
  std::vector<Vector> shapes;
  const auto solve = [&](const char* name, const auto& system) {
    StaticSolver solver(system);
    Vector u = Vector::Zero(system.dim());
    SolveReport report;
    for (const double share : {0.25, 0.5, 0.75, 1.0}) {
      Loads part = pull;
      for (PointSpring& spring : part.springs) spring.displacement *= share;
      report = solver.solve(system.project(part), u);
    }
    shapes.push_back(system.expand(u));
    const double off = (shapes.back() - shapes.front()).norm() / shapes.front().norm();
    std::printf("%-22s %6ld unknowns, energy %.4g J, off by %.2f %%, residual %.0e\n", name,
                static_cast<long>(system.dim()), system.energy(u), 100 * off, report.residual);
    PictureObject object{.positions = mesh.nodes + Eigen::Map<const Points>(shapes.back().data(), mesh.num_nodes(), 3),
                         .triangles = boundary_faces(mesh)};
    object.caption = name;
    objects.push_back(std::move(object));
    return off;
  };

  const auto full = std::make_shared<const FullSystem<Model>>(make_model<StVenantKirchhoff>(solid), solid.nodal_mass(),
                                                              solid.fixed_nodes);
  (void)solve("full", *full);
  const ReducedModel model = reduce(solid, {.modes = 12, .points = 150});
  const double extended = solve("extended, 150 tets", model.system());
  const auto modes = std::make_shared<const DenseBasis>(ModalBasis{.num_modes = model.dim()}(*full));
  const GalerkinSystem<Model, DenseBasis> linear(full, modes);
  const double off = solve("linear modes, all tets", linear);
  write_png("spring_pull.png", draw_picture(objects));
  return extended < off ? 0 : 1;
}
