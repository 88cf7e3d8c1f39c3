// A material by its energy, an element and a selector that Supple does not have, reduced and simulated.
#include <physics/mesh/mass.hpp>
#include <physics/model/solid_elasticity.hpp>
#include <physics/time/newmark.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/pipeline/reduction.hpp>

#include <batched_omp.hpp>
#include <cmath>
#include <cstdio>
#include <gent.hpp>
#include <wedge.hpp>

using namespace supple;

/// nx cubes in a row along x, each cut into two wedges.
CellMesh<6> row_of_wedges(Index nx, double edge) {
  CellMesh<6> mesh;
  mesh.nodes.resize(4 * (nx + 1), 3);
  for (Index i = 0; i <= nx; ++i)
    mesh.nodes.middleRows<4>(4 * i) << i, 0, 0, i, 1, 0, i, 1, 1, i, 0, 1;  // counter-clockwise, seen from the end
  mesh.nodes *= edge;
  for (Index a = 0; a < 4 * nx; a += 4) {
    mesh.cells.push_back({a, a + 1, a + 2, a + 4, a + 5, a + 6});
    mesh.cells.push_back({a, a + 2, a + 3, a + 4, a + 6, a + 7});
  }
  return mesh;
}

int main() {
  using Model = SolidElasticity<Wedge, Gent>;
  const CellMesh<6> mesh = row_of_wedges(40, 0.025);
  const auto full =
      std::make_shared<const FullSystem<Model>>(Model(mesh, Gent<double>::from({.young = 1e6, .poisson = 0.3})),
                                                lumped_mass<Wedge>(mesh, 1000.0), std::vector<Index>{0, 1, 2, 3});
  const auto subspace = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 4}(*full));
  const auto reduced = reduce(full, subspace, BatchedOmp{.batch = 4}, {.points = 30});
  std::printf("%td of %td wedges, training error %.3f, held out %.3f\n", reduced.report.points, mesh.num_cells(),
              reduced.report.training_error, reduced.report.held_out_error);

  const auto system = reduced.system();
  Newmark newmark(system, 0.01);
  State state = State::at_rest(system.dim());
  const auto gravity = system.project({.gravity = {0, -1, 0}});
  newmark.balance(gravity, state);
  for (int step = 0; step < 100; ++step)
    if (newmark.step(gravity, state).status != Status::Converged) return 1;
  std::printf("after %.2f s the end has moved by %.4f m\n", state.time, subspace->at(3 * 160 + 1, state.u));
  return reduced.report.training_error < 0.1 && std::isfinite(state.u.norm()) ? 0 : 1;
}
