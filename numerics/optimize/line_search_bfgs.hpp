#pragma once
/// \file The BFGS method with a line search: quasi-Newton minimisation from a given inverse Hessian.

#include <numerics/optimize/bfgs_memory.hpp>
#include <numerics/optimize/newton.hpp>

namespace supple {

/// R A⁻¹ Rᵀ of what a solver holds, under rotations of the unknowns.
template <typename Solver>
struct TurnedSolver {
  const Solver& solver;
  BlockRotations frames = {};

  Vector solve(Vector g) const {
    frames.turn_back(g);
    Vector x = solver.solve(g);
    frames.turn(x);
    return x;
  }
};

/// Minimises by BFGS steps whose lengths are searched: for statics, far from the minimum (the paper's choice for reduced
/// systems). The first inverse Hessian turns with the unknowns where the objective tells how they do (stiffness warping,
/// Müller et al. 2002).
struct LineSearchBfgs {
  /// After so many steps that are in the memory the Hessian is computed and factorised afresh, shifted if it is not
  /// definite; 0: never, as the paper does. In large motions the Hessian at rest is a poor start.
  Index refresh_after = 0;
  Index memory = BfgsMemory::unlimited;  ///< steps kept

  /// Improves u until the residual ‖g‖ / scale is at most the tolerance. The matrix never appears: steps are kept and
  /// applied to what `solver` holds, O(k d) after k steps beside one solve (Dennis & Schnabel 1987, Sec. 9; Nocedal &
  /// Wright 2006, Sec. 7.2). Steps satisfy the Wolfe conditions, or their approximate form (Hager & Zhang 2005) where
  /// values differ by rounding only.
  /// \param solver  holds a factorised matrix close to the Hessian, such as the one at rest.
  template <SmoothObjective O>
  SolveReport operator()(O& objective, SpdSolver<typename O::MatrixType>& solver, Vector& u,
                         const SolveLimits& limits = {}) const {
    SolveReport report;
    BfgsMemory steps(memory);
    TurnedSolver<SpdSolver<typename O::MatrixType>> inverse{solver};
    ShiftedHessian<typename O::MatrixType> hessian;
    Vector g(u.size()), g_trial(u.size()), trial(u.size());
    objective.gradient(u, g);
    double value = objective.value(u), scale = objective.scale(u);
    const auto finish = [&](Status status) {
      report.status = status;
      return report;
    };
    for (;;) {
      report.residual = relative_residual(g.norm(), scale);
      if (!std::isfinite(report.residual) || !std::isfinite(value)) return finish(Status::NotFinite);
      if (report.residual <= limits.tolerance) return finish(Status::Converged);
      if (report.iterations == limits.max_iterations) return finish(Status::MaxIterations);
      if (report.iterations % turned_every == 0 && report.tangents == 0) inverse.frames = frames_of(objective, u);
      ++report.iterations;
      if (refresh_after > 0 && steps.size() >= refresh_after) {
        if (!hessian.factorize(objective, solver, u)) return finish(Status::Stagnated);
        inverse.frames = {};  // it is the Hessian here
        steps.clear();
        ++report.tangents;
      }

      Vector step = -steps.inverse_times(inverse, g);
      double slope = g.dot(step);
      if (!(slope < 0)) {  // rounding has spoilt the memory
        steps.clear();
        step = -inverse.solve(g);
        slope = g.dot(step);
        if (!(slope < 0)) return finish(Status::Stagnated);
      }
      // the step length by bisection and doubling between what is too long and what is too short
      const double rounding = 1e-13 * std::abs(value);
      double t = 1, low = 0, high = std::numeric_limits<double>::infinity(), value_trial = 0;
      bool found = false;
      for (int attempt = 0; attempt < 40 && !found; ++attempt) {
        trial = u + t * step;
        objective.gradient(trial, g_trial);
        value_trial = objective.value(trial);
        const double slope_trial = g_trial.dot(step);
        const bool decreases =
            value_trial <= value + 1e-4 * t * slope || (value_trial <= value + rounding && slope_trial <= -0.8 * slope);
        if (!decreases || !std::isfinite(slope_trial))
          high = t;
        else if (slope_trial < 0.9 * slope)
          low = t;
        else
          found = true;
        if (!found) t = std::isfinite(high) ? 0.5 * (low + high) : 2 * t;
      }
      if (!found) {
        if (steps.size() == 0) {
          objective.gradient(u, g);
          return finish(Status::Stagnated);
        }
        steps.clear();  // once more along the preconditioned gradient
        continue;
      }
      scale = objective.scale(trial);
      value = value_trial;
      steps.add(trial - u, g_trial - g);
      u.swap(trial);
      g.swap(g_trial);
    }
  }

 private:
  static constexpr Index turned_every = 8;  // iterations; frames hardly change in between
};

}  // namespace supple
