#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/stable_norm.hpp>
#include <sparse/nnls/active_set.hpp>
#include <sparse/nnls/nnls.hpp>
#include <sparse/nnls/power_scaling.hpp>
#include <sparse/problem/fitting_problem.hpp>

#include <Eigen/Jacobi>
#include <Eigen/QR>

namespace supple {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

// Q R of the passive columns, with an explicit orthonormal Q.
struct QrFactor {
  Matrix A;  // unit or zero columns
  Vector b;
  double b_norm;
  Matrix Q, R;  // the first size columns in use
  Index size = 0;

  QrFactor(Matrix unit_columns, Vector rhs, double norm_of_rhs)
      : A(std::move(unit_columns)),
        b(std::move(rhs)),
        b_norm(norm_of_rhs),
        Q(A.rows(), std::min(A.rows(), A.cols())),
        R(Q.cols(), Q.cols()) {}

  Index cols() const { return A.cols(); }
  bool is_zero(Index i) const { return A.col(i).squaredNorm() == 0; }

  bool assign(const Indices& P) {
    size = 0;
    for (Index i : P)
      if (!append(P, i)) {
        size = 0;
        return false;
      }
    return true;
  }

  // Gram–Schmidt, twice: what is left then is orthogonal to rounding (Daniel et al. 1976).
  bool append(const Indices&, Index i) {
    if (size == Q.cols()) return false;
    const auto Q_P = Q.leftCols(size);
    Vector v = A.col(i), h = Q_P.transpose() * v;
    v -= Q_P * h;
    const Vector correction = Q_P.transpose() * v;
    v -= Q_P * correction;
    const double rho = v.norm();
    if (!(rho > 64 * epsilon)) return false;
    R.col(size).head(size) = h + correction;
    R(size, size) = rho;
    Q.col(size) = v / rho;
    ++size;
    return true;
  }

  void remove(Index k) {
    for (Index j = k; j + 1 < size; ++j) R.col(j).head(j + 2) = R.col(j + 1).head(j + 2);
    --size;
    for (Index j = k; j < size; ++j) {
      Eigen::JacobiRotation<double> rotation;
      rotation.makeGivens(R(j, j), R(j + 1, j));
      R.block(0, j, size + 1, size - j).applyOnTheLeft(j, j + 1, rotation.adjoint());
      Q.leftCols(size + 1).applyOnTheRight(j, j + 1, rotation);
    }
  }

  Vector solve(const Indices&) const {
    return R.topLeftCorner(size, size).triangularView<Eigen::Upper>().solve(Q.leftCols(size).transpose() * b);
  }

  // b less its projection on all passive columns but the last `without`: free of the rounding of x.
  Vector residual(Index without = 0) const {
    const auto Q_P = Q.leftCols(size - without);
    Vector r = b - Q_P * (Q_P.transpose() * b);
    r -= Q_P * (Q_P.transpose() * r);
    return r;
  }

