#pragma once
/// \file Newton's method with a safeguarded line search: minimising a smooth function, and solving equations
/// that are no gradient of one.

#include <numerics/linear/spd_solver.hpp>
#include <numerics/optimize/objective.hpp>

#include <cmath>
#include <limits>

namespace supple {

/// Hessians, shifted by a multiple of the metric where that makes them positive definite. The shift is as small as it
/// can cheaply be, or steps along soft directions would be short: the last one is the guess for the next.
/// \see Wächter & Biegler 2006, Algorithm IC.
template <typename MatrixType>
class ShiftedHessian {
 public:
  /// H(u) into the solver. False if no shift makes it definite.
  template <SmoothObjective O>
  bool factorize(O& objective, SpdSolver<MatrixType>& solver, VectorIn u) {
    objective.hessian(u, H_);
    return factorize(objective.metric(), solver);
  }
  /// The same at rest.
  template <SmoothObjective O>
  bool factorize_at_rest(O& objective, SpdSolver<MatrixType>& solver) {
    rest_hessian(objective, H_);
    return factorize(objective.metric(), solver);
  }
  const MatrixType& matrix() const { return H_; }    ///< as it was factorised
  bool was_definite() const { return shift_ == 0; }  ///< whether it needed no shift

 private:
  bool factorize(const Vector& metric, SpdSolver<MatrixType>& solver) {
    const double unit = H_.norm() / metric.norm();
    shift_ = 0;
    while (!solver.factorize(H_)) {
      const bool first = last_shift_ == 0;
      const double next = shift_ > 0 ? (first ? 100 : 8) * shift_ : first ? 1e-8 : std::max(1e-14, last_shift_ / 3);
      if (!(unit > 0) || !std::isfinite(next * unit)) return false;
      add_diagonal(H_, (next - shift_) * unit * metric);
      shift_ = next;
    }
    if (shift_ > 0) last_shift_ = shift_;
    return true;
  }
  MatrixType H_;
  double shift_ = 0, last_shift_ = 0;  // over ‖H‖ / ‖metric‖
};

/// One step from u along −H⁻¹ g, shortened until φ decreases enough (Armijo) unless the full step already
/// reduces ‖g‖, with H shifted as above; where there is no φ, until ‖g‖ decreases. g is updated to the new u.
/// \return false if no decrease was found (u stays).
template <SmoothObjective O>
bool newton_step(O& objective, SpdSolver<typename O::MatrixType>& solver,
                 ShiftedHessian<typename O::MatrixType>& hessian, Vector& u, Vector& g) {
  if (!hessian.factorize(objective, solver, u)) return false;
  const Vector step = -solver.solve(g);
  const double slope = g.dot(step);
  if (!std::isfinite(slope) || slope >= 0) return false;

  Vector trial = u + step, g_trial(g.size());
  objective.gradient(trial, g_trial);
  const double norm = g.norm();
  const auto accept = [&] {
    u.swap(trial);
    g.swap(g_trial);
    return true;
  };
  if (g_trial.norm() < norm) return accept();  // false for NaN
  if (!has_value(objective)) {
    for (double t = 0.5; t > 1e-10; t *= 0.5) {
      trial = u + t * step;
      objective.gradient(trial, g_trial);
      if (g_trial.norm() <= (1 - 1e-4 * t) * norm) return accept();
    }
    return false;
  }
  const double value = objective.value(u);
  const double rounding = std::numeric_limits<double>::epsilon() * std::abs(value);
  for (double t = 1; t > 1e-10 && -t * slope > rounding; t *= 0.5) {
    trial = u + t * step;
    if (objective.value(trial) <= value + 1e-4 * t * slope) {  // false for NaN
      u.swap(trial);
      objective.gradient(u, g);
      return true;
    }
  }
  return false;
}

/// Newton's method: the tangent computed and factorised at every step. For full systems and violent motions.
struct Newton {
  /// Improves u until the residual ‖g‖ / scale is at most the tolerance.
  /// \param solver  is left holding the last factorised Hessian.
  /// \return residual reached; Stagnated when rounding allows no further decrease, NotFinite if the start
  /// already is.
  template <SmoothObjective O>
  SolveReport operator()(O& objective, SpdSolver<typename O::MatrixType>& solver, Vector& u,
                         const SolveLimits& limits = {}) const {
    ShiftedHessian<typename O::MatrixType> hessian;
    Vector g(u.size());
    objective.gradient(u, g);
    SolveReport report;
    for (report.iterations = 0;; ++report.iterations) {
      report.tangents = report.iterations;
      report.residual = relative_residual(g.norm(), objective.scale(u));
      if (!std::isfinite(report.residual)) return report.status = Status::NotFinite, report;
      if (report.residual <= limits.tolerance) return report.status = Status::Converged, report;
      if (report.iterations == limits.max_iterations) return report.status = Status::MaxIterations, report;
      if (!newton_step(objective, solver, hessian, u, g)) {
        objective.gradient(u, g);
        return report.status = Status::Stagnated, report;
      }
    }
  }

  /// Improves u until the residual ‖r‖ / scale is at most the tolerance; steps are shortened until ‖r‖ decreases enough,
  /// along −J⁻¹ r, which for small steps it always does.
  /// \param solver  an SpdSolver or LuSolver; is left holding the last factorised Jacobian.
  /// \return residual reached; Stagnated when rounding allows no further decrease or J could not be factorised,
  /// NotFinite if the start already is.
  template <SmoothEquation E, typename Solver>
  SolveReport operator()(E& equation, Solver& solver, Vector& u, const SolveLimits& limits = {}) const {
    typename E::MatrixType J;
    Vector r(u.size()), r_trial(u.size());
    equation.residual(u, r);
    SolveReport report;
    for (report.iterations = 0;; ++report.iterations) {
      report.tangents = report.iterations;
      const double norm = r.norm();
      report.residual = relative_residual(norm, equation.scale(u));
      if (!std::isfinite(report.residual)) return report.status = Status::NotFinite, report;
      if (report.residual <= limits.tolerance) return report.status = Status::Converged, report;
      if (report.iterations == limits.max_iterations) return report.status = Status::MaxIterations, report;
      equation.jacobian(u, J);
      if (!solver.factorize(J)) return report.status = Status::Stagnated, report;
      const Vector step = -solver.solve(r);
      double t = 1;
      Vector trial = u + step;
      equation.residual(trial, r_trial);
      while (!(r_trial.norm() <= (1 - 1e-4 * t) * norm)) {  // true for NaN
        t *= 0.5;
        if (t < 1e-10) return report.status = Status::Stagnated, report;
        trial = u + t * step;
        equation.residual(trial, r_trial);
      }
      u.swap(trial);
      r.swap(r_trial);
    }
  }
};

}  // namespace supple
