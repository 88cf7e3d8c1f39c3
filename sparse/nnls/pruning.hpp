#pragma once
/// \file Backward elimination: columns leave a least-squares fit, the least missed first.

#include <core/types.hpp>

#include <vector>

namespace supple {

/// Takes columns out of the fit w until `size` are left: each time the one whose loss, with the others
/// refitted, raises the squared error least, by w_i² / [G⁻¹]_ii (backward elimination); one that has become
/// negative goes first. Columns without weight go at no cost.
/// \param gram  G = AᵀA (n × n), positive definite on the columns with a weight.
/// \param w  least-squares fit (n), ≥ 0.
/// \param fixed  1 for a column that stays whatever it costs (n).   \return positions of the others,
/// ascending.
/// \note O(n³) for the inverse, O(n²) a column.
/// \see Couvreur & Bresler 2000; Reeves 1999.
std::vector<Index> prune(MatrixIn gram, VectorIn w, Index size, const std::vector<char>& fixed);

}  // namespace supple
