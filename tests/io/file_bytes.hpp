#pragma once
/// \file Numbers as the files of our tests have them.

#include <core/types.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string>

namespace supple::test {

/// The shortest text that is read as x again.
inline std::string text(double x) {
  std::array<char, 32> digits;
  return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr};
}

/// The bytes of a number, last byte first if asked for.
template <typename Number>
std::string raw(Number value, bool big_endian = false) {
  std::string bytes(sizeof(Number), '\0');
  std::memcpy(bytes.data(), &value, sizeof(Number));
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

/// "x y z" of a node.
template <typename Mesh>
std::string xyz(const Mesh& mesh, Index v) {
  return text(mesh.nodes(v, 0)) + " " + text(mesh.nodes(v, 1)) + " " + text(mesh.nodes(v, 2));
}

}  // namespace supple::test
