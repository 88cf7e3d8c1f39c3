#include <sparse/selectors/row_compression.hpp>

#include <Eigen/QR>
#include <Eigen/SVD>

namespace supple {

CountSketch::CountSketch(Index original_rows, Index rows, std::uint64_t seed)
    : rows_(rows), bucket_(original_rows), sign_(original_rows) {
  require(rows >= 1, "the sketch has " + std::to_string(rows) + " rows, expected 1 or more");
  Random random(seed);
  for (Index i = 0; i < original_rows; ++i) {
    bucket_[i] = random.below(rows);
    sign_[i] = random.below(2) == 0 ? -1 : 1;
  }
}

void CountSketch::apply(VectorIn x, VectorOut out) const {
  require_size("x", x.size(), sign_.size());
  out.setZero();
  for (Index i = 0; i < x.size(); ++i) out[bucket_[i]] += sign_[i] * x[i];
}

Matrix orthonormalized(const Matrix& Y) {
  const Eigen::HouseholderQR<Matrix> qr(Y);
  return qr.householderQ() * Matrix::Identity(Y.rows(), Y.cols());
}

Matrix whitening(const Matrix& J, Index rows) {
  if (J.size() == 0) return Matrix(0, J.rows());
  // Jᵀ = Q R first: the SVD then is of a small square matrix.
  const Eigen::HouseholderQR<Matrix> qr(J.transpose());
  const Matrix R = qr.matrixQR().topRows(J.rows()).triangularView<Eigen::Upper>();
  const Eigen::JacobiSVD<Matrix> svd(R.transpose(), Eigen::ComputeFullU);
  const Vector sigma = svd.singularValues();
  const Index rank = (sigma.array() > 1e-10 * sigma[0]).count(), kept = std::min(rows, rank);
  return sigma[0] * sigma.head(kept).cwiseInverse().asDiagonal() * svd.matrixU().leftCols(kept).transpose();
}

}  // namespace supple
