#include <tests/io/file_bytes.hpp>
#include <tests/io/mesh_files.hpp>

#include <zlib.h>

#include <algorithm>
#include <fstream>

namespace supple::test {
namespace {

/// What the formats call a cell of so many nodes.
struct CellWords {
  int gmsh, vtk;
  const char *medit, *vega;
};
template <std::size_t size>
constexpr CellWords words = size == 4   ? CellWords{4, 10, "Tetrahedra", "TET"}
                            : size == 8 ? CellWords{5, 12, "Hexahedra", "CUBIC"}
                                        : CellWords{11, 24, "TetrahedraP2", ""};
template <typename Mesh>
constexpr CellWords words_of = words<Mesh::nodes_per_cell>;
template <typename Mesh>
constexpr Index cell_size = Mesh::nodes_per_cell;

/// " a b c d", counted from `first`.
template <std::size_t size>
std::string corners(const std::array<Index, size>& cell, Index first) {
  std::string line;
  for (const Index v : cell) line += " " + std::to_string(v + first);
  return line;
}

/// Gmsh lists the node amid edge 23 before that of edge 13.
template <std::size_t size>
std::array<Index, size> in_gmsh(std::array<Index, size> cell) {
  if constexpr (size == 10) std::swap(cell[8], cell[9]);
  return cell;
}
/// An order of mid-edge nodes that no format of known order has.
template <std::size_t size>
std::array<Index, size> in_some_order(std::array<Index, size> cell) {
  if constexpr (size == 10) {
    std::reverse(cell.begin() + 4, cell.end());
    std::swap(cell[5], cell[7]);
  }
  return cell;
}

int region(const auto& mesh, Index e) {
  return mesh.region.empty() ? 0 : mesh.region[e];
}

template <typename Mesh>
std::string physical_names(const Mesh& mesh) {
  std::string s = "$PhysicalNames\n" + std::to_string(mesh.region_names.size()) + "\n";
  for (const auto& [tag, name] : mesh.region_names) s += "3 " + std::to_string(tag) + " \"" + name + "\"\n";
  return s + "$EndPhysicalNames\n";
}

template <typename Mesh>
std::string gmsh_22(const Mesh& mesh) {
  std::string s = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + physical_names(mesh);
  s += "$Nodes\n" + std::to_string(mesh.num_nodes()) + "\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += std::to_string(v + 1) + " " + xyz(mesh, v) + "\n";
  s += "$EndNodes\n$Elements\n" + std::to_string(mesh.num_cells() + 1) + "\n1 15 2 7 7 1\n";
  for (Index e = 0; e < mesh.num_cells(); ++e)
    s += std::to_string(e + 2) + " " + std::to_string(words_of<Mesh>.gmsh) + " 2 " + std::to_string(region(mesh, e)) +
         " 1" + corners(in_gmsh(mesh.cells[e]), 1) + "\n";
  return s + "$EndElements\n";
}

template <typename Mesh>
std::string gmsh_22_binary(const Mesh& mesh, bool big) {
  std::string s = "$MeshFormat\n2.2 1 8\n" + raw(std::int32_t{1}, big) + "\n$EndMeshFormat\n" + physical_names(mesh);
  s += "$Nodes\n" + std::to_string(mesh.num_nodes()) + "\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    s += raw(static_cast<std::int32_t>(v + 1), big);
    for (int c = 0; c < 3; ++c) s += raw(mesh.nodes(v, c), big);
  }
  s += "\n$EndNodes\n$Elements\n" + std::to_string(mesh.num_cells()) + "\n";
  const auto integer = [&](Index value) { s += raw(static_cast<std::int32_t>(value), big); };
  integer(words_of<Mesh>.gmsh), integer(mesh.num_cells()), integer(2);
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    integer(e + 1), integer(region(mesh, e)), integer(1);
    for (const Index v : in_gmsh(mesh.cells[e])) integer(v + 1);
  }
  return s + "\n$EndElements\n$ElementData\nsome bytes: " + raw(std::int32_t{0x24456e64}) + "$EndElementData\n";
}

