// A block of two materials sags under gravity (Figure 7 of the paper): the subspace knows where it is soft.
// Writes two_materials.png: Young's modulus at rest, the full solution, the reduced one.
//
//   $ example_05_two_materials
//   reduced against full: 0.8 % of the displacement
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/picture/picture.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/newmark.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cstdio>

using namespace supple;

/// Displacements of all nodes after 0.6 s of strongly damped sagging.
template <DynamicalSystem System>
Vector sag(const System& system) {
  Newmark newmark(system, 0.02, {.damping = {.alpha = 8}});
  State state = State::at_rest(system.dim());
  const auto gravity = system.project({.gravity = {0, -9.81, 0}});
  newmark.balance(gravity, state);
  for (int step = 0; step < 30; ++step)
    if (newmark.step(gravity, state).status != Status::Converged) throw SolverError("a step did not converge");
  return state.u;
}

int main() {
  const TetMesh mesh = builtin_mesh("bar:18x6x6");
  Solid solid = isotropic_solid(mesh, {.young = 8e4, .poisson = 0.4}, select_nodes(mesh.nodes, "x<1%"));
  const std::vector<double> soft = material_law("stvk").values({.young = 1e4, .poisson = 0.4});
  solid.parameters.conservativeResize(2, Eigen::NoChange);
  solid.parameters.row(1) = Eigen::Map<const Eigen::RowVectorXd>(soft.data(), static_cast<Index>(soft.size()));
  for (const Tet& tet : mesh.cells) {  // stiff below, soft above
    double y = 0;
    for (const Index v : tet) y += mesh.nodes(v, 1) / 4;
    solid.material_of_cell.push_back(y > bounding_box(mesh.nodes).extent().y() / 2 ? 1 : 0);
  }

  const FullSystem full(make_model<StVenantKirchhoff>(solid), solid.nodal_mass(), solid.fixed_nodes);
  const Vector u_full = full.expand(sag(full));
  const ReducedModel model = reduce(solid, {.modes = 15, .points = 150});
  const auto reduced = model.system();
  const Vector u = reduced.expand(sag(reduced));
  const double deviation = (u - u_full).norm() / u_full.norm();
  std::printf("reduced against full: %.1f %% of the displacement\n", 100 * deviation);

  Vector young = Vector::Zero(mesh.num_nodes());
  for (Index e = 0; e < mesh.num_cells(); ++e)
    for (const Index v : mesh.cells[e]) young[v] = std::max(young[v], solid.material_of_cell[e] == 0 ? 8e4 : 1e4);
  const std::vector<Triangle> surface = boundary_faces(mesh);
  std::vector<PictureObject> objects;
  for (const auto& [caption, displacement] :
       {std::pair{"at rest", Vector(Vector::Zero(u.size()))}, {"full", u_full}, {"reduced", u}}) {
    PictureObject object{.positions = mesh.nodes + Eigen::Map<const Points>(displacement.data(), mesh.num_nodes(), 3),
                         .triangles = surface};
    object.scalar = young;
    object.caption = caption;
    objects.push_back(object);
  }
  write_png("two_materials.png", draw_picture(objects, {.width = 1500, .height = 600}));
  return deviation < 0.1 ? 0 : 1;
}
