#include <core/check.hpp>
#include <core/digest.hpp>
#include <core/output_file.hpp>
#include <core/parallel.hpp>
#include <core/tensor_file.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <numeric>
#include <optional>
#include <set>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace supple {

namespace {

static_assert(std::endian::native == std::endian::little, "arrays are read and written in place");

using Json = nlohmann::json;

constexpr std::size_t alignment = 64;
constexpr std::size_t largest_header = 100'000'000;  // the limit of the reference implementation
constexpr int deepest_header = 8;                    // ours have three levels
constexpr int newest_layout = 1;
constexpr std::string_view layout_key = "supple.layout";
constexpr std::string_view header_key = "supple.xxh3";
constexpr std::string_view pad_prefix = ".pad";

std::string array_key(std::string_view name) {
  return std::string(header_key) + ":" + std::string(name);
}

std::string checksum(std::span<const std::byte> bytes) {
  return Digest().add(bytes).text();
}

/// Of the header without its own checksum, in the one spelling that a writer gives it.
std::string header_checksum(Json header) {
  header["__metadata__"].erase(std::string(header_key));
  const std::string text = header.dump();
  return checksum(std::as_bytes(std::span(text)));
}

std::size_t round_up(std::size_t size) {
  return (size + alignment - 1) / alignment * alignment;
}

/// Product of the shape, if it and the number of bytes are representable.
std::optional<std::size_t> count_values(const std::vector<Index>& shape, DType dtype) {
  Index count = 1;
  for (const Index extent : shape)
    if (extent < 0 || __builtin_mul_overflow(count, extent, &count)) return {};
  Index bytes;
  if (__builtin_mul_overflow(count, static_cast<Index>(size_of(dtype)), &bytes)) return {};
  return static_cast<std::size_t>(count);
}

std::string to_string(std::span<const Index> shape) {
  std::string text = "[";
  for (const Index extent : shape)
    text += (text.size() > 1 ? ", " : "") + (extent == TensorFile::any ? "any" : std::to_string(extent));
  return text + "]";
}

std::optional<DType> parse_dtype(std::string_view text) {
  for (const DType dtype : {DType::F64, DType::F32, DType::I64, DType::I32, DType::U8})
    if (text == to_string(dtype)) return dtype;
  return {};
}

/// A name as it may stand in a message: short, and without control characters.
std::string shown(std::string_view name) {
  std::string text;
  for (const char c : name.substr(0, 80)) text += static_cast<unsigned char>(c) < 32 ? '?' : c;
  return "'" + text + (name.size() > 80 ? "…'" : "'");
}

}  // namespace

std::string_view to_string(DType dtype) {
  switch (dtype) {
    case DType::F64:
      return "F64";
    case DType::F32:
      return "F32";
    case DType::I64:
      return "I64";
    case DType::I32:
      return "I32";
    case DType::U8:
      return "U8";
  }
  return "unknown";
}

void TensorFileWriter::add_bytes(std::string name, DType dtype, std::span<const std::byte> bytes,
                                 std::vector<Index> shape) {
  require(!name.empty() && name != "__metadata__" && !name.starts_with(pad_prefix),
          "name of an array is " + shown(name) + ", expected neither empty nor reserved");
  require(std::ranges::none_of(arrays_, [&](const auto& array) { return array.first == name; }),
          "array " + shown(name) + " was added before");
  const std::optional<std::size_t> count = count_values(shape, dtype);
  require(count && *count * size_of(dtype) == bytes.size(),
          "array " + shown(name) + " has shape " + to_string(shape) + " and " +
              std::to_string(bytes.size() / size_of(dtype)) + " values");
  arrays_.emplace_back(std::move(name), Array{dtype, std::move(shape), {bytes.begin(), bytes.end()}});
}

void TensorFileWriter::write(const std::filesystem::path& path) const {
  Json header = Json::object();
  Json& text = header["__metadata__"] = Json::object();
  for (const auto& [key, value] : metadata) {
    require(!key.starts_with("supple."), "metadata key " + shown(key) + " is reserved");
    text[key] = value;
  }
  std::size_t offset = 0;
  const auto place = [&](const std::string& name, DType dtype, const std::vector<Index>& shape, std::size_t size) {
    header[name] = {{"dtype", to_string(dtype)}, {"shape", shape}, {"data_offsets", {offset, offset + size}}};
    offset += size;
  };
  for (const auto& [name, array] : arrays_) {
    place(name, array.dtype, array.shape, array.bytes.size());
    header["__metadata__"][array_key(name)] = checksum(array.bytes);
    if (const std::size_t gap = round_up(offset) - offset)
      place(std::string(pad_prefix) + std::to_string(offset), DType::U8, {static_cast<Index>(gap)}, gap);
  }
  header["__metadata__"][std::string(layout_key)] = std::to_string(newest_layout);
  std::string head;
  try {
    header["__metadata__"][std::string(header_key)] = header_checksum(header);
    head = header.dump();
  } catch (const Json::type_error&) {
    throw std::invalid_argument("a name or metadata text of " + path.string() + " is not UTF-8");
  }
  head.append(round_up(8 + head.size()) - 8 - head.size(), ' ');
  require(head.size() <= largest_header, "header of " + path.string() + " is longer than 100 MB");

  OutputFile file(path);
  const std::array<std::uint64_t, 1> length{head.size()};
  file.write(std::as_bytes(std::span(length)));
  file.write(head);
  constexpr std::array<std::byte, alignment> zeros{};
  for (const auto& [name, array] : arrays_) {
    file.write(array.bytes);
    file.write(std::span(zeros).first(round_up(array.bytes.size()) - array.bytes.size()));
  }
  file.commit();
}

