#pragma once
/// \file Quasi-Newton steps from a given inverse Jacobian, which is refreshed when it no longer helps.

#include <numerics/optimize/bfgs_memory.hpp>
#include <numerics/optimize/newton.hpp>

#include <vector>

namespace supple {

/// What steps tell about a Jacobian, symmetric or not, by the "good" Broyden method with the steps in memory
/// instead of matrices: each takes O(d) beside one product with B₀⁻¹ (Dennis & Schnabel 1987, Sec. 8; Kelley
/// 1995, Sec. 7.3). Each step has to be the −B⁻¹ g that this memory gives, and start where the last one ended.
class BroydenMemory {
 public:
  /// y, the change of g over the step, follows from g in the next call of inverse_times.
  void add(Vector s, VectorIn /*y*/) {
    squared_norms_.push_back(s.squaredNorm());
    steps_.push_back(std::move(s));
  }
  void clear() {
    steps_.clear();
    squared_norms_.clear();
  }

  /// B⁻¹ g, B₀ being what the solver holds and g the gradient after the last step.
  template <typename Solver>
  Vector inverse_times(const Solver& solver, VectorIn g) const {
    Vector d = solver.solve(g);
    for (std::size_t j = 0; j + 1 < steps_.size(); ++j) d += steps_[j + 1] * (steps_[j].dot(d) / squared_norms_[j]);
    if (!steps_.empty()) d /= 1 + steps_.back().dot(d) / squared_norms_.back();
    return d;
  }

 private:
  std::vector<Vector> steps_;
  std::vector<double> squared_norms_;
};

/// Solves g(u) = 0 by full quasi-Newton steps. `solver` holds B₀; if convergence is too slow, a Newton step with
/// line search replaces it, clears the memory, and the solver keeps the new one for later calls.
/// \param memory        a BroydenMemory that is empty, or a BfgsMemory, which may know steps of similar problems.
/// \param refresh_cost  see Bfgs.
template <SmoothObjective O, typename Memory>
SolveReport quasi_newton_solve(O& objective, SpdSolver<typename O::MatrixType>& solver, Memory& memory, Vector& u,
                               const SolveLimits& limits = {}, double refresh_cost = 20) {
  SolveReport report;
  Vector g(u.size()), g_trial(u.size());
  objective.gradient(u, g);
  ShiftedHessian<typename O::MatrixType> hessian;
  // Progress is judged by ‖g‖ itself: far away the scale grows as fast, and ‖g‖ / scale tells nothing.
  double norm = g.norm(), first_norm = norm, scale = objective.scale(u);
  double taken = 0;  // steps since the last refresh
  for (;;) {
    report.residual = relative_residual(norm, scale);
    if (!std::isfinite(report.residual)) return report.status = Status::NotFinite, report;
    if (report.residual <= limits.tolerance) return report.status = Status::Converged, report;
    if (report.iterations >= limits.max_iterations) return report.status = Status::MaxIterations, report;
    ++report.iterations;

    Vector step = -memory.inverse_times(solver, g);
    const Vector trial = u + step;
    objective.gradient(trial, g_trial);
    const double trial_norm = g_trial.norm(), trial_scale = objective.scale(trial);
    const double target = limits.tolerance * trial_scale;

    ++taken;
    const double rate = std::log(trial_norm / first_norm) / taken;  // of the logarithm of ‖g‖, per iteration
    const bool slow =
        !(trial_norm < 2 * norm) || (taken >= 2 && !(std::log(target / trial_norm) / rate <= refresh_cost && rate < 0));
    if (!slow || trial_norm <= target) {
      memory.add(std::move(step), g_trial - g);
      u = trial;
      g = g_trial;
      norm = trial_norm;
      scale = trial_scale;
      continue;
    }
    if (trial_norm < norm) {
      u = trial;
      g = g_trial;
    }
    const bool decreased = newton_step(objective, solver, hessian, u, g);
    memory.clear();
    objective.gradient(u, g);
    norm = first_norm = g.norm();
    scale = objective.scale(u);
    if (!decreased) {
      report.residual = relative_residual(norm, scale);
      return report.status = Status::Stagnated, report;
    }
    ++report.tangents;
    taken = 0;
  }
}

/// Quasi-Newton steps by the BFGS formula from a Jacobian that is near, which learn from one solve to the next: the
/// fastest for time steps of reduced systems.
struct Bfgs {
  /// The Jacobian is computed afresh when convergence so far predicts more than this many further iterations.
  /// About the cost of a tangent and its factorisation in evaluations of the force; lower it for violent
  /// motions.
  double refresh_cost = 20;
  Index memory = 60;  ///< steps kept; more help little and take longer than they save

  /// \see quasi_newton_solve
  template <SmoothObjective O>
  SolveReport operator()(O& objective, SpdSolver<typename O::MatrixType>& solver, BfgsMemory& steps, Vector& u,
                         const SolveLimits& limits = {}) const {
    return quasi_newton_solve(objective, solver, steps, u, limits, refresh_cost);
  }
};

/// Quasi-Newton steps by Broyden's formula, which begins each solve anew (the paper's choice for reduced systems).
struct Broyden {
  double refresh_cost = 20;  ///< as of Bfgs

  template <SmoothObjective O>
  SolveReport operator()(O& objective, SpdSolver<typename O::MatrixType>& solver, Vector& u,
                         const SolveLimits& limits = {}) const {
    BroydenMemory memory;
    return quasi_newton_solve(objective, solver, memory, u, limits, refresh_cost);
  }
};

}  // namespace supple
