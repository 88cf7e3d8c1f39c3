#pragma once
/// \file Tensor files changed behind their checksums, so that what reads them gets to see the change.

#include <core/tensor_file.hpp>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace supple::fuzz {

/// The file with the checksums that its bytes call for. A header that cannot be understood stays as it is.
std::string resealed(const std::string& file);

/// Content of a tensor file, to be changed.
struct Tensors {
  struct Array {
    std::string name;
    DType dtype;
    std::vector<Index> shape;
    std::vector<std::byte> bytes;
  };
  std::map<std::string, std::string> metadata;
  std::vector<Array> arrays;

  explicit Tensors(const std::filesystem::path& path);
  void write(const std::filesystem::path& path) const;

  /// Carries out a script of any bytes: numbers set to special ones, extents, ranks and types changed, arrays and texts
  /// swapped, renamed, replaced and taken away. Bytes and shapes always fit, as only a writer gone mad would have it.
  void edit(std::string_view script);
};

}  // namespace supple::fuzz