struct TensorFile::Mapping {
  explicit Mapping(const std::filesystem::path& path) {
    const auto fail = [&] { throw InputError(path.string() + ": cannot be read: " + std::strerror(errno)); };
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) fail();
    struct stat status;
    void* address = nullptr;
    const bool known = ::fstat(descriptor, &status) == 0;
    const bool regular = known && S_ISREG(status.st_mode);
    if (regular && status.st_size > 0)
      address = ::mmap(nullptr, static_cast<std::size_t>(status.st_size), PROT_READ, MAP_SHARED, descriptor, 0);
    const int error = errno;
    ::close(descriptor);
    errno = error;
    if (!known || address == MAP_FAILED) fail();
    if (!regular) throw InputError(path.string() + ": cannot be read: it is not a regular file");
    bytes = {static_cast<const std::byte*>(address), static_cast<std::size_t>(status.st_size)};
  }
  ~Mapping() {
    if (!bytes.empty()) ::munmap(const_cast<std::byte*>(bytes.data()), bytes.size());
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;

  std::span<const std::byte> bytes;
};

TensorFile::TensorFile(TensorFile&&) noexcept = default;
TensorFile& TensorFile::operator=(TensorFile&&) noexcept = default;
TensorFile::~TensorFile() = default;

TensorFile::TensorFile(const std::filesystem::path& path, Checksums checksums)
    : path_(path), mapping_(std::make_unique<Mapping>(path)) {
  const auto refuse = [&](const std::string& reason) { throw InputError(path_.string() + ": " + reason); };
  const std::span<const std::byte> file = mapping_->bytes;
  std::uint64_t head_size = 0;
  if (file.size() < 10) refuse("not a safetensors file: it has only " + std::to_string(file.size()) + " bytes");
  std::memcpy(&head_size, file.data(), 8);
  if (file[8] != std::byte{'{'} || head_size > largest_header)
    refuse("not a safetensors file: expected the length of a JSON header and '{'");
  if (head_size > file.size() - 8)
    refuse("truncated: the header has " + std::to_string(head_size) + " bytes, the file only " +
           std::to_string(file.size()));
  const std::string_view head(reinterpret_cast<const char*>(file.data()) + 8, head_size);
  const std::span<const std::byte> data = file.subspan(8 + head_size);
  if (head.find('\0') != head.npos) refuse("header: not valid JSON");  // the parser would take it for the end

  std::set<std::string> names;
  const auto check_event = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > deepest_header) refuse("header: is nested too deeply");  // to be copied and spelled, one call a level
    if (event == Json::parse_event_t::key && depth == 1 && !names.insert(parsed.get<std::string>()).second)
      refuse("header: " + shown(parsed.get<std::string>()) + " appears twice");
    return true;
  };
  Json header;
  try {
    header = Json::parse(head, check_event);
  } catch (const Json::exception&) {
    refuse("header: not valid JSON");
  }

  const auto text = header.find("__metadata__");
  const bool ours = text != header.end() && text->is_object() && text->contains(layout_key) &&
                    text->contains(header_key) &&
                    std::ranges::all_of(*text, [](const Json& value) { return value.is_string(); });
  if (!ours) refuse("not written by Supple: expected '" + std::string(layout_key) + "' in __metadata__");
  const std::string layout = text->at(std::string(layout_key));
  if (layout != std::to_string(newest_layout))
    refuse("written in layout " + shown(layout) + " by another version of Supple; this one reads layout " +
           std::to_string(newest_layout));
  const std::string spelled = header.dump();  // other spellings mean the same, but no writer of ours has them
  if (text->at(std::string(header_key)) != header_checksum(header) || !head.starts_with(spelled) ||
      head.find_first_not_of(' ', spelled.size()) != head.npos)
    refuse("damaged: the header does not match its checksum");

  struct Range {
    std::size_t begin, end;
    std::string name;
  };
  std::vector<Range> ranges;
  for (const auto& [name, entry] : header.items()) {
    if (name == "__metadata__") continue;
    const auto refuse_entry = [&, &array = name](const std::string& reason) {
      refuse("array " + shown(array) + ": " + reason);
    };
    const auto naturals = [](const Json& list) {
      return list.is_array() &&
             std::ranges::all_of(list, [](const Json& i) { return i.is_number_unsigned() && i <= INT64_MAX; });
    };
    if (!entry.is_object() || entry.size() != 3 || !entry.contains("dtype") || !entry["dtype"].is_string() ||
        !entry.contains("shape") || !naturals(entry["shape"]) || !entry.contains("data_offsets") ||
        !naturals(entry["data_offsets"]) || entry["data_offsets"].size() != 2)
      refuse_entry("expected dtype, shape and data_offsets");
    const std::optional<DType> dtype = parse_dtype(entry["dtype"].get_ref<const std::string&>());
    if (!dtype)
      refuse_entry("has type " + shown(entry["dtype"].get_ref<const std::string&>()) +
                   ", expected F64, F32, I64, I32 or U8");
    const auto shape = entry["shape"].get<std::vector<Index>>();
    const std::optional<std::size_t> count = count_values(shape, *dtype);
    const std::size_t begin = entry["data_offsets"][0], end = entry["data_offsets"][1];
    if (begin > end || end > data.size())
      refuse("truncated: expected at least " + std::to_string(8 + head_size + end) + " bytes, the file has " +
             std::to_string(8 + head_size + data.size()));
    if (!count || *count * size_of(*dtype) != end - begin)
      refuse_entry("shape " + to_string(shape) + " does not fit its " + std::to_string(end - begin) + " bytes");
    ranges.push_back({begin, end, name});
    if (name.starts_with(pad_prefix)) {
      if (std::ranges::any_of(data.subspan(begin, end - begin), [](std::byte b) { return b != std::byte{}; }))
        refuse_entry("damaged: expected zeros");
      continue;
    }
    if ((8 + head_size + begin) % alignment != 0) refuse_entry("does not start at a multiple of 64 bytes");
    if (!text->contains(array_key(name))) refuse_entry("has no checksum");
    tensors_[name] = {*dtype, shape, data.subspan(begin, end - begin)};
  }
  std::ranges::sort(
      ranges, [](const Range& a, const Range& b) { return std::pair(a.begin, a.end) < std::pair(b.begin, b.end); });
  std::size_t expected = 0;
  for (const Range& range : ranges) {
    if (range.begin != expected)
      refuse("array " + shown(range.name) + " starts at byte " + std::to_string(range.begin) + ", expected " +
             std::to_string(expected) + ": arrays may neither overlap nor leave holes");
    expected = range.end;
  }
  if (expected != data.size())
    refuse("arrays end at byte " + std::to_string(expected) + " of " + std::to_string(data.size()));

  if (checksums == Checksums::Verify)
    for (const auto& [name, tensor] : tensors_)
      if (text->at(array_key(name)) != checksum(tensor.bytes))
        refuse("damaged: array " + shown(name) + " does not match its checksum");
  for (const auto& [key, value] : text->items())
    if (!key.starts_with("supple.")) metadata_[key] = value;
}

