#pragma once
/// \file Solver for matrices that need not be symmetric, sparse or dense.

#include <core/check.hpp>
#include <numerics/linear/matrix_sums.hpp>
#include <numerics/linear/umfpack_solver.hpp>

#include <Eigen/LU>

namespace supple {

/// Factorise once, solve many times, as SpdSolver does. factorize() returns false if the matrix is singular or not
/// finite.
template <typename MatrixType>
class LuSolver;

template <>
class LuSolver<SparseMatrix> {
 public:
  /// The pattern, which has to be symmetric, is analysed at the first call only.
  [[nodiscard]] bool factorize(const SparseMatrix& A) {
    if (analyzed_nonzeros_ != A.nonZeros()) {
      lu_.analyze(A);
      analyzed_nonzeros_ = A.nonZeros();
    }
    return lu_.factorize(A);
  }
  Vector solve(VectorIn b) const { return lu_.solve(b); }

 private:
  UmfpackSolver lu_;
  Index analyzed_nonzeros_ = -1;
};

template <>
class LuSolver<Matrix> {
 public:
  [[nodiscard]] bool factorize(const Matrix& A) {
    require_size("columns of A", A.cols(), A.rows());
    ready_ = false;
    if (!A.allFinite()) return false;
    lu_.compute(A);
    const Vector pivots = lu_.matrixLU().diagonal();
    return ready_ = pivots.allFinite() && (pivots.array() != 0).all();
  }
  Vector solve(VectorIn b) const {
    require(ready_, "solve: there is no factorisation");
    require_size("b", b.size(), lu_.rows());
    return lu_.solve(b);
  }

 private:
  Eigen::PartialPivLU<Matrix> lu_;
  bool ready_ = false;
};

}  // namespace supple
