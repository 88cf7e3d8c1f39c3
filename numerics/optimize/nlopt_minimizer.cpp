#include <core/check.hpp>
#include <numerics/optimize/nlopt_minimizer.hpp>

#include <nlopt.hpp>

#include <cmath>

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

/// The objective in NLopt's variables, with the best iterate so far.
struct Run {
  const ValueAndGradient& objective;
  const std::function<double(VectorIn, VectorIn)>& residual;
  const Matrix& L;
  double tolerance;
  Vector best;
  Report report;

  Vector to_u(const Vector& y) const {
    return L.size() > 0 ? Vector(L.transpose().triangularView<Eigen::Upper>().solve(y)) : y;
  }

  static double evaluate(unsigned n, const double* y, double* gradient, void* self) {
    return static_cast<Run*>(self)->evaluate(Eigen::Map<const Vector>(y, n), gradient);
  }
  double evaluate(const Vector& y, double* gradient) {
    const Vector u = to_u(y);
    Vector g(u.size());
    const double value = objective(u, g);
    ++report.iterations;
    const double reached = residual(u, g);
    if (std::isfinite(value) && reached < report.residual) {
      report.residual = reached;
      best = u;
      if (reached <= tolerance) throw nlopt::forced_stop();
    }
    if (gradient)
      Eigen::Map<Vector>(gradient, g.size()) = L.size() > 0 ? Vector(L.triangularView<Eigen::Lower>().solve(g)) : g;
    return std::isfinite(value) ? value : HUGE_VAL;
  }
};

}  // namespace

Report minimize_by_nlopt(const ValueAndGradient& objective,
                         const std::function<double(VectorIn u, VectorIn g)>& residual, Vector& u,
                         const NloptOptions& options, const Matrix& preconditioner) {
  if (preconditioner.size() > 0) require_size("preconditioner.rows()", preconditioner.rows(), u.size());
  Run run{objective, residual, preconditioner, options.tolerance, u, {}};
  const Vector y = preconditioner.size() > 0 ? Vector(preconditioner.transpose() * u) : u;
  nlopt::opt minimizer(algorithm(options.method), static_cast<unsigned>(u.size()));
  minimizer.set_min_objective(&Run::evaluate, &run);
  minimizer.set_maxeval(static_cast<int>(options.max_evaluations));
  std::vector<double> x(y.begin(), y.end());
  double value = 0;
  run.report.status = Status::Stagnated;
  try {
    if (minimizer.optimize(x, value) == nlopt::MAXEVAL_REACHED) run.report.status = Status::MaxIterations;
  } catch (const std::runtime_error&) {  // stopped by us, or "nlopt failure": a line search found nothing better
  }
  if (run.report.residual <= options.tolerance) run.report.status = Status::Converged;
  if (!std::isfinite(run.report.residual)) run.report.status = Status::NotFinite;
  u = run.best;
  return run.report;
}

}  // namespace supple
