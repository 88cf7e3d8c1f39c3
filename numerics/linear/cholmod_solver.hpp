#pragma once
/// \file Sparse Cholesky factorisation and solves.

#include <core/types.hpp>

#include <memory>

namespace supple {

/// Solves A x = b for a sparse, symmetric positive definite A by a supernodal factorisation P A Pᵀ = L Lᵀ.
/// CHOLMOD and METIS find P and the pattern of L; the numbers are computed along the elimination tree in
/// parallel. Both triangles of A are stored, the lower one is read. Analyse once, factorise for every new set
/// of values:
///
///     CholmodSolver cholesky;
///     cholesky.analyze(K);
///     if (!cholesky.factorize(K)) …  // not positive definite
///     const Vector x = cholesky.solve(b);
///
/// Factor and solutions have the same bits for any num_threads(): BLAS is held to one thread while
/// factorising, and threads share out subtrees and tiles that the pattern fixes. Const calls are safe from
/// several threads.
/// \throws SolverError if memory runs out, or from analyze if the factor has 2³¹ entries or more.
/// \see Chen, Davis, Hager & Rajamanickam 2008 (CHOLMOD); Karypis & Kumar 1998 (METIS);
///      Duff & Reid 1983 (multifrontal factorisation).
class CholmodSolver {
 public:
  CholmodSolver();
  ~CholmodSolver();
  CholmodSolver(CholmodSolver&&) noexcept;
  CholmodSolver& operator=(CholmodSolver&&) noexcept;

  /// Orders A to keep L sparse and computes L's pattern; reads the pattern of A only.
  /// \param block_size  rows b i … b i + b − 1 belong to node i, which is ordered as a whole: cheaper than
  ///                    ordering single rows. 0: consecutive rows with equal patterns make a node, which
  ///                    finds the nodes of a mesh by itself.
  /// \throws std::invalid_argument if A is not square, empty or not compressed, or block_size does not
  ///         divide its size.
  void analyze(const SparseMatrix& A, Index block_size = 0);

  /// Computes L; false if A is not positive definite or not finite: then there is nothing to solve with.
  /// \throws std::invalid_argument if A has another pattern than the one analysed.
  [[nodiscard]] bool factorize(const SparseMatrix& A);

  /// A⁻¹ b. \throws std::invalid_argument if sizes differ or the last factorize did not succeed.
  Vector solve(VectorIn b) const;
  /// X = A⁻¹ B for B, X ∈ ℝ^{n×k}, which may be the same matrix. L is read once for eight columns, so many
  /// at a time are several times cheaper than one by one.
  void solve(MatrixIn B, MatrixOut X) const;

  Index dim() const;              ///< n, rows of the analysed matrix
  Index factor_nonzeros() const;  ///< stored entries of L
  double factor_flops() const;    ///< floating-point operations of one factorisation

 private:
  struct Factor;
  std::unique_ptr<Factor> factor_;
};

}  // namespace supple
