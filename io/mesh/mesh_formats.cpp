#include <core/text.hpp>
#include <io/mesh/mesh_formats.hpp>
#include <physics/mesh/elements.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace supple {
namespace {

struct VtkType {
  enum { Tet, Hexahedron, Voxel, Other } kind = Other;
  const char* plural = "";  // of other solids; empty: of lower dimension
};

/// Cell types by number. \see VTK file formats, "Cell types"; vtkCellType.h.
VtkType vtk_type(std::int64_t type, const Cursor& in) {
  const auto is = [&](std::initializer_list<std::int64_t> types) {
    return std::find(types.begin(), types.end(), type) != types.end();
  };
  if (is({10, 24, 64, 71, 78})) return {VtkType::Tet};
  if (type == 12) return {VtkType::Hexahedron};
  if (type == 11) return {VtkType::Voxel};
  if (is({25, 29, 33, 67, 72, 79})) return {VtkType::Other, "hexahedra of higher order"};
  if (is({13, 26, 31, 32, 65, 73, 80})) return {VtkType::Other, "prisms"};
  if (is({14, 27, 37, 66, 74, 81})) return {VtkType::Other, "pyramids"};
  if (is({15, 16, 41, 42})) return {VtkType::Other, "polyhedra"};
  if ((type >= 0 && type <= 9) || is({21, 22, 23, 28, 30, 34, 35, 36, 60, 61, 62, 63, 68, 69, 70, 75, 76, 77}))
    return {};
  in.fail_whole("cell type " + std::to_string(type) + " is not known");
}

}  // namespace

void FileMesh::add_tet(std::span<const Index> cell) {
  Tet& tet = tets.emplace_back();
  std::copy_n(cell.begin(), 4, tet.begin());
  if (cell.size() == 10) std::copy_n(cell.begin() + 4, 6, mid_edges.emplace_back().begin());
}

void FileMesh::add_hexahedron(std::span<const Index> cell) {
  std::copy_n(cell.begin(), 8, hexahedra.emplace_back().begin());
}

void order_mid_edges(FileMesh& mesh, const Cursor& in) {
  if (mesh.mid_edges.empty() || mesh.mid_edges.size() != mesh.tets.size()) return;  // corners alone count
  Eigen::Matrix<double, 6, 6> distance = Eigen::Matrix<double, 6, 6>::Zero();  // of node j from the middle of edge k
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    const auto corner = [&](int a) { return mesh.nodes[mesh.tets[e][a]]; };
    const double size = (corner(1) - corner(0)).squaredNorm() + (corner(3) - corner(2)).squaredNorm();
    for (int k = 0; k < 6; ++k) {
      const Point middle = (corner(QuadraticTet::edges[k][0]) + corner(QuadraticTet::edges[k][1])) / 2;
      for (int j = 0; j < 6; ++j) {
        const double share = (mesh.nodes[mesh.mid_edges[e][j]] - middle).squaredNorm() / size;
        if (std::isfinite(share)) distance(j, k) += share;
      }
    }
  }
  std::array<int, 6> node_of_edge;
  std::array<bool, 6> taken{};
  for (int k = 0; k < 6; ++k) {
    distance.col(k).minCoeff(&node_of_edge[k]);
    if (std::exchange(taken[node_of_edge[k]], true))
      in.fail_whole("the nodes amid the edges of the tets lie nowhere near them, so their order cannot be told");
  }
  for (auto& nodes : mesh.mid_edges) {
    const auto given = nodes;
    for (int k = 0; k < 6; ++k) nodes[k] = given[node_of_edge[k]];
  }
}

Index node_at(const Cursor& in, std::int64_t number, std::int64_t first, Index num_nodes) {
  if (number < first || number - first >= num_nodes)
    in.fail("node " + std::to_string(number) + " does not exist: nodes are numbered " + std::to_string(first) + " … " +
            std::to_string(first + num_nodes - 1));
  return number - first;
}

