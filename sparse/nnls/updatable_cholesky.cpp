#include <sparse/nnls/updatable_cholesky.hpp>

#include <Eigen/Cholesky>
#include <Eigen/Jacobi>

#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

namespace supple {

namespace {
// What is left of a dependent column is the rounding error of n products of numbers of at most 1.
double noise(Index n) {
  return 16 * std::numeric_limits<double>::epsilon() * static_cast<double>(n + 4);
}
}  // namespace

bool UpdatableCholesky::assign(MatrixIn G) {
  assert(G.rows() == G.cols() && G.cols() <= R_.cols());
  size_ = 0;
  const Eigen::LLT<Matrix> factor(G);
  if (factor.info() != Eigen::Success) return false;
  const auto& L = factor.matrixLLT();
  if (G.cols() > 0 && !(L.diagonal().array().square().minCoeff() > noise(G.cols()))) return false;
  R_.topLeftCorner(G.cols(), G.cols()).triangularView<Eigen::Upper>() = L.transpose();
  size_ = G.cols();
  return true;
}

bool UpdatableCholesky::append(VectorIn g) {
  assert(size_ < R_.cols() && g.size() == size_);
  const Index n = size_;
  auto r = R_.col(n).head(n);
  r = g;
  R_.topLeftCorner(n, n).triangularView<Eigen::Upper>().transpose().solveInPlace(r);
  const double pivot = 1 - r.squaredNorm();
  if (!(pivot > noise(n))) return false;
  R_(n, n) = std::sqrt(pivot);
  ++size_;
  return true;
}

void UpdatableCholesky::remove(Index k) {
  assert(0 <= k && k < size_);
  std::vector<Eigen::JacobiRotation<double>> rotations;
  for (Index j = k; j + 1 < size_; ++j) {  // column by column: memory in order
    auto column = R_.col(j);
    column.head(j + 2) = R_.col(j + 1).head(j + 2);
    for (Index i = k; i < j; ++i) column.applyOnTheLeft(i, i + 1, rotations[i - k].adjoint());
    Eigen::JacobiRotation<double> rotation;
    rotation.makeGivens(column[j], column[j + 1], &column[j]);
    rotations.push_back(rotation);
  }
  --size_;
}

Vector UpdatableCholesky::solve(VectorIn c) const {
  assert(c.size() == size_);
  const auto R = R_.topLeftCorner(size_, size_).triangularView<Eigen::Upper>();
  Vector x = c;
  R.transpose().solveInPlace(x);
  R.solveInPlace(x);
  return x;
}

}  // namespace supple
