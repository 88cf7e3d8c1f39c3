// A project outside the tree: vectors and matrices made by the installed library are used and freed here, and
// the other way round, whatever instruction set this file is compiled for.
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cstdio>

using namespace supple;

int main() {
  const TetMesh mesh = builtin_mesh("bar:8x2x2");
  const Solid solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.4}, select_nodes(mesh.nodes, "x<1%"));

  ReduceReport report;
  ReduceOptions options{.modes = 4, .points = 30};
  options.poses.count = 40;
  options.held_out_poses = 16;
  ReducedModel model = reduce(solid, options, &report);
  model.weights = 2 * model.weights;              // reallocated here
  model.rest_stiffness.conservativeResize(1, 1);  // freed here

  const FullSystem<TetElasticity<StVenantKirchhoff>> system(make_model<StVenantKirchhoff>(solid), solid.nodal_mass(),
                                                            solid.fixed_nodes);
  const Vector f = system.force(Vector::Constant(system.dim(), 1e-3));
  std::printf("d = %td, %td points, error %.3f, |f| = %.3e N\n", report.dimension, report.points, report.training_error,
              f.norm());
  return report.dimension == 36 && report.training_error < 0.5 && f.allFinite() ? 0 : 1;
}
