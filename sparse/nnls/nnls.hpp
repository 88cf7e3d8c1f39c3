#pragma once
/// \file Non-negative least squares: min ‖A w − b‖ subject to w ≥ 0.

#include <core/report.hpp>
#include <core/types.hpp>
#include <sparse/nnls/updatable_cholesky.hpp>

#include <span>
#include <vector>

namespace supple {

/// The columns with a weight, and the factor of their normalised Gram matrix.
struct PassiveSet {
  std::vector<Index> indices;  ///< in the factor's order
  UpdatableCholesky factor;
  Vector scale;  ///< 1/‖aᵢ‖ of every column (n), 0 for a zero column

  /// x (n) with G_PP x_P = c_P, and 0 elsewhere.
  Vector solve(VectorIn c) const;
};

struct NnlsSolution {
  Vector w;  ///< ≥ 0
  PassiveSet passive;
  bool refused = false;  ///< did a column stay out because the normal equations take it for a combination of others?
  /// Residual: largest violation of gᵢ ≤ 0, and of gᵢ = 0 where wᵢ > 0, by gᵢ = aᵢᵀ(b − A w) / ‖aᵢ‖; relative
  /// to maxᵢ |aᵢᵀb| / ‖aᵢ‖. Stagnated: the normal equations have no more digits; w is the best that they
  /// give.
  Report report;
};

/// Active-set method on the normal equations: block exchanges while they make progress (usually a handful),
/// then one column at a time, with the Cholesky factor of the passive set updated. A column that depends
/// linearly on the passive ones stays out, which costs nothing: its gradient is zero. So copies of a
/// column, zero columns and singular Gram matrices are nothing special. Columns are normalised inside, so
/// their scales do not matter. Accuracy: KKT to about ε cond(A_P)², ε = 2e-16; see Nnls for matrices worse
/// than that.
/// \see Bro & De Jong 1997 (normal equations); Kim & Park 2011 (block exchanges); Lawson & Hanson 1974, Ch.
/// 23.
struct Fnnls {
  double tolerance = 1e-12;  ///< of the KKT residual
  Index max_iterations = 0;  ///< exchanges; 0: 3 n + 30, which only a very degenerate problem needs

  /// \param gram     G = AᵀA (n × n).
  /// \param atb  Aᵀb (n).
  /// \param passive  columns to start from, such as the answer to a similar problem; may be empty.
  /// \throws std::invalid_argument if sizes do not fit.
  /// \note O(n²) an exchange, and O(|passive|³) once.
  NnlsSolution operator()(MatrixIn gram, VectorIn atb, std::span<const Index> passive = {}) const;
};

/// Least squares without the sign: columns that to rounding depend on earlier ones get no weight. Residual
/// as above, for gᵢ = 0.
/// \note O(n³/3).
/// \throws std::invalid_argument if sizes do not fit.
NnlsSolution least_squares(MatrixIn gram, VectorIn atb);

/// How Nnls solves.
enum class NnlsMethod {
  Automatic,        ///< normal equations; QR takes over where their pivots say that digits are lost
  NormalEquations,  ///< Fnnls on AᵀA, polished with the residual of A: fastest
  Qr,               ///< the same exchanges on an orthogonal factorisation of the passive columns: all digits
  LawsonHanson,     ///< Qr with one column at a time from an empty set: the textbook's method, for reference
};

struct NnlsFit {
  Vector w;                                   ///< ≥ 0 (n)
  std::vector<Index> passive;                 ///< where w > 0, ascending
  double residual_norm = 0;                   ///< ‖A w − b‖
  NnlsMethod method = NnlsMethod::Automatic;  ///< the one that gave the answer
  /// Residual: the KKT conditions evaluated on A: the largest violation of gᵢ ≤ 0, and of gᵢ = 0 where wᵢ >
  /// 0, by gᵢ = aᵢᵀ(b − A w) / (‖aᵢ‖ ‖b‖).
  Report report;
};

/// min ‖A w − b‖ subject to w ≥ 0, for a matrix in memory. Copies of columns, zero columns, any scale of
/// columns and of b, rank deficiency and n > rows are all answered; of several solutions, one with linearly
/// independent columns.
/// \note NormalEquations: rows n² / 2 multiplications for AᵀA, then O(n²) an exchange; Qr: rows n² first,
/// if rows > n. Automatic costs both where columns are copies, or nearly combinations, of others.
/// \see Bro & De Jong 1997; Lawson & Hanson 1974; Daniel, Gragg, Kaufman & Stewart 1976 (updating QR).
struct Nnls {
  NnlsMethod method = NnlsMethod::Automatic;
  double tolerance = 1e-12;  ///< of the KKT residual
  Index max_iterations = 0;  ///< exchanges; 0: 3 n + 30

  /// \param passive  columns to start from; may be empty.
  /// \throws std::invalid_argument if sizes do not fit. A NaN or infinity gives Status::NotFinite, in A and b or in
  /// weights that are too large or too small for numbers.
  NnlsFit operator()(MatrixIn A, VectorIn b, std::span<const Index> passive = {}) const;
};

}  // namespace supple
