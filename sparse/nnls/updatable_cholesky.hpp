#pragma once
/// \file Cholesky factor that follows its matrix when rows and columns come and go.

#include <core/types.hpp>

namespace supple {

/// RᵀR = G for a symmetric positive definite G with unit diagonal that grows at its end and loses any of
/// its rows and columns.
/// \see Golub & Van Loan, Matrix Computations, Sec. 6.5.
class UpdatableCholesky {
 public:
  /// \param max_size  room for so many rows and columns.
  explicit UpdatableCholesky(Index max_size) : R_(max_size, max_size) {}

  Index size() const { return size_; }
  /// Starts anew with all of G (unit diagonal, lower triangle read), in blocks. O(size³/3).
  /// \return false, and the factor is empty, if to rounding G is singular.
  bool assign(MatrixIn G);
  /// Adds one row and column: g (size) holds the inner products with those present. O(size²).
  /// \return false, and nothing has changed, if to rounding the new one depends linearly on those present.
  bool append(VectorIn g);
  /// Removes row and column k; those behind move up. O((size − k)²).
  void remove(Index k);
  void clear() { size_ = 0; }
  /// The smallest diagonal entry of R, at most 1: about 1/cond(A) for G = AᵀA. 1 if empty.
  double smallest_pivot() const { return size_ > 0 ? R_.diagonal().head(size_).minCoeff() : 1; }
  /// G⁻¹ c. O(size²).
  Vector solve(VectorIn c) const;

 private:
  Matrix R_;  // upper triangular in its leading size_ × size_ block
  Index size_ = 0;
};

}  // namespace supple
