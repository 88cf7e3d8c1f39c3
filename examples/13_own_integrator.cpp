// An integrator of one's own beside two of ours: a chain of springs swings, and what becomes of its energy.
//
//   $ example_13_own_integrator
//   midpoint             energy ends at 100.2 % of the start
//   Newmark              energy ends at  99.6 % of the start
//   generalised-alpha    energy ends at  90.1 % of the start
#include <physics/model/spring_model.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/generalized_alpha.hpp>
#include <physics/time/newmark.hpp>

#include <cmath>
#include <cstdio>

#include "midpoint.hpp"

using namespace supple;

/// Twenty point masses on a line, held at one end and kicked aside at the other.
FullSystem<SpringModel> chain() {
  Points nodes = Points::Zero(21, 3);
  nodes.col(0).setLinSpaced(0, 1);
  std::vector<std::array<Index, 2>> springs;
  for (Index k = 0; k < 20; ++k) springs.push_back({k, k + 1});
  return {SpringModel(nodes, springs, 500.0), Vector::Constant(21, 0.01), {0}};
}

template <typename Integrator, typename System>
double energy_left(const char* name, Integrator integrator, const System& system) {
  const SystemLoad<SparseMatrix> nothing{Vector::Zero(system.dim()), {}};
  State state = integrator.at_rest();
  state.v.tail<3>() << 0.02, 0.05, 0;
  integrator.balance(nothing, state);
  const double start = integrator.energy(state);
  for (int step = 0; step < 500; ++step)
    if (integrator.step(nothing, state).status != Status::Converged) throw SolverError("a step did not converge");
  const double left = integrator.energy(state) / start;
  std::printf("%-20s energy ends at %5.1f %% of the start\n", name, 100 * left);
  return left;
}

int main() {
  const auto system = chain();
  const StepOptions options{.tolerance = 1e-10};
  const double own = energy_left("midpoint", Midpoint(system, 0.01, options), system);
  energy_left("Newmark", Newmark(system, 0.01, options), system);
  energy_left("generalised-alpha", GeneralizedAlpha(system, 0.01, options), system);
  return std::abs(own - 1) < 0.02 ? 0 : 1;
}
