#pragma once
/// \file Solver for symmetric positive definite matrices, sparse or dense.

#include <numerics/linear/cholmod_solver.hpp>
#include <numerics/linear/matrix_sums.hpp>

namespace supple {

/// Factorise once, solve many times. factorize() returns false if the matrix is not positive definite.
template <typename MatrixType>
class SpdSolver;

template <>
class SpdSolver<SparseMatrix> {
 public:
  /// The pattern is analysed at the first call only.
  [[nodiscard]] bool factorize(const SparseMatrix& A) {
    if (analyzed_nonzeros_ != A.nonZeros()) {
      cholesky_.analyze(A, has_blocks_of_three(A) ? 3 : 1);
      analyzed_nonzeros_ = A.nonZeros();
    }
    return cholesky_.factorize(A);
  }
  Vector solve(VectorIn b) const { return cholesky_.solve(b); }

 private:
  /// Whether rows come in triples of as many entries each, as those of nodes in ℝ³ do.
  static bool has_blocks_of_three(const SparseMatrix& A) {
    if (A.rows() % 3 != 0) return false;
    const auto length = [&](Index j) { return A.outerIndexPtr()[j + 1] - A.outerIndexPtr()[j]; };
    for (Index j = 0; j < A.cols(); j += 3)
      if (length(j) % 3 != 0 || length(j + 1) != length(j) || length(j + 2) != length(j)) return false;
    return true;
  }

  CholmodSolver cholesky_;
  Index analyzed_nonzeros_ = -1;
};

template <>
class SpdSolver<Matrix> {
 public:
  /// Keeps the inverse: a product with it is several times faster than two triangular solves of this size.
  [[nodiscard]] bool factorize(const Matrix& A);
  Vector solve(VectorIn b) const;

 private:
  Matrix inverse_;
};

}  // namespace supple
