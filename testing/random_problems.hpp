#pragma once
/// \file Random least-squares problems from a seed, some with a known answer.

#include <core/random.hpp>
#include <core/types.hpp>

#include <algorithm>
#include <vector>

namespace supple::test {

inline Matrix gaussian(Index rows, Index cols, std::uint64_t seed) {
  Random random(seed);
  return Matrix::NullaryExpr(rows, cols, [&] { return random.normal(); });
}

inline Matrix uniform(Index rows, Index cols, std::uint64_t seed) {
  Random random(seed);
  return Matrix::NullaryExpr(rows, cols, [&] { return random.uniform(); });
}

/// `count` of 0 … n − 1, ascending.
inline std::vector<Index> random_subset(Index n, Index count, std::uint64_t seed) {
  std::vector<Index> all(n);
  for (Index i = 0; i < n; ++i) all[i] = i;
  all = Random(seed).sample(all, count);
  std::sort(all.begin(), all.end());
  return all;
}

/// w with the given support and weights in [1, 2].
inline Vector planted_weights(Index n, const std::vector<Index>& support, std::uint64_t seed) {
  Random random(seed);
  Vector w = Vector::Zero(n);
  for (Index i : support) w[i] = 1 + random.uniform();
  return w;
}

}  // namespace supple::test