const std::string& TensorFile::metadata(std::string_view key) const {
  const auto entry = metadata_.find(key);
  if (entry == metadata_.end()) throw InputError(path_.string() + ": expected metadata " + shown(key));
  return entry->second;
}

const TensorFile::Tensor& TensorFile::tensor(std::string_view name) const {
  const auto entry = tensors_.find(name);
  if (entry == tensors_.end()) throw InputError(path_.string() + ": expected an array " + shown(name));
  return entry->second;
}

const TensorFile::Tensor& TensorFile::typed(std::string_view name, DType dtype) const {
  const Tensor& found = tensor(name);
  if (found.dtype != dtype)
    throw InputError(path_.string() + ": array " + shown(name) + " has type " + std::string(to_string(found.dtype)) +
                     ", expected " + std::string(to_string(dtype)));
  return found;
}

void TensorFile::require_shape(std::string_view name, std::initializer_list<Index> shape) const {
  const std::vector<Index>& found = tensor(name).shape;
  if (!std::ranges::equal(found, shape, [](Index a, Index b) { return a == b || b == any; }))
    throw InputError(path_.string() + ": array " + shown(name) + " has shape " + to_string(found) + ", expected " +
                     to_string(std::span(shape)));
}

Eigen::Map<const RowMatrix> TensorFile::matrix(std::string_view name, Index rows, Index cols) const {
  const std::span<const double> entries = values<double>(name, {rows, cols});
  return {entries.data(), shape(name)[0], shape(name)[1]};
}

Eigen::Map<const Vector> TensorFile::vector(std::string_view name, Index size) const {
  const std::span<const double> entries = values<double>(name, {size});
  return {entries.data(), static_cast<Index>(entries.size())};
}

}  // namespace supple
