#include <core/parallel.hpp>
#include <numerics/linear/tall_qr.hpp>

#include <Eigen/QR>

#include <algorithm>
#include <vector>

namespace supple {

namespace {

ThinQr householder_qr(MatrixIn A) {
  const Index k = std::min(A.rows(), A.cols());
  const Eigen::HouseholderQR<Matrix> qr(A);
  return {qr.householderQ() * Matrix::Identity(A.rows(), k), qr.matrixQR().topRows(k).triangularView<Eigen::Upper>()};
}

}  // namespace

ThinQr tall_qr(MatrixIn A) {
  const Index n = A.cols(), rows = std::max<Index>(2048, 4 * n), pieces = A.rows() / rows;
  if (pieces < 2) return householder_qr(A);
  const auto begin = [&](Index k) { return k * rows; };
  const auto count = [&](Index k) { return k + 1 < pieces ? rows : A.rows() - begin(k); };
  std::vector<Matrix> local(pieces);
  Matrix stacked(pieces * n, n);
  parallel_for(pieces, [&](Index k) {
    ThinQr qr = householder_qr(A.middleRows(begin(k), count(k)));
    stacked.middleRows(k * n, n) = qr.R;
    local[k] = std::move(qr.Q);
  });
  ThinQr result = tall_qr(stacked);
  Matrix Q(A.rows(), n);
  parallel_for(pieces,
               [&](Index k) { Q.middleRows(begin(k), count(k)).noalias() = local[k] * result.Q.middleRows(k * n, n); });
  result.Q = std::move(Q);
  return result;
}

}  // namespace supple
