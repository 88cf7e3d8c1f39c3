#include <io/mesh/mesh_formats.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/mesh_repairs.hpp>
#include <physics/mesh/tet_mesh.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <numeric>

namespace supple {
namespace {

constexpr std::string_view formats_read =
    "Gmsh .msh (2.2, 4.0, 4.1), Abaqus .inp, Medit .mesh, TetGen .node with .ele, VegaFEM .veg, VTK .vtk and .vtu";

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
  else if (bytes.starts_with(std::string_view("\1\0\0\0", 4)) || bytes.starts_with(std::string_view("\0\0\0\1", 4)))
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
  const std::string nodes = read_text(file(".node")), tets = read_text(file(".ele"));
  Cursor node_cursor(file(".node").string(), nodes, {.separator = '\0', .comment = '#'});
  Cursor ele_cursor(file(".ele").string(), tets, {.separator = '\0', .comment = '#'});
  FileMesh mesh;
  read_tetgen(node_cursor, ele_cursor, mesh);
  return mesh;
}

/// Files of VegaFEM begin with stars, too, but with other keywords.
bool is_abaqus(const std::filesystem::path& path, std::string_view bytes) {
  if (has_extension(path, ".inp")) return true;
  std::string word(first_word(bytes));
  word = word.substr(0, word.find(','));
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word.starts_with("**") || word == "*HEADING" || word == "*NODE" || word == "*PART" || word == "*ELEMENT" ||
         word == "*PREPRINT";
}

FileMesh read_any(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::exists(path, none) &&
      std::filesystem::exists(std::filesystem::path(path).concat(".node"), none))
    return read_tetgen_pair(path);
  const std::string bytes = read_text(path);
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
  } else if (is_abaqus(path, bytes)) {
    const std::string all = with_includes(path, bytes);
    Cursor in(all.size() == bytes.size() ? name : name + " with what it includes", all);
    read_abaqus(in, mesh);
  } else if (word.starts_with('*')) {
    const std::string all = with_includes(path, bytes);
    Cursor in(all.size() == bytes.size() ? name : name + " with what it includes", all,
              {.separator = ',', .comment = '#'});
    read_vega(in, mesh);
  } else if (has_extension(path, ".node") || has_extension(path, ".ele")) {
    return read_tetgen_pair(path);
  } else {
    refuse_unknown(name, bytes);
  }
  return mesh;
}

enum class Kinds { Tets, All };

void refuse_other_solids(const FileMesh& file, Kinds wanted, const std::string& name) {
  const auto num_tets = static_cast<Index>(file.tets.size()), num_hexahedra = static_cast<Index>(file.hexahedra.size());
  std::string kinds;
  const auto add = [&](const std::string& kind) { kinds += (kinds.empty() ? "" : ", ") + kind; };
  for (const auto& [kind, count] : file.other_solid) add(std::to_string(count) + " " + kind);
  const bool mixed = num_tets > 0 && num_hexahedra > 0;
  if (!kinds.empty() || mixed || (num_hexahedra > 0 && wanted == Kinds::Tets)) {
    if (num_hexahedra > 0) add(plural(num_hexahedra, "hexahedron", "hexahedra"));
    if (num_tets > 0) kinds += " and " + plural(num_tets, "tet", "tets");
    throw InputError(name + ": holds " + kinds +
                     (wanted == Kinds::Tets ? "; only tetrahedra can be used: split the others first"
                                            : "; expected tetrahedra alone or hexahedra of eight nodes alone"));
  }
  if (num_tets + num_hexahedra == 0)
    throw InputError(name + ": holds no tetrahedra" + (wanted == Kinds::All ? " or hexahedra" : "") +
                     (file.num_lower > 0 ? " but " + plural(file.num_lower, "cell", "cells") +
                                               " of lower dimension; a surface must be filled with tetrahedra first"
                                         : std::string()));
}

template <std::size_t size>
constexpr const char* cell_word = size == 8 ? "hexahedron" : "tet";
template <std::size_t size>
constexpr const char* cell_words = size == 8 ? "hexahedra" : "tets";

double least_shape(const TetMesh& mesh, Index e) {
  return radius_ratio(mesh, e);
}
double least_shape(const QuadraticTetMesh& mesh, Index e) {
  return radius_ratio(mesh, e);
}
double least_shape(const HexMesh& mesh, Index e) {
  return scaled_jacobian(mesh, e);
}

template <typename Mesh>
void warn_of_surprises(const Mesh& mesh, const MeshNumbers& numbers, std::vector<std::string>& warnings) {
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
  for (Index e = 0; e < mesh.num_cells(); ++e)
    if (const double shape = least_shape(mesh, e); shape < worst) worst = shape, at = e;
  if (worst < 1e-3) {
    constexpr bool is_hex = std::same_as<Mesh, HexMesh>;
    std::array<char, 32> shown;
    std::snprintf(shown.data(), shown.size(), "%.2g", worst);
    warnings.push_back(
        std::string(is_hex ? "nearly flat hexahedra: the worst, hex " : "nearly flat tets: the worst, tet ") +
        std::to_string(numbers.cell[at]) + (is_hex ? ", has scaled Jacobian " : ", has radius ratio ") + shown.data());
  }
}

