#include <io/mesh_formats.hpp>

#include <cctype>
#include <cmath>
#include <initializer_list>

namespace supple {
namespace {

struct VtkType {
  bool is_tet = false;
  const char* plural = "";  // of solids; empty: of lower dimension
};

/// Cell types by number. \see VTK file formats, "Cell types"; vtkCellType.h.
VtkType vtk_type(std::int64_t type, const Cursor& in) {
  const auto is = [&](std::initializer_list<std::int64_t> types) {
    return std::find(types.begin(), types.end(), type) != types.end();
  };
  if (is({10, 24, 64, 71, 78})) return {true, "tets"};
  if (is({11, 12, 25, 29, 33, 67, 72, 79})) return {false, "hexahedra"};
  if (is({13, 26, 31, 32, 65, 73, 80})) return {false, "prisms"};
  if (is({14, 27, 37, 66, 74, 81})) return {false, "pyramids"};
  if (is({15, 16, 41, 42})) return {false, "polyhedra"};
  if ((type >= 0 && type <= 9) ||
      is({21, 22, 23, 28, 30, 34, 35, 36, 60, 61, 62, 63, 68, 69, 70, 75, 76, 77}))
    return {false, ""};
  in.fail_whole("cell type " + std::to_string(type) + " is not known");
}

}  // namespace

Index node_at(const Cursor& in, std::int64_t number, std::int64_t first, Index num_nodes) {
  if (number < first || number - first >= num_nodes)
    in.fail("node " + std::to_string(number) + " does not exist: nodes are numbered " +
            std::to_string(first) + " … " + std::to_string(first + num_nodes - 1));
  return number - first;
}

void add_vtk_cells(const VtkCells& cells, Index first_node, const Cursor& in, FileMesh& mesh) {
  const auto num_cells = static_cast<Index>(cells.types.size());
  const Index num_nodes = static_cast<Index>(mesh.nodes.size()) - first_node;
  const auto fail = [&in](Index c, const std::string& what) {
    in.fail_whole("cell " + std::to_string(c) + " " + what);
  };
  if (static_cast<Index>(cells.offsets.size()) != num_cells + 1)
    in.fail_whole("there are " + std::to_string(cells.offsets.size()) + " cells and " +
                  std::to_string(num_cells) + " cell types");
  auto first_cell = static_cast<Index>(mesh.tets.size()) + mesh.num_lower;
  for (const auto& [kind, count] : mesh.other_solid) first_cell += count;
  const bool has_region = static_cast<Index>(cells.region.size()) == num_cells;
  for (Index c = 0; c < num_cells; ++c) {
    const std::int64_t begin = cells.offsets[c], end = cells.offsets[c + 1];
    if (begin < 0 || end < begin || end > static_cast<std::int64_t>(cells.connectivity.size()))
      fail(c, "reaches outside the list of node numbers");
    const VtkType type = vtk_type(cells.types[c], in);
    if (!type.is_tet) {
      if (*type.plural != '\0')
        ++mesh.other_solid[type.plural];
      else
        ++mesh.num_lower;
      continue;
    }
    if (end - begin < 4 || (cells.types[c] == 10 && end - begin > 4))
      fail(c, "is a tet of " + std::to_string(end - begin) + " nodes");
    Tet tet;
    for (int a = 0; a < 4; ++a) {
      const std::int64_t node = cells.connectivity[begin + a];
      if (node < 0 || node >= num_nodes)
        fail(c, "names node " + std::to_string(node) + ", there are " + std::to_string(num_nodes));
      tet[a] = first_node + node;
    }
    mesh.num_corner_only += end - begin > 4;
    mesh.tets.push_back(tet);
    mesh.numbers.tet.push_back(first_cell + c);
    if (has_region) mesh.region.push_back(to_region(cells.region[c]));
  }
}

int to_region(double value) {
  return std::abs(value) < 1e9 ? static_cast<int>(value) : 0;
}

bool is_region_array(std::string_view name) {
  std::string lower(name);
  for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* known :
       {"region", "region_id", "regionid", "material", "material_id", "materialid", "material_ids",
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

Index NumberTable::find(std::int64_t number, const Cursor& in) const {
  if (table_.empty()) {
    if (number >= first_ && number <= last_) return number - first_;
  } else if (const auto found = table_.find(number); found != table_.end()) {
    return found->second;
  }
  in.fail("node " + std::to_string(number) + " does not exist");
}

}  // namespace supple
