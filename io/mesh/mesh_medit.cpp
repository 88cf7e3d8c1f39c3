#include <io/mesh/mesh_formats.hpp>

#include <cctype>
#include <charconv>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>

namespace supple {

namespace {

/// Some programs number vertices by their references, which makes no groups.
constexpr std::size_t most_groups_of_points = 1000;

/// The name of a group by its reference; none for 0 and what is no whole number.
std::optional<std::string> group_of(const std::string& kind, double reference) {
  if (reference == 0 || reference != std::floor(reference) || !(std::abs(reference) < 1e15)) return {};
  return kind + " " + std::to_string(static_cast<std::int64_t>(reference));
}

/// Faces or edges, for their groups; what is not as the format says goes into none. \return how many the section announces
Index read_groups(Cursor& in, const std::string& keyword, Index num_vertices, FileMesh& mesh) {
  const Index count = in.count("cells", 2);
  std::vector<double> numbers;
  bool is_plain = true;
  for (std::string_view next = in.peek(); !next.empty() && !std::isalpha(static_cast<unsigned char>(next[0]));
       next = in.peek()) {
    const std::string_view word = in.word();
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    is_plain = is_plain && error == std::errc() && end == word.data() + word.size();
    numbers.push_back(value);
  }
  const std::size_t num_nodes = keyword == "Edges" ? 2 : keyword == "Triangles" ? 3 : 4;
  if (!is_plain || numbers.size() != static_cast<std::size_t>(count) * (num_nodes + 1)) return count;
  for (std::size_t k = 0; k < numbers.size(); k += num_nodes + 1) {
    const auto group = group_of(num_nodes == 2 ? "curve" : "surface", numbers[k + num_nodes]);
    std::vector<Index> nodes;
    for (std::size_t a = 0; a < num_nodes; ++a)
      if (const double v = numbers[k + a]; v >= 1 && v <= static_cast<double>(num_vertices) && v == std::floor(v))
        nodes.push_back(static_cast<Index>(v) - 1);
    if (!group || nodes.size() != num_nodes) continue;
    NodeGroup& own = mesh.node_groups[*group];
    own.nodes.insert(own.nodes.end(), nodes.begin(), nodes.end());
    if (num_nodes > 2) own.faces.push_back(face_corners(nodes));
  }
  return count;
}

}  // namespace

/// \see Frey 2001, "MEDIT: an interactive mesh visualization software", INRIA RT-0253, file format.
void read_medit(Cursor& in, FileMesh& mesh) {
  mesh.format = "Medit, ASCII";
  in.expect("MeshVersionFormatted");
  in.integer("a version");
  Index num_vertices = -1;
  std::vector<double> references;  // of vertices
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
        references.push_back(in.real("a reference"));
      }
    } else if (keyword == "Tetrahedra") {
      read_cells("tetrahedra", 4);
    } else if (keyword == "TetrahedraP2") {
      read_cells("tetrahedra", 10);
    } else if (keyword == "Hexahedra") {
      read_cells("hexahedra", 8);
    } else if (keyword == "Triangles" || keyword == "Quadrilaterals" || keyword == "Edges") {
      const std::string kind(keyword);
      mesh.num_lower += read_groups(in, kind, num_vertices, mesh);
    } else if (std::isalpha(static_cast<unsigned char>(keyword[0]))) {
      // A section that a solid does not need: numbers up to the next keyword.
      const bool is_solid = keyword.starts_with("Hexa") || keyword.starts_with("Prism") || keyword.starts_with("Pyr");
      const std::string kind(keyword);
      if (is_solid)
        if (const Index count = in.count("cells", 2); count > 0) mesh.other_solid[kind] += count;
      for (std::string_view next = in.peek(); !next.empty() && !std::isalpha(static_cast<unsigned char>(next[0]));
           next = in.peek())
        in.word();
    } else {
      in.fail("expected a keyword such as Vertices, found \"" + std::string(keyword.substr(0, 40)) + "\"");
    }
  }
  if (num_vertices < 0) in.fail("expected a section Vertices");
  std::set<double> distinct;
  for (const double reference : references)
    if (!std::isnan(reference)) distinct.insert(reference);
  if (distinct.size() <= most_groups_of_points)
    for (Index v = 0; v < num_vertices; ++v)
      if (const auto group = group_of("point", references[static_cast<std::size_t>(v)]))
        mesh.node_groups[*group].nodes.push_back(v);
  order_mid_edges(mesh, in);
  mesh.numbers.node.resize(num_vertices);
  std::iota(mesh.numbers.node.begin(), mesh.numbers.node.end(), std::int64_t{1});
}

}  // namespace supple