bool is_reversed(const TetMesh& mesh, Index e) {
  return tet_orientation(mesh, e) < 0;
}
template <typename Mesh>
bool is_reversed(const Mesh& mesh, Index e) {
  return cell_volume(mesh, e) < 0;
}

/// What of a group of the file is left where nodes of no cell are dropped.
NodeGroup in_use(const NodeGroup& group, const NodePlaces& places) {
  const auto sort_once = [](auto& list) {
    std::ranges::sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  };
  NodeGroup result;
  for (const Index place : group.nodes)
    if (const Index v = places.node(place); v >= 0) result.nodes.push_back(v);
  for (FaceCorners face : group.faces) {
    for (Index& v : face)
      if (v >= 0) v = places.node(v);
    const std::span corners(face.begin(), face[3] < 0 && face[2] >= 0 ? 3u : 4u);
    if (std::ranges::all_of(corners, [](Index v) { return v >= 0; })) result.faces.push_back(face_corners(corners));
  }
  sort_once(result.nodes);
  sort_once(result.faces);
  return result;
}

/// What all kinds of cells have in common: the nodes in use, regions, orientation, checks, warnings.
template <typename Mesh, std::size_t size>
Mesh finish(FileMesh& file, std::vector<std::array<Index, size>> cells, const std::string& name, MeshNotes* notes) {
  Mesh mesh;
  make_regions_of_attributes(file);
  if (file.numbers.node.empty()) {
    file.numbers.node.resize(file.nodes.size());
    std::iota(file.numbers.node.begin(), file.numbers.node.end(), std::int64_t{0});
  }
  mesh.nodes = keep_nodes_in_use(file.nodes, cells, file.numbers.node, mesh.places);
  if (const Index dropped = static_cast<Index>(file.nodes.size()) - mesh.num_nodes(); dropped > 0)
    file.warnings.push_back(plural(dropped, "node belongs", "nodes belong") + " to no " + cell_word<size> +
                            ": dropped");
  for (const auto& [group_name, group] : file.node_groups)
    if (NodeGroup own = in_use(group, mesh.places); !own.nodes.empty()) mesh.node_groups[group_name] = std::move(own);
  std::vector<std::array<Index, size>>& own = mesh.cells;
  own = std::move(cells);
  if (std::any_of(file.region.begin(), file.region.end(), [](int tag) { return tag != 0; })) {
    mesh.region = std::move(file.region);
    mesh.region_names = std::move(file.region_names);
    mesh.region_groups = std::move(file.region_groups);
  }
  Index num_reversed = 0;
  for (Index e = 0; e < mesh.num_cells(); ++e)
    if (is_reversed(mesh, e)) {
      own[e] = reversed(own[e]);
      ++num_reversed;
    }
  if (num_reversed > 0)
    file.warnings.push_back(
        plural(num_reversed, std::string(cell_word<size>) + " is", std::string(cell_words<size>) + " are") +
        " reversed: nodes reordered in each");
  try {
    check_mesh(mesh, file.numbers);
  } catch (const std::invalid_argument& error) {
    throw InputError(name + ": " + error.what() + " (numbers as in the file)");
  }
  if (notes) {
    warn_of_surprises(mesh, file.numbers, file.warnings);
    *notes = {std::move(file.format), std::move(file.warnings), std::move(file.numbers), std::move(file.materials)};
    for (const auto& [place, axes] : file.held)
      if (const Index v = mesh.places.node(place); v >= 0) notes->held.push_back({v, axes});
  }
  return mesh;
}

TetMesh finish_tets(FileMesh& file, const std::string& name, MeshNotes* notes) {
  if (const Index count = file.num_higher + static_cast<Index>(file.mid_edges.size()); count > 0)
    file.warnings.push_back(plural(count, "tet is", "tets are") + " of higher order: only the corners are used");
  return finish<TetMesh>(file, std::move(file.tets), name, notes);
}

}  // namespace

SolidMesh read_solid_mesh(const std::filesystem::path& path, MeshNotes* notes) {
  FileMesh file = read_any(path);
  const std::string name = path.string();
  refuse_other_solids(file, Kinds::All, name);
  if (!file.hexahedra.empty()) return finish<HexMesh>(file, std::move(file.hexahedra), name, notes);
  if (file.mid_edges.size() != file.tets.size()) return finish_tets(file, name, notes);
  std::vector<std::array<Index, 10>> cells(file.tets.size());
  for (std::size_t e = 0; e < cells.size(); ++e) {
    std::ranges::copy(file.tets[e], cells[e].begin());
    std::ranges::copy(file.mid_edges[e], cells[e].begin() + 4);
  }
  return finish<QuadraticTetMesh>(file, std::move(cells), name, notes);
}

TetMesh read_tet_mesh(const std::filesystem::path& path, MeshNotes* notes) {
  FileMesh file = read_any(path);
  refuse_other_solids(file, Kinds::Tets, path.string());
  return finish_tets(file, path.string(), notes);
}

}  // namespace supple
