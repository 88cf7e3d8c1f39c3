#include <io/mesh/mesh_formats.hpp>

namespace supple {
namespace {

/// Bytes of one number of a legacy type; 0 if it is not known.
std::size_t size_of(std::string_view type) {
  if (type == "char" || type == "unsigned_char") return 1;
  if (type == "short" || type == "unsigned_short") return 2;
  if (type == "int" || type == "unsigned_int" || type == "float") return 4;
  if (type == "long" || type == "unsigned_long" || type == "double" || type == "vtktypeint64" || type == "vtkIdType")
    return 8;
  return 0;
}

class LegacyVtkReader {
 public:
  LegacyVtkReader(Cursor& in, FileMesh& mesh) : in_(in), mesh_(mesh) {}

  void read() {
    in_.rest_of_line(), in_.rest_of_line();  // "# vtk DataFile Version 3.0", title
    const std::string_view mode = in_.word();
    if (mode != "ASCII" && mode != "BINARY") in_.fail("expected ASCII or BINARY");
    is_binary_ = mode == "BINARY";
    mesh_.format = std::string("VTK legacy, ") + (is_binary_ ? "binary" : "ASCII");
    in_.expect("DATASET");
    if (const std::string_view kind = in_.word(); kind != "UNSTRUCTURED_GRID")
      in_.fail("expected DATASET UNSTRUCTURED_GRID, found " + std::string(kind.substr(0, 40)));
    for (std::string_view keyword = in_.word(); !keyword.empty(); keyword = in_.word()) {
      if (keyword == "POINTS")
        read_points();
      else if (keyword == "CELLS")
        read_cells();
      else if (keyword == "CELL_TYPES")
        read_array(in_.count("cell types", is_binary_ ? 4 : 1), "int", cells_.types);
      else if (keyword == "METADATA")
        skip_metadata();
      else if (keyword == "FIELD")
        read_field(/*is_cell_data=*/false);
      else if (keyword == "CELL_DATA" || keyword == "POINT_DATA") {
        if (keyword == "CELL_DATA") read_regions();
        break;
      } else
        in_.fail("expected POINTS, CELLS or CELL_TYPES, found \"" + std::string(keyword.substr(0, 40)) + "\"");
    }
    add_vtk_cells(cells_, 0, in_, mesh_);
  }

 private:
  template <typename Number>
  void read_array(Index count, std::string_view type, std::vector<Number>& values) {
    const std::size_t size = size_of(type);
    const bool is_floating = type == "float" || type == "double";
    if (size == 0 || (is_floating && std::is_integral_v<Number>))
      in_.fail("numbers of type " + std::string(type.substr(0, 40)) + " are not expected here");
    in_.expect_room(count, is_binary_ ? size : 1, "numbers");
    values.resize(count);
    if (!is_binary_) {
      for (Number& value : values)
        if constexpr (std::is_integral_v<Number>)
          value = in_.integer("a whole number");
        else
          value = in_.real("a number");
      return;
    }
    in_.rest_of_line();
    in_.set_binary(std::endian::big);
    const auto take = [&]<typename Stored>(Stored) {
      for (Number& value : values) value = static_cast<Number>(in_.template take<Stored>("numbers"));
    };
    const bool is_signed = !type.starts_with("unsigned");
    if (is_floating)
      size == 4 ? take(float{}) : take(double{});
    else if (size == 1)
      is_signed ? take(std::int8_t{}) : take(std::uint8_t{});
    else if (size == 2)
      is_signed ? take(std::int16_t{}) : take(std::uint16_t{});
    else if (size == 4)
      is_signed ? take(std::int32_t{}) : take(std::uint32_t{});
    else
      take(std::int64_t{});
    in_.set_text();
  }

  /// Up to the next empty line.
  void skip_metadata() {
    in_.rest_of_line();
    while (!in_.rest_of_line().empty()) {
    }
  }

  void read_points() {
    const Index count = in_.count("points", is_binary_ ? 3 : 5);
    const std::string type(in_.word());
    std::vector<double> coordinates;
    read_array(3 * count, type, coordinates);
    mesh_.nodes.clear();
    for (Index v = 0; v < count; ++v) mesh_.nodes.emplace_back(Point::Map(&coordinates[3 * v]));
  }

  /// Before version 5 a list "4 a b c d" of so many numbers; since then offsets and connectivity.
  void read_cells() {
    const Index count = in_.count("cells", is_binary_ ? 4 : 1);
    const Index size = in_.count("numbers", is_binary_ ? 4 : 1);
    if (in_.peek() == "OFFSETS") {
      in_.word();
      const std::string offsets_type(in_.word());
      read_array(count, offsets_type, cells_.offsets);
      in_.expect("CONNECTIVITY");
      const std::string connectivity_type(in_.word());
      read_array(size, connectivity_type, cells_.connectivity);
      return;
    }
    std::vector<std::int64_t> list;
    read_array(size, "int", list);
    cells_.offsets.assign(1, 0);
    cells_.connectivity.clear();
    Index at = 0;
    for (Index c = 0; c < count; ++c) {
      if (at >= size || list[at] < 0 || list[at] > size - at - 1)
        in_.fail("cell " + std::to_string(c) + " reaches outside the list of node numbers");
      cells_.connectivity.insert(cells_.connectivity.end(), &list[at] + 1, &list[at] + 1 + list[at]);
      cells_.offsets.push_back(static_cast<std::int64_t>(cells_.connectivity.size()));
      at += 1 + list[at];
    }
  }

  /// Cell data up to the first array of regions; anything else that is not an array of numbers ends the
  /// search.
  void read_regions() {
    const Index count = in_.count("cells", is_binary_ ? 1 : 0);
    for (std::string_view keyword = in_.word(); keyword == "SCALARS" || keyword == "FIELD"; keyword = in_.word()) {
      if (keyword == "FIELD") {
        read_field(/*is_cell_data=*/true);
        continue;
      }
      const std::string name(in_.word()), type(in_.word());
      if (const std::string_view next = in_.word(); next != "LOOKUP_TABLE") {
        if (next != "1") return;
        in_.expect("LOOKUP_TABLE");
      }
      in_.word();
      keep_region(name, count, type);
    }
  }

  void read_field(bool is_cell_data) {
    in_.word();
    const Index num_arrays = in_.count("arrays", 8);
    for (Index k = 0; k < num_arrays; ++k) {
      const std::string name(in_.word());
      const Index components = in_.count("components", 1), count = in_.count("tuples", 1);
      if (components != 0 && count > static_cast<Index>(in_.num_left()) / components)
        in_.fail("the array " + name + " does not fit in the file");
      const std::string type(in_.word());
      keep_region(is_cell_data ? name : "", components * count, type);
    }
  }

  void keep_region(const std::string& name, Index count, const std::string& type) {
    std::vector<double> values;
    read_array(count, type, values);
    if (cells_.region.empty() && is_region_array(name)) cells_.region = std::move(values);
  }

  Cursor& in_;
  FileMesh& mesh_;
  VtkCells cells_;
  bool is_binary_ = false;
};

}  // namespace

/// \see VTK File Formats, "Simple Legacy Formats"; binary numbers are big-endian.
void read_legacy_vtk(Cursor& in, FileMesh& mesh) {
  LegacyVtkReader(in, mesh).read();
}

}  // namespace supple