  Vector gradient(const Indices&, const Vector&) const { return A.transpose() * residual(); }
  double scale() const { return b_norm; }
  double rounding(const Vector&) const { return 8 * epsilon * b_norm; }
  // A column nearly in the span of the passive ones may lower the error a lot by a gradient of rounding's
  // size. So any may try, as long as the error itself is more than rounding.
  double least_gradient(const Vector&, double) const {
    return residual().norm() > 16 * epsilon * b_norm ? 0 : std::numeric_limits<double>::infinity();
  }
  bool last_matters() const {
    const Vector r = residual(1);
    return std::abs(Q.col(size - 1).dot(r)) > 1e-13 * r.norm();
  }
};
static_assert(PassiveFactor<QrFactor>);

// [A b] with at most cols + 1 rows and the same inner products, by orthogonal transformations: pieces of
// fixed size first, then what is left of them.
Matrix reduced_rows(Matrix A_b) {
  const Index n = A_b.cols(), piece = std::max<Index>(2048, 4 * n);
  const auto triangle = [n](const Eigen::Ref<const Matrix>& part) -> Matrix {
    return Eigen::HouseholderQR<Matrix>(part).matrixQR().topRows(n).template triangularView<Eigen::Upper>();
  };
  while (A_b.rows() > 2 * piece) {
    const Index pieces = A_b.rows() / piece;  // the last one takes the rest
    Matrix next(pieces * n, n);
    parallel_for(pieces, [&](Index k) {
      const Index rows = k + 1 < pieces ? piece : A_b.rows() - k * piece;
      next.middleRows(k * n, n) = triangle(A_b.middleRows(k * piece, rows));
    });
    A_b = std::move(next);
  }
  return A_b.rows() > n ? triangle(A_b) : A_b;
}

double kkt_residual(MatrixIn A, const Vector& w, const Vector& r, const Vector& scale, double b_norm) {
  const Vector g = (A.transpose() * r).cwiseProduct(scale);
  double worst = 0;
  for (Index i = 0; i < g.size(); ++i) worst = std::max(worst, w[i] > 0 ? std::abs(g[i]) : g[i]);
  return b_norm > 0 ? worst / b_norm : 0;
}

// What Nnls does, for columns and b whose squares are numbers.
NnlsFit solve(NnlsMethod method, double tolerance, Index limit, const Matrix& A, const Vector& b,
              std::span<const Index> start) {
  const Index n = A.cols();
  NnlsFit fit;
  fit.w = Vector::Zero(n);
  const double b_norm = b.norm();
  const Vector scale = A.colwise().norm().transpose().unaryExpr([](double norm) { return norm > 0 ? 1 / norm : 0; });
  Indices passive(start.begin(), start.end());
  Index iterations = 0;

  // Keeps w if it is better, by the error, or by the KKT conditions where errors are equal to rounding.
  const auto offer = [&](const Vector& w, NnlsMethod by, bool finished) {
    const Vector r = b - A * w;
    const double error = r.norm(), kkt = kkt_residual(A, w, r, scale, b_norm);
    const bool first = fit.method == NnlsMethod::Automatic;
    if (!first && !(error < fit.residual_norm || kkt < fit.report.residual)) return;
    fit.w = w;
    fit.residual_norm = error;
    fit.method = by;
    fit.report.residual = kkt;
    fit.report.status = nnls_status(finished, kkt, tolerance);
  };

  bool enough = false;
  if (method == NnlsMethod::Automatic || method == NnlsMethod::NormalEquations) {
    Indices all(n);
    std::iota(all.begin(), all.end(), Index{0});
    const DenseColumns columns(std::move(all), A * scale.asDiagonal());
    const NnlsSolution solution = Fnnls{tolerance, limit}(columns.gram(columns), columns.transpose_times(b), passive);
    iterations = solution.report.iterations;
    Vector w = solution.w, r = b - columns.times(w);
    for (int step = 0; step < 3 && n > 0; ++step) {  // refinement with the residual of A itself
      const Vector refined = w + solution.passive.solve(columns.transpose_times(r));
      const Vector r_refined = b - columns.times(refined);
      if (!(refined.minCoeff() >= 0) || r_refined.norm() >= r.norm()) break;
      w = refined;
      r = r_refined;
    }
    const bool finished = solution.report.status != Status::MaxIterations;
    offer(w.cwiseProduct(scale), NnlsMethod::NormalEquations, finished);
    passive = solution.passive.indices;
    // They know squares: pivots below 1e-4, or errors below 1e-5 of b, are too close to the square root of
    // rounding.
    const double error = b_norm > 0 ? fit.residual_norm / b_norm : 0;
    // So are columns that they take for combinations of others.
    const bool digits_kept = fit.report.residual <= tolerance && !solution.refused &&
                             solution.passive.factor.smallest_pivot() > 1e-4 && (error > 1e-5 || error < 1e-14);
    enough = method == NnlsMethod::NormalEquations || !finished || digits_kept;
  }
  if (!enough) {
    Matrix A_b(A.rows(), n + 1);
    A_b << A * scale.asDiagonal(), b;
    A_b = reduced_rows(std::move(A_b));
    ActiveSet<QrFactor> set({A_b.leftCols(n), A_b.col(n), b_norm}, tolerance, limit);
    const bool finished = method == NnlsMethod::LawsonHanson ? set.run_single({}) : set.run(passive);
    iterations += set.iterations;
    offer(set.x.cwiseProduct(scale), method == NnlsMethod::LawsonHanson ? method : NnlsMethod::Qr, finished);
  }
  fit.report.iterations = iterations;
  for (Index i = 0; i < n; ++i)
    if (fit.w[i] > 0) fit.passive.push_back(i);
  return fit;
}

}  // namespace

NnlsFit Nnls::operator()(MatrixIn A, VectorIn b, std::span<const Index> start) const {
  require_size("b", b.size(), A.rows());
  const Index n = A.cols();
  for (Index i : start)
    require(0 <= i && i < n, "passive holds " + std::to_string(i) + ", expected 0 to " + std::to_string(n - 1));
  const Vector norms = A.colwise().stableNorm().transpose();
  const double b_norm = stable_norm(b);
  if (!norms.allFinite() || !std::isfinite(b_norm)) {
    NnlsFit fit;
    fit.w = Vector::Zero(n);
    fit.report.status = Status::NotFinite;
    return fit;
  }
  const PowerScaling scaled(A, b, norms, b_norm);
  const Index limit = max_iterations > 0 ? max_iterations : 3 * n + 30;
  return scaled.undo(solve(method, tolerance, limit, scaled.A, scaled.b, start));
}

}  // namespace supple
