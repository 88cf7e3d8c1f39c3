#pragma once
/// \file Numbers in sentences.

#include <charconv>
#include <cstdio>
#include <string>
#include <type_traits>

namespace supple {

/// The shortest text that gives back the same number.
template <typename Number>
requires std::is_arithmetic_v<Number> std::string exact(Number value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

/// A number for people, of so many significant digits at most: "0.0123", "1.5e+06", "nan".
inline std::string shown(double value, int digits = 4) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

}  // namespace supple