/// Gmsh 4.0 or 4.1 with a volume entity, 10 + tag, for each region.
template <typename Mesh>
std::string gmsh_4(const Mesh& mesh, bool binary, bool is_40) {
  std::string s = std::string("$MeshFormat\n") + (is_40 ? "4 " : "4.1 ") +
                  (binary ? "1 8\n" + raw(std::int32_t{1}) + "\n" : "0 8\n") + "$EndMeshFormat\n" +
                  physical_names(mesh);
  const auto integer = [&](Index value) {
    s += binary ? raw(static_cast<std::int32_t>(value)) : std::to_string(value) + " ";
  };
  const auto size = [&](Index value) {
    s += binary ? raw(static_cast<std::uint64_t>(value)) : std::to_string(value) + " ";
  };
  const auto real = [&](double value) { s += binary ? raw(value) : text(value) + " "; };
  std::vector<int> tags = mesh.region;
  std::sort(tags.begin(), tags.end());
  tags.erase(std::unique(tags.begin(), tags.end()), tags.end());
  if (tags.empty()) tags = {0};
  s += "$Entities\n";
  size(1), size(0), size(0), size(static_cast<Index>(tags.size()));
  integer(1), real(0), real(0), real(0);
  if (is_40) real(0), real(0), real(0);  // a box of points, too
  size(0);
  for (const int tag : tags) {
    integer(10 + tag);
    for (int c = 0; c < 6; ++c) real(c);
    size(tag != 0);
    if (tag != 0) integer(tag);
    size(1), integer(-1);
  }
  s += "\n$EndEntities\n$Nodes\n";
  const Index n = mesh.num_nodes(), first_block = n / 3;
  size(2), size(n);
  if (!is_40) size(1), size(n);
  for (int block = 0; block < 2; ++block) {  // the first one parametric: with coordinates on a surface
    const Index begin = block == 0 ? 0 : first_block, end = block == 0 ? first_block : n;
    const Index dim = block == 0 ? 2 : 3;
    integer(is_40 ? 1 : dim), integer(is_40 ? dim : 1), integer(block == 0), size(end - begin);
    for (Index v = begin; v < end && !is_40; ++v) size(v + 1);
    for (Index v = begin; v < end; ++v) {
      if (is_40) integer(v + 1);
      for (int c = 0; c < 3; ++c) real(mesh.nodes(v, c));
      if (block == 0) real(0.25), real(0.75);
    }
  }
  s += "\n$EndNodes\n$Elements\n";
  std::vector<std::vector<Index>> blocks;  // runs of one region, to keep the order of tets
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    if (blocks.empty() || region(mesh, blocks.back()[0]) != region(mesh, e)) blocks.emplace_back();
    blocks.back().push_back(e);
  }
  size(static_cast<Index>(blocks.size())), size(mesh.num_cells());
  if (!is_40) size(1), size(mesh.num_cells());
  for (const std::vector<Index>& block : blocks) {
    const Index entity = 10 + region(mesh, block[0]);
    integer(is_40 ? entity : 3), integer(is_40 ? 3 : entity), integer(words_of<Mesh>.gmsh),
        size(static_cast<Index>(block.size()));
    const auto tag = [&](Index value) { is_40 ? integer(value) : size(value); };
    for (const Index e : block) {
      tag(e + 1);
      for (const Index v : in_gmsh(mesh.cells[e])) tag(v + 1);
    }
  }
  return s + "\n$EndElements\n";
}
template <typename Mesh>
std::string gmsh_40(const Mesh& mesh, bool binary) {
  return gmsh_4(mesh, binary, true);
}
template <typename Mesh>
std::string gmsh_41(const Mesh& mesh, bool binary) {
  return gmsh_4(mesh, binary, false);
}

