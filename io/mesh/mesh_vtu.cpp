#include <io/mesh/mesh_formats.hpp>

#include <pugixml.hpp>
#include <zlib.h>

#include <array>
#include <numeric>
#include <optional>

namespace supple {
namespace {

/// The bytes behind base64 digits, at most `limit`. Padding may also stand between two pieces, as VTK writes
/// them. Nothing if a character is none of the digits.
std::optional<std::string> decode_base64(std::string_view text, std::size_t limit = std::string_view::npos) {
  static constexpr auto digits = [] {
    std::array<signed char, 256> value{};
    value.fill(-1);
    constexpr std::string_view alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (std::size_t k = 0; k < alphabet.size(); ++k)
      value[static_cast<unsigned char>(alphabet[k])] = static_cast<signed char>(k);
    return value;
  }();
  std::string bytes;
  bytes.reserve(std::min(limit, text.size() / 4 * 3 + 3));
  std::uint32_t bits = 0;
  int num_bits = 0;
  for (const char c : text) {
    if (bytes.size() >= limit) break;
    if (static_cast<unsigned char>(c) <= ' ') continue;
    if (c == '=') {
      num_bits = 0;
      continue;
    }
    const int digit = digits[static_cast<unsigned char>(c)];
    if (digit < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    num_bits += 6;
    if (num_bits >= 8) bytes.push_back(static_cast<char>(bits >> (num_bits -= 8)));
  }
  return bytes;
}

/// The bytes of an array where the file has them, raw or as base64 digits.
struct StoredBytes {
  std::string name;  // of the array, in messages
  std::string_view text;
  bool is_raw;

  /// So many bytes from a place on; never allocates more than the text can hold.
  std::string from(std::size_t at, std::uint64_t count) const {
    const std::size_t capacity = text.size();
    if (at > capacity || count > capacity - at)
      fail("announces " + std::to_string(count) + " bytes, more than can follow");
    if (is_raw) return std::string(text.substr(at, count));
    std::optional<std::string> decoded = decode_base64(text, at + count);
    if (!decoded) fail("expected base64 digits");
    if (decoded->size() < at + count) fail("the base64 data ends too early");
    return decoded->substr(at);
  }
  [[noreturn]] void fail(const std::string& message) const { throw InputError(name + ": " + message); }
};

constexpr std::uint64_t max_compression = 1100;  // zlib shrinks to 1/1032 at best

class VtuReader {
 public:
  VtuReader(const Cursor& in, FileMesh& mesh) : in_(in), mesh_(mesh) {}

  void read() {
    parse_xml();
    const pugi::xml_node file = document_.child("VTKFile");
    if (!file) in_.fail_whole("expected an element VTKFile");
    if (const std::string type = file.attribute("type").value(); type != "UnstructuredGrid")
      in_.fail_whole("expected a VTKFile of type UnstructuredGrid, found \"" + type.substr(0, 40) + "\"");
    const std::string order = file.attribute("byte_order").as_string("LittleEndian");
    order_ = order == "BigEndian" ? std::endian::big : std::endian::little;
    header_size_ = std::string_view(file.attribute("header_type").value()) == "UInt64" ? 8 : 4;
    const std::string_view compressor = file.attribute("compressor").value();
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      in_.fail_whole("expected no compression or vtkZLibDataCompressor, found " +
                     std::string(compressor.substr(0, 40)));
    is_compressed_ = !compressor.empty();
    mesh_.format = "VTK XML";
    const pugi::xml_node grid = file.child("UnstructuredGrid");
    if (!grid.child("Piece")) in_.fail_whole("expected an element Piece");
    for (const pugi::xml_node piece : grid.children("Piece")) read_piece(piece);
  }

 private:
  /// Raw appended data is no XML, so the parser sees the file without it.
  void parse_xml() {
    std::string_view text = in_.bytes();
    std::string head;
    if (const std::size_t appended = text.find("<AppendedData"); appended != std::string_view::npos) {
      const std::size_t open = text.find('>', appended);
      if (open == std::string_view::npos) in_.fail_whole("the file ends inside the element AppendedData");
      const std::size_t mark = text.find('_', open);
      if (mark == std::string_view::npos) in_.fail_whole("expected _ at the begin of the appended data");
      appended_ = text.substr(mark + 1);
      head = std::string(text.substr(0, open + 1)) + "</AppendedData></VTKFile>";
      text = head;
    }
    const pugi::xml_parse_result result = document_.load_buffer(text.data(), text.size());
    if (result) {
      const std::string_view encoding =
          document_.child("VTKFile").child("AppendedData").attribute("encoding").as_string("raw");
      appended_is_raw_ = encoding == "raw";
      if (!appended_is_raw_ && encoding != "base64") in_.fail_whole("expected appended data encoded raw or base64");
      return;
    }
    Cursor place = in_;
    place.set_position(std::min<std::size_t>(result.offset, in_.bytes().size()));
    place.fail(std::string("expected well-formed XML: ") + result.description());
  }

  void read_piece(const pugi::xml_node& piece) {
    const auto num_nodes = static_cast<Index>(count(piece, "NumberOfPoints"));
    const auto num_cells = static_cast<Index>(count(piece, "NumberOfCells"));
    const pugi::xml_node points = piece.child("Points").child("DataArray");
    if (points.attribute("NumberOfComponents").as_int() != 3) in_.fail_whole("expected points of 3 components");
    const std::vector<double> coordinates = numbers<double>(points, "Points");
    if (num_nodes > static_cast<Index>(coordinates.size()) || 3 * num_nodes != static_cast<Index>(coordinates.size()))
      in_.fail_whole("expected " + std::to_string(num_nodes) + " points, found " + std::to_string(coordinates.size()) +
                     " coordinates");
    const auto first_node = static_cast<Index>(mesh_.nodes.size());
    for (Index v = 0; v < num_nodes; ++v) mesh_.nodes.emplace_back(Point::Map(&coordinates[3 * v]));

    VtkCells cells;
    for (const pugi::xml_node array : piece.child("Cells").children("DataArray")) {
      const std::string_view name = array.attribute("Name").value();
      if (name == "connectivity") cells.connectivity = numbers<std::int64_t>(array, name);
      if (name == "types") cells.types = numbers<std::int64_t>(array, name);
      if (name == "offsets") cells.offsets = numbers<std::int64_t>(array, name);
    }
    cells.offsets.insert(cells.offsets.begin(), 0);
    if (static_cast<Index>(cells.types.size()) != num_cells)
      in_.fail_whole("expected " + std::to_string(num_cells) + " cell types, found " +
                     std::to_string(cells.types.size()));
    for (const pugi::xml_node array : piece.child("CellData").children("DataArray")) {
      const std::string_view name = array.attribute("Name").value();
      if (!is_region_array(name)) continue;
      cells.region = numbers<double>(array, name);
      break;
    }
    if (mesh_.num_cells() > 0) cells.region.resize(mesh_.attribute.empty() ? 0 : num_cells);
    add_vtk_cells(cells, first_node, in_, mesh_);
    if (!mesh_.attribute.empty()) mesh_.attribute.resize(mesh_.num_cells());
  }

  std::uint64_t count(const pugi::xml_node& piece, const char* name) const {
    Cursor value(in_.name() + ", attribute " + name, piece.attribute(name).value());
    const std::int64_t count = value.integer("a count");
    if (count < 0) value.fail_whole("expected a count, found a negative number");
    if (static_cast<std::uint64_t>(count) > max_compression * in_.bytes().size())
      value.fail_whole("announces " + std::to_string(count) + " items, the file cannot hold them");
    return static_cast<std::uint64_t>(count);
  }

  template <typename Number>
  std::vector<Number> numbers(const pugi::xml_node& array, std::string_view name) const {
    Cursor text(in_.name() + ", array " + std::string(name), array.child_value());
    const std::string_view format = array.attribute("format").as_string("ascii");
    if (format == "ascii") {
      std::vector<Number> values;
      while (!text.peek().empty())
        if constexpr (std::is_integral_v<Number>)
          values.push_back(text.integer("a whole number"));
        else
          values.push_back(text.real("a number"));
      return values;
    }
    std::string bytes;
    if (format == "binary") {
      bytes = decode({text.name(), text.bytes(), /*is_raw=*/false});
    } else if (format == "appended") {
      const std::uint64_t offset = array.attribute("offset").as_ullong();
      if (offset >= appended_.size())
        text.fail_whole("begins at " + std::to_string(offset) + ", behind the appended data");
      bytes = decode({text.name(), appended_.substr(offset), appended_is_raw_});
    } else {
      text.fail_whole("expected the format ascii, binary or appended, found " + std::string(format.substr(0, 40)));
    }
    return convert<Number>(bytes, array.attribute("type").value(), text);
  }

  /// Header words, each UInt32 or UInt64: the number of bytes, then these; or, compressed: the number of
  /// blocks, bytes of a full block, bytes of the last one if it is not full, compressed bytes of each; then
  /// the blocks.
  std::string decode(const StoredBytes& stored) const {
    const std::uint64_t first = header_words(stored, 1)[0];
    if (!is_compressed_) return stored.from(header_size_, first);
    if (first == 0) return {};
    if (first > stored.text.size()) stored.fail("announces " + std::to_string(first) + " blocks, more than can follow");
    const std::vector<std::uint64_t> header = header_words(stored, 3 + first);
    std::string bytes;
    std::size_t at = header.size() * header_size_;
    std::uint64_t total = 0;
    for (std::size_t k = 3; k < header.size(); ++k) {
      const std::uint64_t limit = stored.text.size();
      if (header[k] > limit || (total += header[k]) > limit)
        stored.fail("announces blocks of " + std::to_string(header[k]) + " bytes, more than can follow");
    }
    const std::string packed = stored.from(at, total);
    at = 0;
    for (std::size_t k = 3; k < header.size(); ++k) {
      const bool is_last = k + 1 == header.size();
      const std::uint64_t size = is_last && header[2] != 0 ? header[2] : header[1];
      if (size > max_compression * header[k] + 64)
        stored.fail("announces a block of " + std::to_string(size) + " bytes, more than it can hold");
      const std::size_t before = bytes.size();
      bytes.resize(before + size);
      uLongf unpacked = size;
      const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data() + before), &unpacked,
                                    reinterpret_cast<const Bytef*>(packed.data() + at), header[k]);
      if (status != Z_OK || unpacked != size) stored.fail("the compressed data is damaged");
      at += header[k];
    }
    return bytes;
  }

