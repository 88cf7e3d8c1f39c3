#pragma once
/// \file The projections H_s and H_s⁺ of iterative hard thresholding, as sets of positions.

#include <core/types.hpp>
#include <sparse/signs.hpp>

#include <vector>

namespace supple {

/// Positions of the `count` largest positive entries of x (all positive ones if there are fewer), ascending;
/// of equal entries the first. The support of H_s⁺(x) (von Tycowicz et al. 2013, Sec. 4.1). O(n).
std::vector<Index> largest_positive(VectorIn x, Index count);

/// Positions of the `count` entries of largest magnitude that are not zero, ascending: the support of H_s(x).
std::vector<Index> largest_magnitude(VectorIn x, Index count);

inline std::vector<Index> hard_threshold(Signs signs, VectorIn x, Index count) {
  return signs == Signs::NonNegative ? largest_positive(x, count) : largest_magnitude(x, count);
}

/// The position of the largest positive entry in each of `groups` consecutive parts of x, as equal as can be;
/// parts without a positive entry have none. Ascending. More groups than entries: one entry each.
std::vector<Index> best_of_groups(VectorIn x, Index groups);

}  // namespace supple