template <typename Mesh>
std::string medit(const Mesh& mesh) {
  std::string s =
      "MeshVersionFormatted 2\n# a comment\nDimension 3\nVertices\n" + std::to_string(mesh.num_nodes()) + "\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += xyz(mesh, v) + " 0\n";
  s += "RequiredVertices\n2\n1\n2\nTriangles\n1\n1 2 3 9\n" + std::string(words_of<Mesh>.medit) + "\n" +
       std::to_string(mesh.num_cells()) + "\n";
  for (Index e = 0; e < mesh.num_cells(); ++e)
    s += corners(in_some_order(mesh.cells[e]), 1).substr(1) + " " + std::to_string(region(mesh, e)) + "\n";
  return s + "End\n";
}

template <typename Mesh>
std::string tetgen_node(const Mesh& mesh, Index first) {
  std::string s = "# nodes\n" + std::to_string(mesh.num_nodes()) + " 3 1 1\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += std::to_string(v + first) + " " + xyz(mesh, v) + " 0.5 1 # more\n";
  return s;
}

template <typename Mesh>
std::string tetgen_ele(const Mesh& mesh, Index first) {
  std::string s = std::to_string(mesh.num_cells()) + " " + std::to_string(cell_size<Mesh>) + " 1\n\n";
  for (Index e = 0; e < mesh.num_cells(); ++e)
    s += std::to_string(e + first) + corners(in_some_order(mesh.cells[e]), first) + " " +
         std::to_string(region(mesh, e)) + "\n";
  return s;
}

template <typename Mesh>
std::string vega(const Mesh& mesh) {
  std::string s = "# Vega\n*VERTICES\n" + std::to_string(mesh.num_nodes()) + " 3 0 0\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += std::to_string(v + 1) + " " + xyz(mesh, v) + "\n";
  s += "*ELEMENTS\n" + std::string(words_of<Mesh>.vega) + "\n" + std::to_string(mesh.num_cells()) + " " +
       std::to_string(cell_size<Mesh>) + " 0\n";
  for (Index e = 0; e < mesh.num_cells(); ++e) s += std::to_string(e + 1) + corners(mesh.cells[e], 1) + "\n";
  s += "*MATERIAL rubber\nENU, 1000, 1e6, 0.45\n";
  for (const auto& [tag, name] : mesh.region_names) {
    s += "*SET " + name + "\n";
    for (Index e = 0, in_line = 0; e < mesh.num_cells(); ++e)
      if (region(mesh, e) == tag) s += std::to_string(e + 1) + (++in_line % 8 == 0 ? ",\n" : ", ");
    s += "\n*REGION\n" + name + ", rubber\n";
  }
  return s;
}

template <typename Mesh>
std::string abaqus(const Mesh& mesh) {
  constexpr int size = cell_size<Mesh>;
  const auto list = [](const auto& cell) {
    std::string line;
    for (std::size_t k = 0; k < cell.size(); ++k)  // in two lines where there are many
      line += (k == 7 ? ",\n " : ", ") + std::to_string(cell[k] + 10);
    return line + "\n";
  };
  std::string s = "*Heading\n** a comment, with commas\n*Part, name=\"Part 1\"\n*Node, nset=All\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    std::string place = xyz(mesh, v);
    std::ranges::replace(place, ' ', ',');
    s += std::to_string(v + 10) + ", " + place + "\n";
  }
  s += std::string("*Element, type=") + (size == 4 ? "C3D4" : size == 8 ? "C3D8R" : "C3D10") + "\n";
  for (Index e = 0; e < mesh.num_cells(); ++e) s += std::to_string(e + 1) + list(mesh.cells[e]);
  for (const auto& [tag, name] : mesh.region_names) {
    s += "*Elset, elset=" + name + "\n";
    for (Index e = 0, in_line = 0; e < mesh.num_cells(); ++e)
      if (region(mesh, e) == tag) s += std::to_string(e + 1) + (++in_line % 8 == 0 ? ",\n" : ", ");
    s += "\n*Solid Section, elset=" + name + ", material=Rubber\n,\n";
  }
  return s + "*End Part\n*MATERIAL, NAME=rubber\n*DENSITY\n1000.,\n*ELASTIC\n1e6, 0.45\n";
}

