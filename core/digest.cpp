#include <core/digest.hpp>

#define XXH_INLINE_ALL  // nothing to link
#include <xxhash.h>

namespace supple {

Digest& Digest::add(std::span<const std::byte> bytes) {
  value_ = XXH3_64bits_withSeed(bytes.data(), bytes.size(), value_);
  return *this;
}

Digest& Digest::add(const SparseMatrix& matrix) {
  const auto outer = static_cast<std::size_t>(matrix.outerSize() + 1),
             count = static_cast<std::size_t>(matrix.nonZeros());
  return add(matrix.rows())
      .add(matrix.cols())
      .add(std::as_bytes(std::span(matrix.outerIndexPtr(), outer)))
      .add(std::as_bytes(std::span(matrix.innerIndexPtr(), count)))
      .add(std::as_bytes(std::span(matrix.valuePtr(), count)));
}

std::string Digest::text() const {
  std::string hex(16, '0');
  std::uint64_t rest = value_;
  for (auto digit = hex.rbegin(); digit != hex.rend(); ++digit, rest >>= 4) *digit = "0123456789abcdef"[rest & 15];
  return hex;
}

}  // namespace supple
