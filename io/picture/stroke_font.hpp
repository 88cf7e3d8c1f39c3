#pragma once
/// \file Stroke font for captions in pictures: a small alphabet of lines, no font files needed, sharp at every size.

#include <core/types.hpp>

#include <string_view>
#include <vector>

namespace supple {

/// The middle lines of a text: segments of one height of capitals = 1, y upwards from the baseline.
struct TextStrokes {
  struct Segment {
    Eigen::Vector2f a, b;
  };
  std::vector<Segment> segments;
  float width = 0;
};

/// Thickness of a stroke, and how far strokes reach below the baseline and above it, in heights of capitals.
constexpr float stroke_thickness = 0.125f, stroke_descent = 0.36f, stroke_ascent = 1.2f;

/// Lays out one line of UTF-8: ASCII, some Greek and mathematical signs; other characters show as a box.
TextStrokes lay_out(std::string_view text);

}  // namespace supple
