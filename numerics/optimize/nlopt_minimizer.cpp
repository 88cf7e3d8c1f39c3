#include <core/check.hpp>
#include <numerics/optimize/nlopt_minimizer.hpp>

#include <nlopt.hpp>

#include <cmath>
#include <limits>

namespace supple {

namespace {

nlopt::algorithm algorithm(NloptMethod method) {
  switch (method) {
    case NloptMethod::Lbfgs:
      return nlopt::LD_LBFGS;
    case NloptMethod::VariableMetric:
      return nlopt::LD_VAR2;
    case NloptMethod::TruncatedNewton:
      return nlopt::LD_TNEWTON_RESTART;
    case NloptMethod::Slsqp:
      return nlopt::LD_SLSQP;
  }
  throw std::invalid_argument("unknown method of NLopt");
}

/// The objective in NLopt's variables, with the best iterate so far. NLopt's methods end where no entry of the gradient is
/// above 1e-8, whatever the units: theirs are chosen so that the first gradient has the length 1e9 while the Hessian stays.
/// And they compare values, which rounding makes equal long before the gradient vanishes: near the best iterate, values are
/// the integral of the gradient from there, by the trapezoidal rule.
struct Run {
  const ValueAndGradient& objective;
  const std::function<double(VectorIn, VectorIn)>& residual;
  const Matrix& L;
  double tolerance;
  Vector best;
  Report report;
  Vector best_gradient = {};
  double first_value = 0, best_value = 0;  // the second above the first
  double unit = 1;                         // of the variables; its square is that of the value

  Vector to_u(const Vector& y) const {
    return unit * (L.size() > 0 ? Vector(L.transpose().triangularView<Eigen::Upper>().solve(y)) : y);
  }
  Vector from_u(const Vector& u) const { return (L.size() > 0 ? Vector(L.transpose() * u) : u) / unit; }
  /// Of y, from that of u.
  Vector to_gradient(const Vector& g) const {
    return (L.size() > 0 ? Vector(L.triangularView<Eigen::Lower>().solve(g)) : g) / unit;
  }
  /// From the best iterate on.
  void begin() {
    best_gradient.resize(best.size());
    first_value = objective(best, best_gradient);
    best_value = 0;
    unit = 1;
    const double length = to_gradient(best_gradient).norm();
    if (length > 0 && std::isfinite(length)) unit = length / 1e9;
  }
  /// value − first_value, to more digits than the difference has.
  double rise(double value, const Vector& u, const Vector& g) const {
    const double difference = value - first_value, near = 1e-8 * std::abs(value);
    const Vector step = u - best;
    if (!(std::abs(difference - best_value) < near && std::abs(step.dot(g - best_gradient)) < near)) return difference;
    return best_value + 0.5 * step.dot(g + best_gradient);
  }

  static double evaluate(unsigned n, const double* y, double* gradient, void* self) {
    return static_cast<Run*>(self)->evaluate(Eigen::Map<const Vector>(y, n), gradient);
  }
  double evaluate(const Vector& y, double* gradient) {
    const Vector u = to_u(y);
    Vector g(u.size());
    const double value = rise(objective(u, g), u, g);
    ++report.iterations;
    const double reached = residual(u, g);
    if (std::isfinite(value) && reached < report.residual) {
      report.residual = reached;
      best = u;
      best_gradient = g;
      best_value = value;
      if (reached <= tolerance) throw nlopt::forced_stop();
    }
    if (gradient) Eigen::Map<Vector>(gradient, g.size()) = to_gradient(g);
    return std::isfinite(value) ? value / (unit * unit) : HUGE_VAL;
  }
};

}  // namespace

Report minimize_by_nlopt(const ValueAndGradient& objective,
                         const std::function<double(VectorIn u, VectorIn g)>& residual, Vector& u,
                         const NloptOptions& options, const Matrix& preconditioner) {
  if (preconditioner.size() > 0) require_size("preconditioner.rows()", preconditioner.rows(), u.size());
  Run run{objective, residual, preconditioner, options.tolerance, u, {}};
  // where it gives up it begins anew, as long as that helps
  for (double last = std::numeric_limits<double>::infinity();; last = run.report.residual) {
    run.begin();
    nlopt::opt minimizer(algorithm(options.method), static_cast<unsigned>(u.size()));
    minimizer.set_min_objective(&Run::evaluate, &run);
    minimizer.set_maxeval(static_cast<int>(options.max_evaluations - run.report.iterations));
    const Vector y = run.from_u(run.best);
    std::vector<double> x(y.begin(), y.end());
    double value = 0;
    run.report.status = Status::Stagnated;
    try {
      (void)minimizer.optimize(x, value);
    } catch (const std::runtime_error&) {  // stopped by us, or "nlopt failure": a line search found nothing better
    }
    if (run.report.residual <= options.tolerance || !(run.report.residual < 0.5 * last)) break;
    if (run.report.iterations >= options.max_evaluations) {
      run.report.status = Status::MaxIterations;
      break;
    }
  }
  if (run.report.residual <= options.tolerance) run.report.status = Status::Converged;
  if (!std::isfinite(run.report.residual)) run.report.status = Status::NotFinite;
  u = run.best;
  return run.report;
}

}  // namespace supple
