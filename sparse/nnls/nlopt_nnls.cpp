#include <core/check.hpp>
#include <core/stable_norm.hpp>
#include <sparse/nnls/nlopt_nnls.hpp>
#include <sparse/nnls/power_scaling.hpp>

#include <nlopt.hpp>

#include <cmath>

namespace supple {

namespace {

nlopt::algorithm algorithm(QuasiNewtonMethod method) {
  switch (method) {
    case QuasiNewtonMethod::Lbfgs:
      return nlopt::LD_LBFGS;
    case QuasiNewtonMethod::VariableMetric:
      return nlopt::LD_VAR2;
    case QuasiNewtonMethod::TruncatedNewton:
      return nlopt::LD_TNEWTON_PRECOND_RESTART;
    case QuasiNewtonMethod::Ccsa:
      return nlopt::LD_CCSAQ;
  }
  throw std::invalid_argument("unknown quasi-Newton method");
}

// ½ xᵀG x − cᵀx of unit columns.
struct Objective {
  Matrix G;
  Vector c;
  Index evaluations = 0;

  static double evaluate(unsigned n, const double* x_data, double* gradient, void* self) {
    auto& f = *static_cast<Objective*>(self);
    ++f.evaluations;
    const Eigen::Map<const Vector> x(x_data, n);
    const Vector Gx = f.G.selfadjointView<Eigen::Lower>() * x;
    if (gradient) Eigen::Map<Vector>(gradient, n) = Gx - f.c;
    return 0.5 * x.dot(Gx) - f.c.dot(x);
  }
};

}  // namespace

NnlsFit QuasiNewtonNnls::operator()(MatrixIn A, VectorIn b) const {
  require_size("b", b.size(), A.rows());
  const Index n = A.cols();
  NnlsFit fit;
  fit.w = Vector::Zero(n);
  const Vector norms = A.colwise().stableNorm().transpose();
  const double b_norm = stable_norm(b);
  if (!norms.allFinite() || !std::isfinite(b_norm)) {
    fit.report.status = Status::NotFinite;
    return fit;
  }
  fit.residual_norm = b_norm;
  fit.report.residual = 0;
  fit.report.status = Status::Converged;
  if (n == 0 || b_norm == 0) return fit;

  const PowerScaling scaled(A, b, norms, b_norm);
  const Vector scale = scaled.A.colwise().norm().transpose().unaryExpr([](double x) { return x > 0 ? 1 / x : 0; });
  const Matrix unit = scaled.A * scale.asDiagonal();
  Objective objective{unit.transpose() * unit, unit.transpose() * scaled.b};

  nlopt::opt optimizer(algorithm(method), static_cast<unsigned>(n));
  optimizer.set_min_objective(Objective::evaluate, &objective);
  optimizer.set_lower_bounds(0.0);
  optimizer.set_ftol_rel(tolerance);
  optimizer.set_maxeval(static_cast<int>(max_evaluations));
  std::vector<double> x(n, 0.0);
  double value = 0;
  Status status = Status::Converged;
  try {
    if (optimizer.optimize(x, value) == nlopt::MAXEVAL_REACHED) status = Status::MaxIterations;
  } catch (const nlopt::roundoff_limited&) {  // x is the best so far
    status = Status::Stagnated;
  } catch (const std::runtime_error&) {  // NLopt's name for any failure of its line search
    status = Status::Stagnated;
  }

  const Vector z = Eigen::Map<const Vector>(x.data(), n).cwiseMax(0);
  const Vector r = scaled.b - unit * z, g = unit.transpose() * r;
  double worst = 0;
  for (Index i = 0; i < n; ++i) {
    worst = std::max(worst, z[i] > 0 ? std::abs(g[i]) : g[i]);
    if (z[i] > 0) fit.passive.push_back(i);
  }
  fit.w = z.cwiseProduct(scale);
  fit.residual_norm = r.norm();
  fit.report = {status, objective.evaluations, worst / scaled.b.norm()};
  return scaled.undo(std::move(fit));
}

}  // namespace supple