template <typename Mesh>
std::string legacy_vtk(const Mesh& mesh, bool binary, bool version_5) {
  std::string s = std::string("# vtk DataFile Version ") + (version_5 ? "5.1" : "3.0") + "\ntitle\n" +
                  (binary ? "BINARY" : "ASCII") + "\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
                  std::to_string(mesh.num_nodes()) + " double\n";
  const auto put = [&]<typename Number>(Number value) {
    if (binary)
      s += raw(value, true);
    else if constexpr (std::is_integral_v<Number>)
      s += std::to_string(value) + " ";
    else
      s += text(value) + " ";
  };
  for (Index k = 0; k < mesh.nodes.size(); ++k) put(mesh.nodes.data()[k]);
  const std::string m = std::to_string(mesh.num_cells());
  if (version_5) {
    s += "\nMETADATA\nINFORMATION 0\n\nCELLS " + std::to_string(mesh.num_cells() + 1) + " " +
         std::to_string(cell_size<Mesh> * mesh.num_cells()) + "\nOFFSETS vtktypeint64\n";
    for (std::int64_t e = 0; e <= mesh.num_cells(); ++e) put(cell_size<Mesh> * e);
    s += "\nCONNECTIVITY vtktypeint64\n";
    for (const auto& cell : mesh.cells)
      for (const Index v : cell) put(static_cast<std::int64_t>(v));
  } else {
    s += "\nCELLS " + m + " " + std::to_string((cell_size<Mesh> + 1) * mesh.num_cells()) + "\n";
    for (const auto& cell : mesh.cells) {
      put(static_cast<std::int32_t>(cell_size<Mesh>));
      for (const Index v : cell) put(static_cast<std::int32_t>(v));
    }
  }
  s += "\nCELL_TYPES " + m + "\n";
  for (Index e = 0; e < mesh.num_cells(); ++e) put(std::int32_t{words_of<Mesh>.vtk});
  s += "\nCELL_DATA " + m + "\n";
  s += version_5 ? "FIELD FieldData 2\nother 2 " + m + " float\n" : "SCALARS other float\nLOOKUP_TABLE default\n";
  for (Index e = 0; e < (version_5 ? 2 : 1) * mesh.num_cells(); ++e) put(0.5f);
  s += version_5 ? "\nregion 1 " + m + " int\n" : "\nSCALARS region int 1\nLOOKUP_TABLE default\n";
  for (Index e = 0; e < mesh.num_cells(); ++e) put(static_cast<std::int32_t>(region(mesh, e)));
  return s + "\n";
}

std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string s;
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j)
      group = group << 8 | (k + j < bytes.size() ? static_cast<unsigned char>(bytes[k + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) s += k + j > bytes.size() ? '=' : digits[group >> (18 - 6 * j) & 63];
  }
  return s;
}

struct VtuStyle {
  bool appended, base64, zlib, wide_header, big_endian;
};

template <typename Mesh>
class VtuWriter {
 public:
  VtuWriter(const Mesh& mesh, const VtuStyle& style) : mesh_(mesh), style_(style) {}

