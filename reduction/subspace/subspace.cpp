#include <numerics/linear/tall_qr.hpp>
#include <reduction/subspace/subspace.hpp>

#include <cmath>

namespace supple {

namespace {

/// Orthonormal columns with the span of those of R, in order, without dependent ones.
Matrix gram_schmidt(const Matrix& R, double tolerance) {
  Matrix Q = R;
  Index kept = 0;
  for (Index j = 0; j < R.cols(); ++j) {
    Vector w = Q.col(j);
    const double length = w.norm();
    if (!(length > 0)) continue;
    w /= length;
    for (int pass = 0; pass < 3; ++pass) {  // each pass removes what rounding left of the one before
      const Vector overlap = Q.leftCols(kept).transpose() * w;
      w.noalias() -= Q.leftCols(kept) * overlap;
      if (pass > 0 && overlap.norm() < 1e-14) break;
    }
    const double rest = w.norm();
    if (!(rest > tolerance)) continue;
    Q.col(kept++) = w / rest;
  }
  // columns that kept only a small part of themselves are orthogonal to the relative rounding of that part;
  // once more
  for (Index j = 0; j < kept; ++j) {
    Vector w = Q.col(j);
    w -= Q.leftCols(j) * (Q.leftCols(j).transpose() * w);
    Q.col(j) = w / w.norm();
  }
  return Q.leftCols(kept);
}

}  // namespace

Orthonormalized mass_orthonormalize(const RowMatrix& W, VectorIn mass, double tolerance) {
  require_size("mass", mass.size(), W.rows());
  if (W.cols() == 0) return {W, 0};
  const Vector root = mass.cwiseSqrt();
  const ThinQr qr = tall_qr(root.asDiagonal() * W);
  const Matrix coefficients = gram_schmidt(qr.R, tolerance);
  RowMatrix result(W.rows(), coefficients.cols());
  parallel_ranges(W.rows(), 2048, [&](Index begin, Index end) {
    result.middleRows(begin, end - begin).noalias() = qr.Q.middleRows(begin, end - begin) * coefficients;
    for (Index i = begin; i < end; ++i) {
      if (W.row(i).isZero(0))
        result.row(i).setZero();  // such as fixed nodes
      else
        result.row(i) /= root[i];
    }
  });
  return {std::move(result), W.cols() - coefficients.cols()};
}

}  // namespace supple