  std::vector<std::uint64_t> header_words(const StoredBytes& stored, std::uint64_t count) const {
    const std::string bytes = stored.from(0, count * header_size_);
    Cursor in(stored.name, bytes);
    in.set_binary(order_);
    std::vector<std::uint64_t> words(count);
    for (std::uint64_t& word : words)
      word = header_size_ == 8 ? in.take<std::uint64_t>("a header") : in.take<std::uint32_t>("a header");
    return words;
  }

  template <typename Number>
  std::vector<Number> convert(const std::string& bytes, std::string_view type, const Cursor& array) const {
    Cursor in(array.name(), bytes);
    in.set_binary(order_);
    const auto take = [&]<typename Stored>(Stored) {
      if (bytes.size() % sizeof(Stored) != 0) array.fail_whole("holds a broken number");
      std::vector<Number> values(bytes.size() / sizeof(Stored));
      for (Number& value : values) value = static_cast<Number>(in.template take<Stored>("numbers"));
      return values;
    };
    if constexpr (!std::is_integral_v<Number>) {
      if (type == "Float32") return take(float{});
      if (type == "Float64") return take(double{});
    }
    if (type == "Int8") return take(std::int8_t{});
    if (type == "UInt8") return take(std::uint8_t{});
    if (type == "Int16") return take(std::int16_t{});
    if (type == "UInt16") return take(std::uint16_t{});
    if (type == "Int32") return take(std::int32_t{});
    if (type == "UInt32") return take(std::uint32_t{});
    if (type == "Int64" || type == "UInt64") return take(std::int64_t{});
    array.fail_whole("numbers of type \"" + std::string(type.substr(0, 40)) + "\" are not expected here");
  }

  const Cursor& in_;
  FileMesh& mesh_;
  pugi::xml_document document_;
  std::string_view appended_;
  bool appended_is_raw_ = true, is_compressed_ = false;
  std::endian order_ = std::endian::little;
  std::size_t header_size_ = 4;
};

}  // namespace

/// \see VTK File Formats, "XML File Formats".
void read_vtu(const Cursor& in, FileMesh& mesh) {
  VtuReader(in, mesh).read();
}

}  // namespace supple
