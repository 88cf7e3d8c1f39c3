#pragma once
/// \file Exchanges of columns of a least-squares fit for others, as long as that helps.

#include <core/types.hpp>

#include <vector>

namespace supple {

/// Exchanges a column of the support for one outside it: each time the pair that lowers the squared error
/// most, all others refitted, among those that leave all weights positive and, for their entering column,
/// gain most; until no such pair lowers it, or after as many pairs as the support has columns. \param gram  G
/// = AᵀA (n × n).   \param atb  Aᵀb (n). \param w  a least-squares fit with its support, the columns with a
/// weight > 0 (n). \param fixed  1 for a column that stays where it is, with a weight or without (n). \return
/// positions of the new support and of the fixed columns, ascending. \note O(n²) an exchange and O(n²
/// |support|) before the first: G is kept swept on the support (Goodnight 1979). \see Miller 2002, Subset
/// Selection in Regression, Sec. 3.7 (replacing variables).
std::vector<Index> exchange(MatrixIn gram, VectorIn atb, VectorIn w, const std::vector<char>& fixed);

}  // namespace supple
