#include <io/mesh_formats.hpp>
#include <io/mesh_reader.hpp>
#include <io/mesh_repairs.hpp>

#include <array>
#include <cstdio>
#include <numeric>

namespace supple {
namespace {

constexpr std::string_view formats_read =
    "Gmsh .msh (2.2, 4.1), Medit .mesh, TetGen .node with .ele, VegaFEM .veg, VTK .vtk and .vtu";

[[noreturn]] void refuse_unknown(const std::string& name, std::string_view bytes) {
  const std::string_view word = first_word(bytes);
  const auto is_word = [&](std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  std::string found;
  if (bytes.empty())
    found = "the file is empty";
  else if (bytes.starts_with("\x1f\x8b"))
    found = "the file is compressed (gzip); unpack it first";
  else if (is_word({"OFF", "COFF", "NOFF", "ply", "solid", "v", "vn", "mtllib"}))
    found = "the file looks like a triangle surface (" + std::string(word) + "), which has no tetrahedra";
  else if (bytes.starts_with(std::string_view("\1\0\0\0", 4)) ||
           bytes.starts_with(std::string_view("\0\0\0\1", 4)))
    found = "the file looks like binary Medit (.meshb); save it as ASCII .mesh";
  else if (word == "$NOD")
    found = "the file is of Gmsh format 1; save it as 2.2 or 4.1";
  else
    found = "the format of the file is not known";
  throw InputError(name + ": " + found + "; expected a tetrahedral mesh: " + std::string(formats_read));
}

FileMesh read_tetgen_pair(std::filesystem::path path) {
  if (has_extension(path, ".node") || has_extension(path, ".ele")) path.replace_extension();
  const auto file = [&](const char* extension) { return std::filesystem::path(path).concat(extension); };
  const std::string nodes = read_bytes(file(".node")), tets = read_bytes(file(".ele"));
  Cursor node_cursor(file(".node").string(), nodes, {.separator = '\0', .comment = '#'});
  Cursor ele_cursor(file(".ele").string(), tets, {.separator = '\0', .comment = '#'});
  FileMesh mesh;
  read_tetgen(node_cursor, ele_cursor, mesh);
  return mesh;
}

FileMesh read_any(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::exists(path, none) &&
      std::filesystem::exists(std::filesystem::path(path).concat(".node"), none))
    return read_tetgen_pair(path);
  const std::string bytes = read_bytes(path);
  const std::string name = path.string();
  const std::string_view word = first_word(bytes), start = Cursor(name, bytes).peek();
  const Cursor::Syntax comments{.separator = '\0', .comment = '#'};
  FileMesh mesh;
  if (start == "$MeshFormat" || start == "$Comments") {
    Cursor in(name, bytes);
    read_gmsh(in, mesh);
  } else if (bytes.starts_with("# vtk DataFile")) {
    Cursor in(name, bytes);
    read_legacy_vtk(in, mesh);
  } else if (start.starts_with("<?xml") || start.starts_with("<VTKFile")) {
    read_vtu(Cursor(name, bytes), mesh);
  } else if (word == "MeshVersionFormatted") {
    Cursor in(name, bytes, comments);
    read_medit(in, mesh);
  } else if (word.starts_with('*')) {
    Cursor in(name, bytes, {.separator = ',', .comment = '#'});
    read_vega(in, mesh);
  } else if (has_extension(path, ".node") || has_extension(path, ".ele")) {
    return read_tetgen_pair(path);
  } else {
    refuse_unknown(name, bytes);
  }
  return mesh;
}

void refuse_other_solids(const FileMesh& file, const std::string& name) {
  std::string kinds;
  for (const auto& [kind, count] : file.other_solid)
    kinds += (kinds.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  const auto num_tets = static_cast<Index>(file.tets.size());
  if (!kinds.empty())
    throw InputError(name + ": holds " + kinds +
                     (num_tets > 0 ? " and " + plural(num_tets, "tet", "tets") : "") +
                     "; only tetrahedra can be used: split the others first");
  if (num_tets == 0)
    throw InputError(name + ": holds no tetrahedra" +
                     (file.num_lower > 0
                          ? " but " + plural(file.num_lower, "cell", "cells") +
                                " of lower dimension; a surface must be filled with tetrahedra first"
                          : std::string()));
}

void take_nodes(FileMesh& file, TetMesh& mesh) {
  if (file.numbers.node.empty()) {
    file.numbers.node.resize(file.nodes.size());
    std::iota(file.numbers.node.begin(), file.numbers.node.end(), std::int64_t{0});
  }
  mesh.nodes = keep_nodes_in_use(file.nodes, file.tets, file.numbers.node);
  mesh.tets = std::move(file.tets);
  if (const Index dropped = static_cast<Index>(file.nodes.size()) - mesh.num_nodes(); dropped > 0)
    file.warnings.push_back(plural(dropped, "node belongs", "nodes belong") + " to no tet: dropped");
}

void reorder_reversed(TetMesh& mesh, std::vector<std::string>& warnings) {
  Index reversed = 0;
  for (Index e = 0; e < mesh.num_tets(); ++e)
    if (tet_orientation(mesh, e) < 0) {
      std::swap(mesh.tets[e][2], mesh.tets[e][3]);
      ++reversed;
    }
  if (reversed > 0)
    warnings.push_back(plural(reversed, "tet is", "tets are") + " reversed: two nodes swapped in each");
}

void warn_of_surprises(const TetMesh& mesh, const MeshNumbers& numbers, std::vector<std::string>& warnings) {
  if (const Index count = num_coincident_nodes(mesh.nodes); count > 0)
    warnings.push_back(plural(count, "node lies", "nodes lie") + " where another node is: not merged");
  if (const Index count = connected_components(mesh).count; count > 1)
    warnings.push_back(std::to_string(count) + " components that are not connected");
  const Hinges hinges = boundary_hinges(mesh);
  if (hinges.edges + hinges.nodes > 0)
    warnings.push_back("parts hang together by " + plural(hinges.edges, "edge", "edges") + " and " +
                       plural(hinges.nodes, "node", "nodes") + " only, about which they turn freely");
  double worst = 1;
  Index at = 0;
  for (Index e = 0; e < mesh.num_tets(); ++e)
    if (const double ratio = radius_ratio(mesh, e); ratio < worst) worst = ratio, at = e;
  if (worst < 1e-3) {
    std::array<char, 32> shown;
    std::snprintf(shown.data(), shown.size(), "%.2g", worst);
    warnings.push_back("nearly flat tets: the worst, tet " + std::to_string(numbers.tet[at]) +
                       ", has radius ratio " + shown.data());
  }
}

}  // namespace

TetMesh read_tet_mesh(const std::filesystem::path& path, MeshNotes* notes) {
  FileMesh file = read_any(path);
  const std::string name = path.string();
  refuse_other_solids(file, name);
  if (file.num_corner_only > 0)
    file.warnings.push_back(plural(file.num_corner_only, "tet is", "tets are") +
                            " of higher order: only the corners are used");
  TetMesh mesh;
  take_nodes(file, mesh);
  if (std::any_of(file.region.begin(), file.region.end(), [](int tag) { return tag != 0; })) {
    mesh.region = std::move(file.region);
    mesh.region_names = std::move(file.region_names);
  }
  reorder_reversed(mesh, file.warnings);
  try {
    check_mesh(mesh, file.numbers);
  } catch (const std::invalid_argument& error) {
    throw InputError(name + ": " + error.what() + " (numbers as in the file)");
  }
  if (notes) {
    warn_of_surprises(mesh, file.numbers, file.warnings);
    *notes = {std::move(file.format), std::move(file.warnings), std::move(file.numbers)};
  }
  return mesh;
}

}  // namespace supple
