#pragma once
/// \file Colours, and maps from numbers to colours whose steps look equal.

#include <core/types.hpp>

namespace supple {

/// sRGB as on the screen, each in [0, 1].
struct Colour {
  double r = 0, g = 0, b = 0;

  friend bool operator==(const Colour&, const Colour&) = default;
};
constexpr Colour rgb(unsigned hex) {
  return {((hex >> 16) & 255) / 255.0, ((hex >> 8) & 255) / 255.0, (hex & 255) / 255.0};
}

/// Proportional to light, which may be added and averaged; and back, clamped to what a screen shows.
Eigen::Vector3f to_linear(const Colour& colour);
Colour to_screen(const Eigen::Vector3f& linear);

enum class ColourMap {
  Sequential,  ///< dark violet to light yellow, lightness evenly increasing: amounts
  Diverging,   ///< blue to red through light grey, equally dark on both sides: deviations from a middle
};

/// The colour of `share` in [0, 1] (clamped; a NaN is grey).
/// \see Ottosson 2020 (Oklab, the space of equal steps).
Colour map_colour(ColourMap map, double share);

}  // namespace supple
