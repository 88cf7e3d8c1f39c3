#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/text.hpp>
#include <io/frames/vtu_writer.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace supple {

namespace {

static_assert(std::endian::native == std::endian::little, "arrays are written as they are in memory");

/// \see vtkCellType.h
constexpr std::uint8_t vtk_type(std::size_t num_nodes) {
  return num_nodes == 3 ? 5 : num_nodes == 4 ? 10 : num_nodes == 8 ? 12 : 24;
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) < 32 ? ' ' : c;
    }
  return result;
}

void check_fields(const std::vector<VtuField>& fields, Index rows) {
  for (auto field = fields.begin(); field != fields.end(); ++field) {
    require(!field->name.empty(), "a field has no name");
    require(field->values.cols() > 0, "field '" + field->name + "' has no columns");
    require_size("field '" + field->name + "'", field->values.rows(), rows);
    require(std::none_of(fields.begin(), field, [&](const VtuField& other) { return other.name == field->name; }),
            "two fields have the name '" + field->name + "'");
  }
}

/// The arrays' declarations, and the arrays in the order in which they follow the XML.
struct Appended {
  std::string xml;
  std::vector<std::span<const std::byte>> blocks;
  std::uint64_t offset = 0;

  template <typename T>
  void declare(std::string_view type, std::string_view name, Index components, std::span<const T> values) {
    xml += "        <DataArray type=\"" + std::string(type) + "\" Name=\"" + escaped(name) +
           "\" NumberOfComponents=\"" + std::to_string(components) + "\" format=\"appended\" offset=\"" +
           std::to_string(offset) + "\"/>\n";
    blocks.push_back(std::as_bytes(values));
    offset += sizeof(std::uint64_t) + values.size_bytes();
  }
  template <typename Derived>
  void declare(std::string_view name, const Eigen::PlainObjectBase<Derived>& values) {
    declare("Float64", name, values.cols(), std::span(values.data(), static_cast<std::size_t>(values.size())));
  }
};

template <std::size_t k>
void write_cells(const std::filesystem::path& path, const Points& nodes, std::span<const std::array<Index, k>> cells,
                 const VtuFields& fields) {
  const Index num_cells = static_cast<Index>(cells.size());
  check_fields(fields.point_data, nodes.rows());
  check_fields(fields.cell_data, num_cells);
  for (const auto& cell : cells)
    for (const Index node : cell)
      require(0 <= node && node < nodes.rows(),
              "a cell reads node " + std::to_string(node) + ", expected 0 to " + std::to_string(nodes.rows() - 1));

  std::vector<std::int64_t> offsets(cells.size());
  for (std::size_t e = 0; e < cells.size(); ++e) offsets[e] = static_cast<std::int64_t>((e + 1) * k);
  const std::vector<std::uint8_t> types(cells.size(), vtk_type(k));
  static_assert(sizeof(Index) == sizeof(std::int64_t));

  Appended arrays;
  const auto section = [&](const char* name, const auto& declare) {
    arrays.xml += "      <" + std::string(name) + ">\n";
    declare();
    arrays.xml += "      </" + std::string(name) + ">\n";
  };
  section("PointData", [&] {
    for (const VtuField& field : fields.point_data) arrays.declare(field.name, field.values);
  });
  section("CellData", [&] {
    for (const VtuField& field : fields.cell_data) arrays.declare(field.name, field.values);
  });
  section("Points", [&] { arrays.declare("Points", nodes); });
  section("Cells", [&] {
    arrays.declare("Int64", "connectivity", 1,
                   std::span(cells.empty() ? nullptr : cells.front().data(), cells.size() * k));
    arrays.declare("Int64", "offsets", 1, std::span(std::as_const(offsets)));
    arrays.declare("UInt8", "types", 1, std::span(types));
  });

  OutputFile file(path);
  file.write(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n"
      "  <UnstructuredGrid>\n"
      "    <Piece NumberOfPoints=\"" +
      std::to_string(nodes.rows()) + "\" NumberOfCells=\"" + std::to_string(num_cells) + "\">\n" + arrays.xml +
      "    </Piece>\n"
      "  </UnstructuredGrid>\n"
      "  <AppendedData encoding=\"raw\">\n_");
  for (const std::span<const std::byte> block : arrays.blocks) {
    const std::uint64_t size = block.size();
    file.write(std::as_bytes(std::span(&size, 1)));
    file.write(block);
  }
  file.write("\n  </AppendedData>\n</VTKFile>\n");
  file.commit();
}

}  // namespace

VtuField vector_field(std::string name, VectorIn u) {
  require(u.size() % 3 == 0,
          "field '" + name + "' has size " + std::to_string(u.size()) + ", expected a multiple of 3");
  return {std::move(name), u.reshaped<Eigen::RowMajor>(u.size() / 3, 3)};
}

void write_vtu(const std::filesystem::path& path, const Points& nodes, std::span<const Tet> tets,
               const VtuFields& fields) {
  write_cells(path, nodes, tets, fields);
}
void write_vtu(const std::filesystem::path& path, const Points& nodes, std::span<const std::array<Index, 8>> hexahedra,
               const VtuFields& fields) {
  write_cells(path, nodes, hexahedra, fields);
}
void write_vtu(const std::filesystem::path& path, const Points& nodes,
               std::span<const std::array<Index, 10>> quadratic_tets, const VtuFields& fields) {
  write_cells(path, nodes, quadratic_tets, fields);
}
void write_vtu(const std::filesystem::path& path, const Points& nodes, std::span<const Triangle> triangles,
               const VtuFields& fields) {
  write_cells(path, nodes, triangles, fields);
}

VtuSeries::VtuSeries(std::filesystem::path pvd) : pvd_(std::move(pvd)) {
  if (pvd_.extension() != ".pvd") throw InputError(pvd_.string() + ": expected a name that ends in .pvd");
  write_list();
}

void VtuSeries::add(double time, const Points& nodes, std::span<const Tet> tets, const VtuFields& fields) {
  add_frame(time, nodes, tets, fields);
}
void VtuSeries::add(double time, const Points& nodes, std::span<const std::array<Index, 8>> hexahedra,
                    const VtuFields& fields) {
  add_frame(time, nodes, hexahedra, fields);
}
void VtuSeries::add(double time, const Points& nodes, std::span<const std::array<Index, 10>> quadratic_tets,
                    const VtuFields& fields) {
  add_frame(time, nodes, quadratic_tets, fields);
}
void VtuSeries::add(double time, const Points& nodes, std::span<const Triangle> triangles, const VtuFields& fields) {
  add_frame(time, nodes, triangles, fields);
}

template <typename Cell>
void VtuSeries::add_frame(double time, const Points& nodes, std::span<const Cell> cells, const VtuFields& fields) {
  require(std::isfinite(time) && (frames_.empty() || time > frames_.back().first),
          "time of a frame is " + std::to_string(time) + " s, expected a finite time after the last frame's");
  const std::string number = std::to_string(frames_.size());
  const std::string name =
      pvd_.stem().string() + "_" + std::string(6 - std::min<std::size_t>(6, number.size()), '0') + number + ".vtu";
  write_vtu(pvd_.parent_path() / name, nodes, cells, fields);
  frames_.emplace_back(time, name);
  write_list();
}

void VtuSeries::write_list() const {
  std::string xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n  "
      "<Collection>\n";
  for (const auto& [time, name] : frames_) {
    xml += "    <DataSet timestep=\"" + exact(time) + "\" part=\"0\" file=\"" + escaped(name) + "\"/>\n";
  }
  write_file(pvd_, xml + "  </Collection>\n</VTKFile>\n");
}

}  // namespace supple
