// From a mesh to a reduced model that simulates in real time.
//
//   $ example_01_reduce_and_simulate
//   60 of 2304 tets stand for all; equilibria are 0.2 % off those of the full object
//   after 1.00 s the tip has moved by (-0.14, -0.40, 0.03) m
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/time/average_vector_field.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cstdio>

using namespace supple;

int main() {
  const TetMesh mesh = builtin_mesh("bar:24x4x4");  // or read_tet_mesh("dragon.msh")
  const Solid solid = isotropic_solid(mesh, {.young = 2e5, .poisson = 0.4}, select_nodes(mesh.nodes, "x<1%"));

  ReduceReport report;
  const ReducedModel model = reduce(solid, ReduceOptions::relaxed_derivatives(/*modes=*/10), &report);
  std::printf("%td of %td tets stand for all; equilibria are %.1f %% off those of the full object\n", report.points,
              report.components, 100 * report.full_error.total);
  save_model("bar.supple",
             model);  // load_model() reads it back; so do `supple simulate` and any safetensors reader

  const Index tip = select_nodes(mesh.nodes, "x>99%").front();
  const auto system = model.system();  // a value: keep it, copy it, pass it on
  AverageVectorField integrator(system, 0.01, {.damping = {.beta = 0.002}, .solver = Bfgs{}});
  State state = integrator.at_rest();
  const auto load = system.project({.gravity = {0, -1.5, 0}});
  integrator.balance(load, state);
  for (int step = 0; step < 100; ++step)
    if (integrator.step(load, state).status != Status::Converged) return 1;
  const Point u = system.displacement(state.u, tip);
  std::printf("after %.2f s the tip has moved by (%.2f, %.2f, %.2f) m\n", state.time, u[0], u[1], u[2]);
}
