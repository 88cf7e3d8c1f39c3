#include <core/digest.hpp>
#include <tests/fuzz/tensor_edits.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

namespace supple::fuzz {

namespace {

using Json = nlohmann::json;

std::string checksum(std::string_view bytes) {
  return Digest().add(std::as_bytes(std::span(bytes))).text();
}

/// Numbers of a script in turn; zeros behind its end.
class Script {
 public:
  explicit Script(std::string_view bytes) : bytes_(bytes) {}
  bool done() const { return bytes_.empty(); }
  std::size_t next() {
    if (bytes_.empty()) return 0;
    const auto value = static_cast<unsigned char>(bytes_.front());
    bytes_.remove_prefix(1);
    return value;
  }
  /// 0 … count − 1.
  std::size_t below(std::size_t count) {
    const std::size_t low = next();
    return count <= 256 ? low % count : (low + 256 * next()) % count;
  }
  std::string text(std::size_t size) {
    std::string text(bytes_.substr(0, size));
    bytes_.remove_prefix(text.size());
    for (char& c : text) c &= 0x7f;  // UTF-8
    return text;
  }

 private:
  std::string_view bytes_;
};

template <typename T>
constexpr T largest = std::numeric_limits<T>::max();

constexpr std::array reals{0.0,
                           -1.0,
                           1.0,
                           0.5,
                           -0.5,
                           1e-300,
                           1e300,
                           5e-324,
                           largest<double>,
                           -largest<double>,
                           1e-9,
                           1e9,
                           0.499,
                           0.51,
                           1e150,
                           1e-150,
                           std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(),
                           -std::numeric_limits<double>::infinity()};
constexpr std::array<std::int64_t, 12> integers{0,
                                                -1,
                                                1,
                                                2,
                                                3,
                                                7,
                                                11,
                                                100,
                                                largest<std::int32_t>,
                                                -largest<std::int32_t> - 1,
                                                largest<std::int64_t>,
                                                -largest<std::int64_t> - 1};
constexpr std::array texts{"",
                           "0",
                           "-1",
                           "1",
                           "2",
                           "3",
                           "99999999999",
                           "1e999",
                           "nan",
                           "x",
                           "hat",
                           "stvk",
                           "fung",
                           "ogden",
                           "corotational",
                           "mooney-rivlin",
                           "neo-hookean",
                           "stable-neo-hookean",
                           "gauss-point",
                           "supple reduced model",
                           "supple trajectory"};

std::size_t num_values(const Tensors::Array& array) {
  return array.bytes.size() / size_of(array.dtype);
}

void set_value(Tensors::Array& array, std::size_t at, std::size_t which) {
  const auto put = [&](auto value) { std::memcpy(array.bytes.data() + at * sizeof value, &value, sizeof value); };
  const double real = reals[which % reals.size()];
  const std::int64_t integer = integers[which % integers.size()];
  if (array.dtype == DType::F64) put(real);
  if (array.dtype == DType::F32) put(static_cast<float>(std::clamp(real, -3e38, 3e38)));
  if (array.dtype == DType::I64) put(integer);
  if (array.dtype == DType::I32) put(static_cast<std::int32_t>(integer));
  if (array.dtype == DType::U8) put(static_cast<std::uint8_t>(integer));
}

/// Repeats or drops bytes until they fit the shape.
void fit_bytes(Tensors::Array& array) {
  std::size_t count = size_of(array.dtype);
  for (const Index extent : array.shape) count *= static_cast<std::size_t>(extent);
  if (count > 1 << 16) array.shape = {0}, count = 0;
  const std::size_t before = array.bytes.size();
  array.bytes.resize(count);
  for (std::size_t k = before; k < count; ++k) array.bytes[k] = before > 0 ? array.bytes[k - before] : std::byte{};
}

}  // namespace

std::string resealed(const std::string& file) {
  std::uint64_t length = 0;
  if (file.size() < 10) return file;
  std::memcpy(&length, file.data(), 8);
  length = std::min<std::uint64_t>(length, file.size() - 8);
  Json header = Json::parse(file.begin() + 8, file.begin() + 8 + static_cast<std::ptrdiff_t>(length), nullptr, false);
  if (!header.is_object() || !header.contains("__metadata__") || !header["__metadata__"].is_object()) return file;
  const std::string_view data = std::string_view(file).substr(8 + length);
  Json& metadata = header["__metadata__"];
  for (const auto& [name, entry] : header.items()) {
    if (!entry.is_object() || !entry.contains("data_offsets")) continue;
    const Json& range = entry["data_offsets"];
    if (!range.is_array() || range.size() != 2 || !range[0].is_number_unsigned() || !range[1].is_number_unsigned())
      continue;
    const std::size_t begin = range[0], end = range[1];
    if (begin <= end && end <= data.size() && metadata.contains("supple.xxh3:" + name))
      metadata["supple.xxh3:" + name] = checksum(data.substr(begin, end - begin));
  }
  metadata.erase("supple.xxh3");
  try {
    metadata["supple.xxh3"] = checksum(header.dump());
    std::string head = header.dump();
    head.append((64 - (8 + head.size()) % 64) % 64, ' ');
    length = head.size();
    return std::string(reinterpret_cast<const char*>(&length), 8) + head + std::string(data);
  } catch (const Json::type_error&) {  // not UTF-8
    return file;
  }
}

Tensors::Tensors(const std::filesystem::path& path) {
  const TensorFile file(path);
  metadata = {file.metadata().begin(), file.metadata().end()};
  for (const auto& [name, tensor] : file.tensors())
    arrays.push_back({name, tensor.dtype, tensor.shape, {tensor.bytes.begin(), tensor.bytes.end()}});
}

void Tensors::write(const std::filesystem::path& path) const {
  TensorFileWriter file;
  file.metadata = metadata;
  for (const Array& array : arrays) {
    const auto add = [&]<typename T>(T) {
      std::vector<T> values(num_values(array));
      if (!values.empty()) std::memcpy(values.data(), array.bytes.data(), array.bytes.size());
      file.add(array.name, std::span<const T>(values), array.shape);
    };
    if (array.dtype == DType::F64) add(double{});
    if (array.dtype == DType::F32) add(float{});
    if (array.dtype == DType::I64) add(std::int64_t{});
    if (array.dtype == DType::I32) add(std::int32_t{});
    if (array.dtype == DType::U8) add(std::uint8_t{});
  }
  file.write(path);
}

void Tensors::edit(std::string_view bytes) {
  constexpr std::size_t most_edits = 16;
  Script script(bytes);
  for (std::size_t k = 0; k < most_edits && !script.done() && !arrays.empty(); ++k) {
    const std::size_t kind = script.below(12);
    Array& array = arrays[script.below(arrays.size())];
    const std::size_t count = num_values(array);
    auto text = metadata.begin();
    if (kind >= 9 && metadata.empty()) continue;
    if (kind >= 9) std::advance(text, script.below(metadata.size()));
    switch (kind) {
      case 0:
      case 1:
        if (count > 0) set_value(array, script.below(count), script.next());
        break;
      case 2:  // one number in place of another
        if (count > 0) {
          const std::size_t size = size_of(array.dtype), from = script.below(count), to = script.below(count);
          std::memmove(array.bytes.data() + to * size, array.bytes.data() + from * size, size);
        }
        break;
      case 3:
        for (std::size_t at = 0, which = script.next(); at < count; ++at) set_value(array, at, which);
        break;
      case 4:
        if (!array.shape.empty()) {
          Index& extent = array.shape[script.below(array.shape.size())];
          constexpr std::array<Index, 6> changes{-2, -1, 1, 2, 8, -100};
          extent = std::max<Index>(0, extent + changes[script.below(changes.size())]);
          fit_bytes(array);
        }
        break;
      case 5:
        if (script.next() % 2 == 0)
          array.shape.push_back(1);
        else if (!array.shape.empty())
          array.shape.pop_back();
        fit_bytes(array);
        break;
      case 6:
        array.dtype = std::array{DType::F64, DType::F32, DType::I64, DType::I32, DType::U8}[script.below(5)];
        fit_bytes(array);
        break;
      case 7: {
        Array& other = arrays[script.below(arrays.size())];
        std::swap(array.dtype, other.dtype), std::swap(array.shape, other.shape), std::swap(array.bytes, other.bytes);
        break;
      }
      case 8:
        array = std::move(arrays.back());
        arrays.pop_back();
        break;
      case 9:
        if (text != metadata.end()) text->second = texts[script.below(texts.size())];
        break;
      case 10:
        if (text != metadata.end()) text->second = script.text(script.below(24));
        break;
      case 11:
        if (text != metadata.end()) metadata.erase(text);
        break;
    }
  }
}

}  // namespace supple::fuzz
