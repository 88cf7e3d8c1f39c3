#pragma once
/// \file Scaling by powers of two, for least squares in any units of A and b. Internal to sparse/.

#include <sparse/nnls/nnls.hpp>

namespace supple {

/// A and b times powers of two that bring the norms of b and of every column to 1 or more and below 2, so that their
/// squares are numbers. Exact: no digit changes, but of entries that are nothing beside others of their column.
struct PowerScaling {
  Matrix A;
  Vector b;
  std::vector<int> column_exponents;
  int rhs_exponent;

  /// \param norms  of the columns of A. \param b_norm  of b; all are finite.
  PowerScaling(MatrixIn A, VectorIn b, const Vector& norms, double b_norm);

  /// The answer for the original A and b. Weights that are beyond all numbers there make it Status::NotFinite.
  NnlsFit undo(NnlsFit fit) const;
};

}  // namespace supple
