#pragma once
/// \file Eigensolver for the lowest pairs of K φ = ω² M φ.

#include <core/progress.hpp>
#include <core/report.hpp>
#include <core/types.hpp>

#include <cstdint>

namespace supple {

struct EigenOptions {
  Index num_modes = 15;
  /// Bound of ‖K φ − ω² M φ‖_{M⁻¹} / (ω² + σ) for ‖φ‖_M = 1, where the shift σ is a fraction of the lowest
  /// flexible ω². Loosen it if only a basis is wanted; below 1e-10 rounding in K takes over.
  double tolerance = 1e-8;
  /// Vectors in one step, 0: chosen here. Frequencies repeated up to so many times come out together.
  Index block_size = 0;
  /// Restarts of the Krylov space before giving up. Raise it for very many or tightly clustered frequencies.
  Index max_restarts = 50;
  std::uint64_t seed = 1;  ///< of the start vectors
  /// Search once more, from fresh random vectors orthogonal to all found, for a mode that was passed over.
  /// Takes about a third of all solves; switch it off if a missing copy of a repeated frequency does no harm.
  bool check_completeness = true;
  Progress progress;
};

struct EigenPairs {
  Vector omega_squared;  ///< [1/s²], ascending; rounding may leave tiny negative values for zero-energy modes
  Matrix vectors;        ///< n × r, UᵀMU = I; in each column the entry of largest magnitude is positive
  Vector residuals;      ///< ‖K φ − ω² M φ‖_{M⁻¹} / (ω² + σ), computed afresh for every pair
  Report report;         ///< iterations counts blocks of solves; residual is the largest of `residuals`
  Index missed = 0;      ///< modes the first search passed over and the completeness check put in
  /// Leading pairs with ω² ≤ 1e-13 |φ|ᵀ |K| |φ|, what cancels in them, and ω² ≤ 1e-3 of the one that follows them: motions
  /// without energy beyond `rigid`, such as hinges.
  Index extra_zero_modes = 0;
  /// Largest ‖K φ‖_{M⁻¹} / ‖M^{−1/2} K M^{−1/2}‖_∞ over the M-orthonormalised columns φ of `rigid`.
  double rigid_residual = 0;
  double shift = 0;  ///< σ [1/s²]; 0 if a dense solver was used
};

/// The smallest `num_modes` eigenpairs of K φ = ω² M φ in the M-orthogonal complement of `rigid`.
///
/// Block Krylov–Schur iteration (Anasazi) on (K + σ M)⁻¹ M with a sparse Cholesky factorisation; σ > 0 is a
/// small fraction of the lowest flexible ω², so that free and hinged objects need no special treatment. Small
/// problems go to a dense solver; of their inverse, where parts of K over M are far larger than others. Digits of soft modes
/// are kept beside stiff parts and slivers of almost no mass. The same seed gives the same bits for any num_threads().
/// \param K           n × n, symmetric, positive semi-definite (up to σ), both triangles stored [N/m]
/// \param M_diagonal  n masses > 0 [kg]
/// \param rigid       n × k, known fields with K φ = 0, e.g. the rigid motions of a free object; may have no
///                    columns; dependent columns are dropped
/// \return report.status is Converged if every residual meets the tolerance or the rounding error of K φ, 10 ε |K| |φ|,
///         whichever is larger, and the completeness check (if asked for) came to an end. Otherwise
///         MaxIterations, with those pairs that were found: maybe fewer than num_modes.
/// \throws std::invalid_argument if sizes differ, K is zero, not symmetric or not finite, a mass is not
///         positive, rigid has energy, or num_modes is outside [1, n − rank(rigid)].
/// \throws InputError if K over M is not between 1e-120 and 1e120 1/s²: wrong units, most likely.
/// \throws SolverError if K + σ M is not positive definite: K has negative eigenvalues.
/// \note One factorisation (two if the first shift fits badly), 4 to 7 solves a mode, O(n num_modes) memory.
/// \see Stewart 2001 and Zhou & Saad 2008 (block Krylov–Schur); Baker et al. 2009 (Anasazi).
EigenPairs smallest_eigenpairs(const SparseMatrix& K, const Vector& M_diagonal, const Matrix& rigid,
                               const EigenOptions& options = {});

}  // namespace supple
