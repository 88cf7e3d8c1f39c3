#pragma once
/// \file File of named arrays, in the published safetensors layout: any safetensors reader opens it.
///
/// 8 bytes length of the header (little-endian) · JSON header, padded by spaces · arrays, little-endian,
/// row-major, without holes. On top of that layout a file of ours promises: every array starts at a multiple
/// of 64 bytes (arrays named ".pad…" of type U8 fill up), and `__metadata__` holds "supple.layout" (the
/// version), "supple.xxh3" (a checksum of the header) and "supple.xxh3:<name>" (a checksum of each array;
/// XXH3-64, hexadecimal).

#include <core/types.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

enum class DType { F64, F32, I64, I32, U8 };
constexpr std::size_t size_of(DType dtype) {
  return dtype == DType::F64 || dtype == DType::I64 ? 8 : dtype == DType::U8 ? 1 : 4;
}
std::string_view to_string(DType dtype);

/// The scalar types an array may have.
template <typename T>
concept TensorScalar = std::same_as<T, double> || std::same_as<T, float> || std::same_as<T, std::int64_t> ||
    std::same_as<T, std::int32_t> || std::same_as<T, std::uint8_t>;
template <TensorScalar T>
constexpr DType dtype_of = std::same_as<T, double>         ? DType::F64
                           : std::same_as<T, float>        ? DType::F32
                           : std::same_as<T, std::int64_t> ? DType::I64
                           : std::same_as<T, std::int32_t> ? DType::I32
                                                           : DType::U8;

/// Collects arrays (copied: the caller's may go) and writes them at once.
class TensorFileWriter {
 public:
  /// Free text of the file, UTF-8; keys that start with "supple." are the file's own.
  std::map<std::string, std::string> metadata;

  /// Adds an array of any rank, row-major.
  /// \throws std::invalid_argument if the name is empty, reserved or taken, or the shape does not fit the
  /// number of values.
  template <TensorScalar T>
  void add(std::string name, std::span<const T> values, std::vector<Index> shape) {
    add_bytes(std::move(name), dtype_of<T>, std::as_bytes(values), std::move(shape));
  }
  template <TensorScalar T>
  void add(std::string name, const std::vector<T>& values) {
    add(std::move(name), std::span<const T>(values), {static_cast<Index>(values.size())});
  }
  /// m × k, as the stencils of a mesh.
  template <TensorScalar T, std::size_t k>
  void add(std::string name, const std::vector<std::array<T, k>>& rows) {
    add(std::move(name), std::span<const T>(rows.empty() ? nullptr : rows.front().data(), rows.size() * k),
        {static_cast<Index>(rows.size()), static_cast<Index>(k)});
  }
  /// A vector gets shape [n], anything else [rows, cols].
  template <typename Derived>
  void add(std::string name, const Eigen::DenseBase<Derived>& matrix) {
    using Scalar = typename Derived::Scalar;
    const Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = matrix;
    std::vector<Index> shape{rows.rows()};
    if (Derived::ColsAtCompileTime != 1) shape.push_back(rows.cols());
    add(std::move(name), std::span<const Scalar>(rows.data(), static_cast<std::size_t>(rows.size())), std::move(shape));
  }

  /// Writes all arrays. The new file takes the old one's name only when it is safely on the disk; after a
  /// failure the old file stands and nothing partial remains. Writing again gives the same bytes.
  /// \throws InputError if the file cannot be written; std::invalid_argument if a text is not UTF-8 or a key
  /// reserved.
  void write(const std::filesystem::path& path) const;

 private:
  struct Array {
    DType dtype;
    std::vector<Index> shape;
    std::vector<std::byte> bytes;
  };
  void add_bytes(std::string name, DType dtype, std::span<const std::byte> bytes, std::vector<Index> shape);

  std::vector<std::pair<std::string, Array>> arrays_;
};

enum class Checksums {
  Verify,  ///< read the whole file once when it is opened
  Skip,    ///< of the arrays; choose it to open huge files that were verified before (the header always is)
};

/// A file written by TensorFileWriter, mapped into memory. Everything is checked on opening, so a truncated,
/// foreign, newer or damaged file never gets further. Arrays are views into the file: they live as long as
/// this object, and the file must not be shortened meanwhile (TensorFileWriter never does: it replaces
/// files).
/// \throws InputError naming the file, the array and what was expected, from the constructor and every
/// access.
class TensorFile {
 public:
  explicit TensorFile(const std::filesystem::path& path, Checksums checksums = Checksums::Verify);
  TensorFile(TensorFile&&) noexcept;
  TensorFile& operator=(TensorFile&&) noexcept;
  ~TensorFile();

  struct Tensor {
    DType dtype;
    std::vector<Index> shape;
    std::span<const std::byte> bytes;
  };
  static constexpr Index any = -1;

  const std::filesystem::path& path() const { return path_; }
  /// All arrays by name, without the padding.
  const std::map<std::string, Tensor, std::less<>>& tensors() const { return tensors_; }
  bool contains(std::string_view name) const { return tensors_.contains(name); }
  /// The writer's free text, without the file's own keys.
  const std::map<std::string, std::string, std::less<>>& metadata() const { return metadata_; }
  const std::string& metadata(std::string_view key) const;
  const std::vector<Index>& shape(std::string_view name) const { return tensor(name).shape; }

  /// F64 of rank 2; rows and cols are demanded unless `any`.
  Eigen::Map<const RowMatrix> matrix(std::string_view name, Index rows = any, Index cols = any) const;
  /// F64 of rank 1.
  Eigen::Map<const Vector> vector(std::string_view name, Index size = any) const;
  /// I64 of any rank, row-major.
  std::span<const std::int64_t> integers(std::string_view name) const { return values<std::int64_t>(name); }
  /// Any type and rank, row-major; each dimension of a stated shape is demanded unless `any`.
  template <TensorScalar T>
  std::span<const T> values(std::string_view name) const {
    const std::span<const std::byte> bytes = typed(name, dtype_of<T>).bytes;
    return {reinterpret_cast<const T*>(bytes.data()), bytes.size() / sizeof(T)};
  }
  template <TensorScalar T>
  std::span<const T> values(std::string_view name, std::initializer_list<Index> shape) const {
    require_shape(name, shape);
    return values<T>(name);
  }

 private:
  const Tensor& tensor(std::string_view name) const;
  const Tensor& typed(std::string_view name, DType dtype) const;
  void require_shape(std::string_view name, std::initializer_list<Index> shape) const;

  struct Mapping;
  std::filesystem::path path_;
  std::unique_ptr<Mapping> mapping_;
  std::map<std::string, Tensor, std::less<>> tensors_;
  std::map<std::string, std::string, std::less<>> metadata_;
};

}  // namespace supple
