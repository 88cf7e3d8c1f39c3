// A force from outside of one's own: a plate in the wind, in full and reduced.
//
//   $ example_14_wind
//   the wind bends the edge of the plate by 1.90 m; reduced, 1.2 % off
#include <io/builtin/builtin_surfaces.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/body/body_system.hpp>
#include <physics/time/newmark.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cmath>
#include <cstdio>
#include <numeric>

#include "wind.hpp"

using namespace supple;

int main() {
  const TriangleMesh mesh = builtin_surface("plate:12x12");
  const Shell shell =
      isotropic_shell(mesh, {.young = 2e6, .poisson = 0.3}, /*thickness=*/0.01, select_nodes(mesh.nodes, "x<1%"), 200);
  TouchedNodes where{mesh.nodes, std::vector<Index>(mesh.num_nodes()), {}, mesh.triangles};
  std::iota(where.nodes.begin(), where.nodes.end(), Index{0});

  Loads loads;
  loads.others.push_back(Wind(where, {.y = -5}));
  const Index edge = select_nodes(mesh.nodes, "x>99%").front();
  const auto bent = [&](const auto& system) {
    Newmark newmark(system, 0.02, {.damping = {.alpha = 3}});
    State state = newmark.at_rest();
    const auto load = system.project(loads);  // evaluated where the plate is, on the rows of the basis that it touches
    newmark.balance(load, state);
    for (int step = 0; step < 100; ++step)
      if (newmark.step(load, state).status == Status::NotFinite) throw SolverError("the plate is blown away");
    return system.displacement(state.u, edge);
  };
  const ReducedModel model = reduce(shell, {.modes = 8, .points = 150});
  const Point full = bent(full_system(shell)), reduced = bent(model.system());
  const double off = (full - reduced).norm() / full.norm();
  std::printf("the wind bends the edge of the plate by %.2f m; reduced, %.1f %% off\n", full.norm(), 100 * off);
  return full.norm() > 0.01 && off < 0.2 ? 0 : 1;
}
