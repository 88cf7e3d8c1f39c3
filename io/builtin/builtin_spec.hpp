#pragma once
/// \file Parser of the texts that name built-in meshes with their sizes, such as "bar:80x20x10".

#include <core/check.hpp>

#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A name, and what stands behind its ':'; and how it fails.
struct BuiltinSpec {
  static constexpr double max_size = 3e7;  ///< elements, or cells of a lattice

  std::string_view text, name, parameters;

  explicit BuiltinSpec(std::string_view spec);
  /// So many whole numbers ≥ 1 between separators. \throws InputError that tells the expectation.
  std::vector<Index> numbers(std::size_t count, char separator, const std::string& expectation) const;
  /// \throws InputError if a mesh would be too large.
  void expect_size(double size) const;
  [[noreturn]] void fail(const std::string& message) const;
};

double product(const std::vector<Index>& numbers);

}  // namespace supple