void add_vtk_cells(const VtkCells& cells, Index first_node, const Cursor& in, FileMesh& mesh) {
  const auto num_cells = static_cast<Index>(cells.types.size());
  const Index num_nodes = static_cast<Index>(mesh.nodes.size()) - first_node;
  const auto fail = [&in](Index c, const std::string& what) {
    in.fail_whole("cell " + std::to_string(c) + " " + what);
  };
  if (static_cast<Index>(cells.offsets.size()) != num_cells + 1)
    in.fail_whole("there are " + std::to_string(cells.offsets.size()) + " cells and " + std::to_string(num_cells) +
                  " cell types");
  auto first_cell = mesh.num_cells() + mesh.num_lower;
  for (const auto& [kind, count] : mesh.other_solid) first_cell += count;
  const bool has_region = static_cast<Index>(cells.region.size()) == num_cells;
  for (Index c = 0; c < num_cells; ++c) {
    const std::int64_t begin = cells.offsets[c], end = cells.offsets[c + 1];
    if (begin < 0 || end < begin || end > static_cast<std::int64_t>(cells.connectivity.size()))
      fail(c, "reaches outside the list of node numbers");
    const VtkType type = vtk_type(cells.types[c], in);
    if (type.kind == VtkType::Other) {
      if (*type.plural != '\0')
        ++mesh.other_solid[type.plural];
      else
        ++mesh.num_lower;
      continue;
    }
    const std::int64_t size = end - begin;
    const bool is_tet = type.kind == VtkType::Tet;
    if (is_tet ? size < 4 || (cells.types[c] == 10 && size > 4) : size != 8)
      fail(c, std::string(is_tet ? "is a tet of " : "is a hexahedron of ") + std::to_string(size) + " nodes");
    std::array<Index, 10> nodes{};
    for (std::int64_t a = 0; a < std::min<std::int64_t>(size, 10); ++a) {
      const std::int64_t node = cells.connectivity[begin + a];
      if (node < 0 || node >= num_nodes)
        fail(c, "names node " + std::to_string(node) + ", there are " + std::to_string(num_nodes));
      nodes[a] = first_node + node;
    }
    if (type.kind == VtkType::Voxel) std::swap(nodes[2], nodes[3]), std::swap(nodes[6], nodes[7]);
    // nodes amid the edges are points of the cell in these types; in a Bézier tet they are not
    const bool is_quadratic = size == 10 && (cells.types[c] == 24 || cells.types[c] == 71);
    if (is_tet) {
      mesh.add_tet(std::span(nodes).first(is_quadratic ? 10 : 4));
      mesh.num_higher += size > 4 && !is_quadratic;
    } else {
      mesh.add_hexahedron(std::span(nodes).first(8));
    }
    mesh.numbers.cell.push_back(first_cell + c);
    if (has_region) mesh.attribute.push_back(cells.region[c]);
  }
}

int tag_of_groups(FileMesh& mesh, const std::vector<int>& groups) {
  if (groups.size() == 1) return groups.front();
  for (const auto& [tag, others] : mesh.region_groups)
    if (others == groups) return tag;
  constexpr int first = 1'000'000'000;  // beyond what people number
  const int tag = first + static_cast<int>(mesh.region_groups.size());
  mesh.region_groups[tag] = groups;
  return tag;
}

void make_regions_of_attributes(FileMesh& mesh) {
  constexpr std::size_t most_regions = 1000;
  std::vector<double>& attribute = mesh.attribute;
  if (attribute.empty()) return;
  const auto is_tag = [](double value) { return !(std::abs(value) < 1e9) || value == std::trunc(value); };
  if (std::ranges::all_of(attribute, is_tag)) {
    for (const double value : attribute) mesh.region.push_back(std::abs(value) < 1e9 ? static_cast<int>(value) : 0);
    return;
  }
  std::map<double, int> tag_of;
  for (const double value : attribute)
    if (std::isfinite(value)) tag_of[value] = 0;
  if (tag_of.size() > most_regions) {
    mesh.warnings.push_back("attributes of cells have " + std::to_string(tag_of.size()) +
                            " different values, too many for regions: not read");
    return;
  }
  for (int tag = 0; auto& [value, number] : tag_of) mesh.region_names[number = ++tag] = exact(value);
  for (const double value : attribute) mesh.region.push_back(std::isfinite(value) ? tag_of[value] : 0);
}

bool is_region_array(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* known : {"region", "region_id", "regionid", "material", "material_id", "materialid", "material_ids",
                            "materialids", "gmsh:physical", "medit:ref", "tetgen:ref", "cellentityids", "physical_ids"})
    if (lower == known) return true;
  return false;
}

NumberTable::NumberTable(const std::vector<std::int64_t>& numbers, const Cursor& in) {
  if (numbers.empty()) return;
  first_ = numbers.front();
  std::size_t in_turn = 1;
  while (in_turn < numbers.size() && numbers[in_turn] == numbers[in_turn - 1] + 1) ++in_turn;
  if (in_turn == numbers.size()) {
    last_ = numbers.back();
    return;
  }
  table_.reserve(numbers.size());
  for (std::size_t k = 0; k < numbers.size(); ++k)
    if (!table_.emplace(numbers[k], static_cast<Index>(k)).second)
      in.fail("node number " + std::to_string(numbers[k]) + " is given twice");
}

std::optional<Index> NumberTable::lookup(std::int64_t number) const {
  if (table_.empty()) {
    if (number >= first_ && number <= last_) return number - first_;
  } else if (const auto found = table_.find(number); found != table_.end()) {
    return found->second;
  }
  return {};
}

Index NumberTable::find(std::int64_t number, const Cursor& in) const {
  const std::optional<Index> found = lookup(number);
  if (!found) in.fail("node " + std::to_string(number) + " does not exist");
  return *found;
}

}  // namespace supple
