#include <io/mesh/mesh_formats.hpp>

#include <numeric>
#include <set>

namespace supple {

/// \see Sin, Schroeder and Barbič 2013, "Vega: Non-Linear FEM Deformable Object Simulator", and the .veg
/// manual.
void read_vega(Cursor& in, FileMesh& mesh) {
  mesh.format = "VegaFEM";
  Index num_nodes = -1;
  std::int64_t first_node = 1, first_cell = 1;
  std::map<std::string, std::vector<std::int64_t>> sets;
  std::set<std::string> materials;
  struct Region {
    std::string set;
    std::size_t position;
  };
  std::vector<Region> regions;
  bool skip_rows = false;  // parameters of a material, or elements of another kind

  for (std::string_view keyword = in.word(); !keyword.empty(); keyword = in.word()) {
    if (keyword == "*VERTICES") {
      if (num_nodes >= 0) in.fail("a second section *VERTICES");
      num_nodes = in.count("vertices", 7);
      if (in.integer("the dimension") != 3) in.fail("expected dimension 3");
      in.rest_of_line();
      mesh.nodes.resize(num_nodes);
      for (Index v = 0; v < num_nodes; ++v) {
        const std::int64_t number = in.integer("a vertex number");
        if (v == 0) first_node = number;
        if (number != first_node + v || first_node < 0 || first_node > 1)
          in.fail("expected vertices numbered in turn from 0 or 1");
        for (double& coordinate : mesh.nodes[v]) coordinate = in.real("a coordinate");
      }
    } else if (keyword == "*ELEMENTS") {
      if (num_nodes < 0) in.fail("expected *VERTICES before *ELEMENTS");
      const std::string type(in.word());
      const Index count = in.count("elements", 9);
      const std::int64_t nodes_per_element = in.integer("the nodes of an element");
      in.rest_of_line();
      const bool is_hexahedron = type == "CUBIC";
      if (type != "TET" && type != "TETS" && !is_hexahedron) {
        skip_rows = true;
        mesh.other_solid["elements of kind " + type.substr(0, 20)] += count;
        continue;
      }
      const int size = is_hexahedron ? 8 : 4;
      if (nodes_per_element != size)
        in.fail("expected " + std::to_string(size) + " nodes a " + (is_hexahedron ? "cube" : "tet") + ", found " +
                std::to_string(nodes_per_element));
      for (Index e = 0; e < count; ++e) {
        const std::int64_t number = in.integer("an element number");
        if (mesh.num_cells() == 0) first_cell = number;
        mesh.numbers.cell.push_back(number);
        std::array<Index, 8> nodes{};
        for (int a = 0; a < size; ++a) nodes[a] = node_at(in, in.integer("a vertex number"), first_node, num_nodes);
        if (is_hexahedron)
          mesh.add_hexahedron(nodes);
        else
          mesh.add_tet(std::span(nodes).first(4));
      }
    } else if (keyword == "*MATERIAL") {
      materials.emplace(in.word());
      skip_rows = true;
    } else if (keyword == "*REGION") {
      std::string set(in.word());
      regions.push_back({std::move(set), in.position()});
      in.rest_of_line();
    } else if (keyword == "*SET") {
      auto& members = sets[std::string(in.word())];
      for (std::string_view next = in.peek(); !next.empty() && next[0] != '*'; next = in.peek())
        members.push_back(in.integer("an element number"));
    } else if (keyword == "*INCLUDE") {
      in.fail("expected a mesh in one file, *INCLUDE is not followed");
    } else if (skip_rows && !keyword.starts_with('*')) {
      in.rest_of_line();
    } else {
      in.fail("expected a section such as *VERTICES, found \"" + std::string(keyword.substr(0, 40)) + "\"");
    }
  }
  if (num_nodes < 0) in.fail("expected a section *VERTICES");
  mesh.numbers.node.resize(num_nodes);
  std::iota(mesh.numbers.node.begin(), mesh.numbers.node.end(), first_node);

  const Index num_cells = mesh.num_cells();
  if (!regions.empty()) mesh.region.assign(num_cells, 0);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const int tag = static_cast<int>(r) + 1;
    mesh.region_names[tag] = regions[r].set;
    if (regions[r].set == "allElements") {
      mesh.region.assign(num_cells, tag);
    } else if (const auto set = sets.find(regions[r].set); set != sets.end()) {
      for (const std::int64_t number : set->second) {
        if (number < first_cell || number - first_cell >= num_cells)
          in.fail("set " + set->first + " names element " + std::to_string(number) + ", which does not exist");
        mesh.region[number - first_cell] = tag;
      }
    } else {
      in.set_position(regions[r].position);
      in.fail("the region names the set " + regions[r].set + ", which does not exist");
    }
  }
  for (const std::string& material : materials)
    mesh.warnings.push_back("the parameters of material " + material + " are not read");
}

}  // namespace supple
