#include <core/check.hpp>
#include <sparse/nnls/active_set.hpp>
#include <sparse/nnls/nnls.hpp>

namespace supple {

Vector PassiveSet::solve(VectorIn c) const {
  Vector x = Vector::Zero(scale.size());
  x(indices) = factor.solve(c(indices).cwiseProduct(scale(indices)));
  return x.cwiseProduct(scale);
}

namespace {

// The normal equations G x = c of unit columns.
struct GramFactor {
  Matrix G;
  Vector c;
  UpdatableCholesky cholesky;

  Index cols() const { return c.size(); }
  bool is_zero(Index i) const { return G(i, i) == 0; }
  bool assign(const Indices& P) { return cholesky.assign(G(P, P)); }
  bool append(const Indices& P, Index i) { return cholesky.append(G(P, i)); }
  void remove(Index k) { cholesky.remove(k); }
  Vector solve(const Indices& P) const { return cholesky.solve(c(P)); }
  Vector gradient(const Indices& P, const Vector& x) const {
    Vector g = c;
    for (Index i : P) g -= x[i] * G.col(i);
    return g;
  }
  double scale() const { return c.size() ? c.cwiseAbs().maxCoeff() : 0; }
  double rounding(const Vector& x) const {
    return 4 * std::numeric_limits<double>::epsilon() * (scale() + x.lpNorm<1>());
  }
  double least_gradient(const Vector&, double threshold) const { return threshold; }
  bool last_matters() const { return true; }
};
static_assert(PassiveFactor<GramFactor>);

// With unit columns, by D = diag(1/‖aᵢ‖), 0 for a zero column.
struct Normalized {
  Vector scale;
  GramFactor factor;

  Normalized(MatrixIn gram, VectorIn atb)
      : scale(gram.diagonal().unaryExpr([](double g) { return g > 0 ? 1 / std::sqrt(g) : 0; })),
        factor{scale.asDiagonal() * gram * scale.asDiagonal(), atb.cwiseProduct(scale), UpdatableCholesky(atb.size())} {
  }
};

void require_normal_equations(MatrixIn gram, VectorIn atb) {
  require_size("gram (columns)", gram.cols(), gram.rows());
  require_size("atb", atb.size(), gram.cols());
}

NnlsSolution not_finite(Index n) {
  NnlsSolution solution{Vector::Zero(n), {{}, UpdatableCholesky(0), Vector::Zero(n)}, false, {}};
  solution.report.status = Status::NotFinite;
  return solution;
}

NnlsSolution solution_of(ActiveSet<GramFactor>&& set, const Vector& scale, Report report) {
  return {
      set.x.cwiseProduct(scale), {std::move(set.passive), std::move(set.factor.cholesky), scale}, set.refused, report};
}

}  // namespace

NnlsSolution Fnnls::operator()(MatrixIn gram, VectorIn atb, std::span<const Index> start) const {
  require_normal_equations(gram, atb);
  const Index n = atb.size();
  for (Index i : start)
    require(0 <= i && i < n, "passive holds " + std::to_string(i) + ", expected 0 to " + std::to_string(n - 1));
  if (!gram.allFinite() || !atb.allFinite()) return not_finite(n);

  Normalized problem(gram, atb);
  ActiveSet<GramFactor> set{std::move(problem.factor), tolerance, max_iterations > 0 ? max_iterations : 3 * n + 30};
  const bool finished = set.run({start.begin(), start.end()});
  Report report;
  report.iterations = set.iterations;
  report.residual = set.kkt_residual();
  report.status = nnls_status(finished, report.residual, tolerance);
  return solution_of(std::move(set), problem.scale, report);
}

NnlsSolution least_squares(MatrixIn gram, VectorIn atb) {
  require_normal_equations(gram, atb);
  if (!gram.allFinite() || !atb.allFinite()) return not_finite(atb.size());
  Normalized problem(gram, atb);
  ActiveSet<GramFactor> set(std::move(problem.factor), 0, 0);
  set.run_unconstrained();
  Report report;
  report.iterations = 1;
  report.residual = set.g.size() && set.factor.scale() > 0 ? set.g.cwiseAbs().maxCoeff() / set.factor.scale() : 0;
  report.status = nnls_status(true, report.residual, 1e-12);
  return solution_of(std::move(set), problem.scale, report);
}

}  // namespace supple
