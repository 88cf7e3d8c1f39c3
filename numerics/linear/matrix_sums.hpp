#pragma once
/// \file Sums of matrices that assembling a system takes, sparse or dense.

#include <core/check.hpp>

namespace supple {

/// Whether two matrices are equal, one without entries to itself only.
inline bool equal(const Matrix& A, const Matrix& B) {
  return A.size() == B.size() && A == B;
}
inline bool equal(const SparseMatrix& A, const SparseMatrix& B) {
  return A.size() == B.size() && (A.size() == 0 || (A - B).norm() == 0);
}

/// A += s B; B has the pattern of A.
inline void add_scaled(Matrix& A, double s, const Matrix& B) {
  A += s * B;
}
inline void add_scaled(SparseMatrix& A, double s, const SparseMatrix& B) {
  require_size("the matrix to add", B.nonZeros(), A.nonZeros());
  Eigen::Map<Vector>(A.valuePtr(), A.nonZeros()) += s * Eigen::Map<const Vector>(B.valuePtr(), B.nonZeros());
}

/// A += diag(v).
inline void add_diagonal(Matrix& A, VectorIn v) {
  A.diagonal() += v;
}
inline void add_diagonal(SparseMatrix& A, VectorIn v) {
  for (Index j = 0; j < A.cols(); ++j) A.coeffRef(j, j) += v[j];
}

/// A += B for a B with few entries, each in the pattern of A.
inline void add_few(Matrix& A, const Matrix& B) {
  A += B;
}
inline void add_few(SparseMatrix& A, const SparseMatrix& B) {
  for (Index j = 0; j < B.cols(); ++j)
    for (SparseMatrix::InnerIterator it(B, j); it; ++it) A.coeffRef(it.row(), it.col()) += it.value();
}

}  // namespace supple
