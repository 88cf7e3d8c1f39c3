#pragma once
/// \file Eigenvalues and eigenvectors of small dense symmetric matrices.

#include <core/types.hpp>

namespace supple {

/// A = V diag(λ) Vᵀ of a symmetric n × n matrix.
struct SymmetricEigen {
  Vector values;   ///< λ, n, ascending
  Matrix vectors;  ///< V, n × n, orthonormal columns
};

/// All eigenpairs of a symmetric n × n matrix, of which the lower triangle is read. O(n³)
/// \throws SolverError if the iteration does not converge, as for entries that are not numbers
SymmetricEigen symmetric_eigen(const Matrix& A);

/// The eigenvalues alone, ascending. \throws SolverError as symmetric_eigen()
Vector symmetric_eigenvalues(const Matrix& A);

}  // namespace supple
