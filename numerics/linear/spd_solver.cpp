#include <core/check.hpp>
#include <numerics/linear/spd_solver.hpp>

#include <Eigen/Cholesky>

namespace supple {

bool SpdSolver<Matrix>::factorize(const Matrix& A) {
  inverse_.resize(0, 0);
  const Eigen::LLT<Matrix> cholesky(A);
  if (cholesky.info() != Eigen::Success || !A.allFinite()) return false;  // NaN is a success to Eigen
  inverse_ = cholesky.solve(Matrix::Identity(A.rows(), A.cols()));
  return true;
}

Vector SpdSolver<Matrix>::solve(VectorIn b) const {
  require(inverse_.size() > 0, "solve: there is no factorisation");
  require_size("b", b.size(), inverse_.rows());
  return inverse_ * b;
}

}  // namespace supple
