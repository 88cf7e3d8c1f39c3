#pragma once
/// \file Digest of numbers and texts: equal for equal bits.

#include <core/types.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace supple {

/// XXH3 (64 bits) of everything added, in its order: enough to know things again, nothing against intent.
class Digest {
 public:
  Digest& add(std::span<const std::byte> bytes);
  Digest& add(std::string_view text) { return add(text.size()).add(std::as_bytes(std::span(text))); }
  Digest& add(const char* text) { return add(std::string_view(text)); }
  template <typename Number>
  requires(std::is_arithmetic_v<Number> || std::is_enum_v<Number>) Digest& add(Number number) {
    return add(std::as_bytes(std::span(&number, 1)));
  }
  template <typename Number>
  requires std::is_arithmetic_v<Number> Digest& add(const std::vector<Number>& numbers) {
    return add(numbers.size()).add(std::as_bytes(std::span(numbers)));
  }
  /// Shape and values.
  template <typename Derived>
  Digest& add(const Eigen::PlainObjectBase<Derived>& matrix) {
    return add(matrix.rows())
        .add(matrix.cols())
        .add(std::as_bytes(std::span(matrix.data(), std::size_t(matrix.size()))));
  }
  Digest& add(const SparseMatrix& matrix);

  /// 16 hexadecimal digits.
  std::string text() const;

 private:
  std::uint64_t value_ = 0;
};

}  // namespace supple
