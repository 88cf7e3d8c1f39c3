#pragma once
/// \file Supports that hold a node along some axes: rollers and planes of symmetry.

#include <core/types.hpp>

#include <cstdint>

namespace supple {

/// A node that slides: held along these axes, free along the others.
struct HeldAxes {
  static constexpr std::uint8_t all = 7;

  Index node = 0;
  std::uint8_t axes = 0;  ///< a sum of 1, 2 and 4 for x, y and z

  bool operator==(const HeldAxes&) const = default;
};

}  // namespace supple
