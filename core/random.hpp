#pragma once
/// \file Seeded random numbers that are the same on every platform (the standard's distributions are not).

#include <core/types.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace supple {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  /// Uniform in 0 … count − 1; count ≥ 1.
  Index below(Index count) {
    return static_cast<Index>((static_cast<Wide>(engine_()) * static_cast<std::uint64_t>(count)) >> 64);
  }
  /// Standard normal (Box and Muller 1958).
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  /// `count` different items in random order, by a partial Fisher–Yates shuffle; all of them if there are
  /// fewer.
  template <typename Item>
  std::vector<Item> sample(std::vector<Item> items, Index count) {
    count = std::min<Index>(count, static_cast<Index>(items.size()));
    for (Index k = 0; k < count; ++k) std::swap(items[k], items[k + below(static_cast<Index>(items.size()) - k)]);
    items.resize(count);
    return items;
  }

 private:
  __extension__ using Wide = unsigned __int128;

  std::mt19937_64 engine_;
};

}  // namespace supple
