#pragma once
/// \file Broyden's method: quasi-Newton steps from a given inverse Jacobian, refreshed when it no longer
/// helps.

#include <physics/newton.hpp>

#include <vector>

namespace supple {

struct BroydenOptions {
  double tolerance = 1e-6;    ///< relative residual ‖g‖ / scale to reach
  Index max_iterations = 60;  ///< evaluations of the force, all together
  /// The Jacobian is computed afresh when convergence so far predicts more than this many further iterations.
  /// About the cost of a tangent and its factorisation in evaluations of the force; lower it for violent
  /// motions.
  double refresh_cost = 10;
};

struct BroydenReport : Report {
  Index refreshes = 0;  ///< Newton steps, each of which left a new Jacobian in the solver
};

/// Solves g(u) = 0 by the "good" Broyden method with memory of the steps instead of matrices: s_{k+1} follows
/// from B₀⁻¹ g by k rank-one corrections (Dennis & Schnabel 1987, Sec. 8; Kelley 1995, Sec. 7.3), O(k d) each
/// beside one product with B₀⁻¹. B₀ is what `solver` holds, and if convergence is too slow, a Newton step
/// with line search replaces it; the solver keeps the new one for later calls.
template <SmoothObjective O>
BroydenReport broyden_solve(O& objective, SpdSolver<typename O::MatrixType>& solver, Vector& u,
                            const BroydenOptions& options = {}) {
  BroydenReport report;
  Vector g(u.size()), g_trial(u.size());
  objective.gradient(u, g);
  detail::ShiftedHessian<typename O::MatrixType> hessian;
  std::vector<Vector> steps;  // s_0 … s_k since the last refresh
  std::vector<double> squared_norms;
  // Progress is judged by ‖g‖ itself: far away the scale grows as fast, and ‖g‖ / scale tells nothing.
  double norm = g.norm(), first_norm = norm, scale = objective.scale(u);
  for (;;) {
    report.residual = detail::relative(norm, scale);
    if (!std::isfinite(report.residual)) return report.status = Status::NotFinite, report;
    if (report.residual <= options.tolerance) return report.status = Status::Converged, report;
    if (report.iterations >= options.max_iterations) return report.status = Status::MaxIterations, report;
    ++report.iterations;

    Vector step = -solver.solve(g);
    for (std::size_t j = 0; j + 1 < steps.size(); ++j)
      step += steps[j + 1] * (steps[j].dot(step) / squared_norms[j]);
    if (!steps.empty()) step /= 1 - steps.back().dot(step) / squared_norms.back();
    const Vector trial = u + step;
    objective.gradient(trial, g_trial);
    const double trial_norm = g_trial.norm(), trial_scale = objective.scale(trial);
    const double target = options.tolerance * trial_scale;

    const double taken = static_cast<double>(steps.size()) + 1;
    const double rate = std::log(trial_norm / first_norm) / taken;  // of the logarithm of ‖g‖, per iteration
    const bool slow =
        !(trial_norm < 2 * norm) ||
        (taken >= 2 && !(std::log(target / trial_norm) / rate <= options.refresh_cost && rate < 0));
    if (!slow || trial_norm <= target) {
      u = trial;
      g = g_trial;
      norm = trial_norm;
      scale = trial_scale;
      squared_norms.push_back(step.squaredNorm());
      steps.push_back(std::move(step));
      continue;
    }
    if (trial_norm < norm) {
      u = trial;
      g = g_trial;
    }
    const bool decreased = detail::newton_step(objective, solver, hessian, u, g);
    objective.gradient(u, g);
    norm = first_norm = g.norm();
    scale = objective.scale(u);
    if (!decreased) {
      report.residual = detail::relative(norm, scale);
      return report.status = Status::Stagnated, report;
    }
    ++report.refreshes;
    steps.clear();
    squared_norms.clear();
  }
}

}  // namespace supple
