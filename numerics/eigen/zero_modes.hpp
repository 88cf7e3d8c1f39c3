#pragma once
/// \file Bound that tells motions without energy from soft ones.

#include <core/types.hpp>

namespace supple {

/// How many of the ascending ω² count as zero: the leading ones up to the `rounding` of each, if they are at most a thousandth of
/// the one that follows them. The soft part of a stiff object lies low, too, but not far below all others.
inline Index num_zero_modes(VectorIn omega_squared, VectorIn rounding) {
  const Index r = omega_squared.size();
  Index zero = 0;
  while (zero < r && omega_squared[zero] <= rounding[zero]) ++zero;
  while (0 < zero && zero < r && omega_squared[zero - 1] > 1e-3 * omega_squared[zero]) --zero;
  return zero;
}

}  // namespace supple