  std::string write() {
    std::string s =
        std::string("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"") +
        (style_.big_endian ? "BigEndian" : "LittleEndian") + "\" header_type=\"" +
        (style_.wide_header ? "UInt64" : "UInt32") + "\"" +
        (style_.zlib ? " compressor=\"vtkZLibDataCompressor\"" : "") +
        ">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"" + std::to_string(mesh_.num_nodes()) + "\" NumberOfCells=\"" +
        std::to_string(mesh_.num_cells()) + "\">\n";
    std::string points, connectivity, offsets, types, regions;
    for (Index k = 0; k < mesh_.nodes.size(); ++k) points += raw(mesh_.nodes.data()[k], style_.big_endian);
    for (Index e = 0; e < mesh_.num_cells(); ++e) {
      for (const Index v : mesh_.cells[e]) connectivity += raw(static_cast<std::int32_t>(v), style_.big_endian);
      offsets += raw(std::int64_t{cell_size<Mesh> * (e + 1)}, style_.big_endian);
      types += raw(static_cast<std::uint8_t>(words_of<Mesh>.vtk));
      regions += raw(static_cast<std::int16_t>(region(mesh_, e)), style_.big_endian);
    }
    s += "<CellData>\n" + array("Int16", "gmsh:physical", regions) + "</CellData>\n";
    s += "<Points>\n" + array("Float64", "Points\" NumberOfComponents=\"3", points) + "</Points>\n<Cells>\n";
    s += array("Int32", "connectivity", connectivity) + array("Int64", "offsets", offsets) +
         array("UInt8", "types", types);
    s += "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
    if (style_.appended)
      s += std::string("<AppendedData encoding=\"") + (style_.base64 ? "base64" : "raw") + "\">\n_" + appended_ +
           "\n</AppendedData>\n";
    return s + "</VTKFile>\n";
  }

 private:
  std::string word(std::uint64_t value) const {
    return style_.wide_header ? raw(value, style_.big_endian)
                              : raw(static_cast<std::uint32_t>(value), style_.big_endian);
  }

  std::string encoded(const std::string& bytes) const { return style_.base64 ? base64(bytes) : bytes; }

  std::string stored(const std::string& bytes) const {
    if (!style_.zlib) return encoded(word(bytes.size()) + bytes);
    constexpr std::size_t block = 200;
    std::string header, blocks;
    for (std::size_t at = 0; at < bytes.size(); at += block) {
      const std::string part = bytes.substr(at, block);
      uLongf size = compressBound(part.size());
      std::string packed(size, '\0');
      compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(part.data()),
               part.size());
      header += word(size);
      blocks += packed.substr(0, size);
    }
    return encoded(word((bytes.size() + block - 1) / block) + word(block) + word(bytes.size() % block) + header) +
           encoded(blocks);
  }

  std::string array(const std::string& type, const std::string& name, const std::string& bytes) {
    const std::string head = "<DataArray type=\"" + type + "\" Name=\"" + name + "\" format=\"";
    if (!style_.appended) return head + "binary\">\n  " + stored(bytes) + "\n</DataArray>\n";
    const std::size_t offset = appended_.size();
    appended_ += stored(bytes);
    return head + "appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
  }

  const Mesh& mesh_;
  VtuStyle style_;
  std::string appended_;
};

template <typename Mesh>
std::string vtu_ascii(const Mesh& mesh) {
  std::string points, connectivity, offsets, types, regions;
  for (Index v = 0; v < mesh.num_nodes(); ++v) points += xyz(mesh, v) + "\n";
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    connectivity += corners(mesh.cells[e], 0) + "\n";
    offsets += std::to_string(cell_size<Mesh> * (e + 1)) + " ";
    types += std::to_string(words_of<Mesh>.vtk) + " ";
    regions += std::to_string(region(mesh, e)) + " ";
  }
  const auto array = [](const std::string& name, const std::string& values) {
    return "<DataArray type=\"Float64\" Name=\"" + name + "\" format=\"ascii\">" + values + "</DataArray>\n";
  };
  return "<VTKFile type=\"UnstructuredGrid\">\n<!-- a comment -->\n<UnstructuredGrid><Piece "
         "NumberOfPoints=\"" +
         std::to_string(mesh.num_nodes()) + "\" NumberOfCells=\"" + std::to_string(mesh.num_cells()) + "\">\n<Points>" +
         array("Points\" NumberOfComponents=\"3", points) + "</Points><Cells>" + array("connectivity", connectivity) +
         array("offsets", offsets) + array("types", types) + "</Cells><CellData>" + array("Region", regions) +
         "</CellData></Piece></UnstructuredGrid></VTKFile>\n";
}

