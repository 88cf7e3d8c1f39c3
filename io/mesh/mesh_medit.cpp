#include <io/mesh/mesh_formats.hpp>

#include <cctype>
#include <numeric>

namespace supple {

/// \see Frey 2001, "MEDIT: an interactive mesh visualization software", INRIA RT-0253, file format.
void read_medit(Cursor& in, FileMesh& mesh) {
  mesh.format = "Medit, ASCII";
  in.expect("MeshVersionFormatted");
  in.integer("a version");
  Index num_vertices = -1;
  const auto read_cells = [&](std::string_view what, int num_nodes) {
    const Index count = in.count(what, 2 * num_nodes + 1);
    if (num_vertices < 0) in.fail("expected Vertices before " + std::string(what));
    for (Index k = 0; k < count; ++k) {
      std::array<Index, 10> nodes;
      for (int a = 0; a < num_nodes; ++a) nodes[a] = node_at(in, in.integer("a node number"), 1, num_vertices);
      if (num_nodes == 8)
        mesh.add_hexahedron(std::span(nodes).first(8));
      else
        mesh.add_tet(std::span(nodes).first(num_nodes));
      mesh.region.push_back(static_cast<int>(in.integer("a reference")));
      mesh.numbers.cell.push_back(static_cast<std::int64_t>(num_nodes == 8 ? mesh.hexahedra.size() : mesh.tets.size()));
    }
  };
  for (std::string_view keyword = in.word(); !keyword.empty() && keyword != "End"; keyword = in.word()) {
    if (keyword == "Dimension") {
      if (const std::int64_t dim = in.integer("a dimension"); dim != 3)
        in.fail("expected Dimension 3, found " + std::to_string(dim));
    } else if (keyword == "Vertices") {
      if (num_vertices >= 0) in.fail("a second section Vertices");
      num_vertices = in.count("vertices", 7);
      mesh.nodes.resize(num_vertices);
      for (Point& x : mesh.nodes) {
        for (double& coordinate : x) coordinate = in.real("a coordinate");
        in.real("a reference");
      }
    } else if (keyword == "Tetrahedra") {
      read_cells("tetrahedra", 4);
    } else if (keyword == "TetrahedraP2") {
      read_cells("tetrahedra", 10);
    } else if (keyword == "Hexahedra") {
      read_cells("hexahedra", 8);
    } else if (std::isalpha(static_cast<unsigned char>(keyword[0]))) {
      // A section that a solid does not need: numbers up to the next keyword.
      const bool is_solid = keyword.starts_with("Hexa") || keyword.starts_with("Prism") || keyword.starts_with("Pyr");
      const bool is_lower = keyword == "Triangles" || keyword == "Quadrilaterals" || keyword == "Edges";
      const std::string kind(keyword);
      if (is_solid || is_lower) {
        const Index count = in.count("cells", 2);
        if (is_solid && count > 0) mesh.other_solid[kind] += count;
        if (is_lower) mesh.num_lower += count;
      }
      for (std::string_view next = in.peek(); !next.empty() && !std::isalpha(static_cast<unsigned char>(next[0]));
           next = in.peek())
        in.word();
    } else {
      in.fail("expected a keyword such as Vertices, found \"" + std::string(keyword.substr(0, 40)) + "\"");
    }
  }
  if (num_vertices < 0) in.fail("expected a section Vertices");
  order_mid_edges(mesh, in);
  mesh.numbers.node.resize(num_vertices);
  std::iota(mesh.numbers.node.begin(), mesh.numbers.node.end(), std::int64_t{1});
}

}  // namespace supple
