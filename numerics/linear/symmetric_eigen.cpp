#include <core/check.hpp>
#include <numerics/linear/symmetric_eigen.hpp>

#include <Eigen/Eigenvalues>

namespace supple {
namespace {

Eigen::SelfAdjointEigenSolver<Matrix> solved(const Matrix& A, int what) {
  require_size("columns of A", A.cols(), A.rows());
  Eigen::SelfAdjointEigenSolver<Matrix> eigen(A, what);
  if (eigen.info() != Eigen::Success || !eigen.eigenvalues().allFinite())  // NaN may be a success to Eigen
    throw SolverError("eigenvalues of a symmetric matrix did not converge");
  return eigen;
}

}  // namespace

SymmetricEigen symmetric_eigen(const Matrix& A) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen = solved(A, Eigen::ComputeEigenvectors);
  return {eigen.eigenvalues(), eigen.eigenvectors()};
}

Vector symmetric_eigenvalues(const Matrix& A) {
  return solved(A, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace supple