template <typename Mesh>
std::vector<MeshFile> every_format(const Mesh& mesh) {
  std::vector<MeshFile> files{{"gmsh_22_ascii", ".msh", gmsh_22(mesh), ""},
                              {"gmsh_22_binary", ".msh", gmsh_22_binary(mesh, false), ""},
                              {"gmsh_22_big_endian", ".msh", gmsh_22_binary(mesh, true), ""},
                              {"abaqus", ".inp", abaqus(mesh), ""},
                              {"gmsh_40_ascii", ".msh", gmsh_40(mesh, false), ""},
                              {"gmsh_40_binary", ".msh", gmsh_40(mesh, true), ""},
                              {"gmsh_41_ascii", ".msh", gmsh_41(mesh, false), ""},
                              {"gmsh_41_binary", ".msh", gmsh_41(mesh, true), ""},
                              {"medit_ascii", ".mesh", medit(mesh), ""},
                              {"vtk_3_ascii", ".vtk", legacy_vtk(mesh, false, false), ""},
                              {"vtk_3_binary", ".vtk", legacy_vtk(mesh, true, false), ""},
                              {"vtk_5_ascii", ".vtk", legacy_vtk(mesh, false, true), ""},
                              {"vtk_5_binary", ".vtk", legacy_vtk(mesh, true, true), ""},
                              {"vtu_ascii", ".vtu", vtu_ascii(mesh), ""}};
  if constexpr (cell_size<Mesh> != 8)
    for (const Index first : {0, 1})
      files.push_back(
          {"tetgen_from_" + std::to_string(first), ".node", tetgen_node(mesh, first), tetgen_ele(mesh, first)});
  if constexpr (cell_size<Mesh> != 10) files.push_back({"vega", ".veg", vega(mesh), ""});
  const auto add = [&](const std::string& name, const VtuStyle& style) {
    files.push_back({name, ".vtu", VtuWriter(mesh, style).write(), ""});
  };
  using S = VtuStyle;
  add("vtu_base64", S{.appended = false, .base64 = true, .zlib = false, .wide_header = true, .big_endian = false});
  add("vtu_base64_big", S{.appended = false, .base64 = true, .zlib = false, .wide_header = false, .big_endian = true});
  add("vtu_base64_zlib", S{.appended = false, .base64 = true, .zlib = true, .wide_header = false, .big_endian = false});
  add("vtu_appended", S{.appended = true, .base64 = false, .zlib = false, .wide_header = true, .big_endian = false});
  add("vtu_appended_zlib",
      S{.appended = true, .base64 = false, .zlib = true, .wide_header = true, .big_endian = false});
  add("vtu_appended_base64",
      S{.appended = true, .base64 = true, .zlib = false, .wide_header = false, .big_endian = false});
  add("vtu_appended_base64_zlib",
      S{.appended = true, .base64 = true, .zlib = true, .wide_header = true, .big_endian = true});
  return files;
}

}  // namespace

std::vector<MeshFile> in_every_format(const TetMesh& mesh) {
  return every_format(mesh);
}
std::vector<MeshFile> in_every_format(const HexMesh& mesh) {
  return every_format(mesh);
}
std::vector<MeshFile> in_every_format(const QuadraticTetMesh& mesh) {
  return every_format(mesh);
}

std::filesystem::path write(const std::string& bytes, const std::filesystem::path& path) {
  std::filesystem::remove(path);  // some file systems flush a file that is cut to zero and written again
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

std::filesystem::path write(const MeshFile& file, const std::filesystem::path& folder) {
  if (file.extension == ".node") write(file.ele_bytes, folder / (file.format + ".ele"));
  return write(file.bytes, folder / (file.format + file.extension));
}

}  // namespace supple::test
