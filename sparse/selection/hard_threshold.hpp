#pragma once
/// \file Steps of iterative hard thresholding, and its projections H_s and H_s⁺ as sets of positions.

#include <core/stable_norm.hpp>
#include <core/types.hpp>
#include <sparse/nnls/signs.hpp>

#include <concepts>
#include <vector>

namespace supple {

/// ‖p‖² / ‖A p‖², the step along p = Aᵀ(b − A w) that minimises ‖b − A w‖; 0 for p = 0. Whatever the units of A and b:
/// the squares of p itself may be too large or small for numbers.
/// \param A  v ↦ A v.
template <typename Product>
double minimising_step(const Vector& p, const Product& A) {
  static_assert(std::same_as<decltype(A(p)), Vector>, "an expression would refer to vectors that are gone");
  const double norm = stable_norm(p);
  return norm > 0 ? 1 / A(p / norm).squaredNorm() : 0;
}

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
