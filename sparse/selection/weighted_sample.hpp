#pragma once
/// \file Random sample without replacement, by weights.

#include <core/random.hpp>

#include <algorithm>
#include <utility>

namespace supple {

/// `count` different items in random order (all of them if there are fewer): each draw takes item k with
/// probability weight[k] > 0 over the sum of those that are left. \note O(items). \see Efraimidis & Spirakis
/// 2006.
inline std::vector<Index> weighted_sample(const std::vector<Index>& items, const Vector& weight, Index count,
                                          Random& random) {
  std::vector<std::pair<double, Index>> arrivals;  // of independent Poisson processes
  for (Index k : items) arrivals.emplace_back(-std::log(1 - random.uniform()) / weight[k], k);
  count = std::min<Index>(count, static_cast<Index>(items.size()));
  std::nth_element(arrivals.begin(), arrivals.begin() + count, arrivals.end());
  std::vector<Index> first;
  for (Index k = 0; k < count; ++k) first.push_back(arrivals[k].second);
  std::sort(first.begin(), first.end());
  return random.sample(std::move(first), count);
}

}  // namespace supple
