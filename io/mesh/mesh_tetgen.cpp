#include <io/mesh/mesh_formats.hpp>

#include <cmath>
#include <numeric>

namespace supple {
namespace {

/// A number of columns that the first line announces; 0 if it does not say.
std::int64_t num_columns(Cursor& in, const std::string& what) {
  const std::int64_t count = in.at_line_end() ? 0 : in.integer_in_line("the number of " + what);
  if (count < 0 || count > 1000) in.fail("expected 0 … 1000 " + what + ", found " + std::to_string(count));
  return count;
}

}  // namespace

/// Rows stand in lines of their own; what follows the announced columns is ignored. The first number of the
/// .node file, 0 or 1, is the base of all. \see Si 2015, "TetGen, a Delaunay-based quality tetrahedral mesh
/// generator", file formats.
void read_tetgen(Cursor& node_file, Cursor& ele_file, FileMesh& mesh) {
  mesh.format = "TetGen";
  const auto next_line = [](Cursor& in, std::string_view what) {
    if (in.peek().empty()) in.word(), in.fail("the file ends before " + std::string(what));
  };
  const Index num_nodes = node_file.count("nodes", 7);
  if (node_file.integer_in_line("the dimension") != 3) node_file.fail("expected dimension 3");
  const std::int64_t num_extra = num_columns(node_file, "attributes"),
                     num_markers = num_columns(node_file, "boundary markers");
  node_file.rest_of_line();
  mesh.nodes.resize(num_nodes);
  std::int64_t first = 1;
  for (Index v = 0; v < num_nodes; ++v) {
    next_line(node_file, "node " + std::to_string(first + v));
    const std::int64_t number = node_file.integer("a node number");
    if (v == 0) {
      if (number != 0 && number != 1) node_file.fail("expected nodes to be numbered from 0 or 1");
      first = number;
    }
    if (number != first + v)
      node_file.fail("expected node " + std::to_string(first + v) + ", found " + std::to_string(number));
    for (double& coordinate : mesh.nodes[v]) coordinate = node_file.real_in_line("a coordinate");
    for (std::int64_t k = 0; k < num_extra; ++k) node_file.real_in_line("an attribute");
    for (std::int64_t k = 0; k < num_markers; ++k)
      if (const double marker = node_file.real_in_line("a boundary marker");
          marker != 0 && marker == std::floor(marker) && std::abs(marker) < 1e15)
        mesh.node_groups["marker " + std::to_string(static_cast<std::int64_t>(marker))].nodes.push_back(v);
    node_file.rest_of_line();
  }
  mesh.numbers.node.resize(num_nodes);
  std::iota(mesh.numbers.node.begin(), mesh.numbers.node.end(), first);

  const Index num_tets = ele_file.count("tets", 9);
  const std::int64_t nodes_per_tet = ele_file.integer_in_line("4 or 10 nodes a tet");
  if (nodes_per_tet != 4 && nodes_per_tet != 10)
    ele_file.fail("expected 4 or 10 nodes a tet, found " + std::to_string(nodes_per_tet));
  const std::int64_t num_attributes = num_columns(ele_file, "attributes");
  ele_file.rest_of_line();
  mesh.tets.reserve(num_tets);
  for (Index e = 0; e < num_tets; ++e) {
    next_line(ele_file, "tet " + std::to_string(first + e));
    mesh.numbers.cell.push_back(ele_file.integer("a tet number"));
    std::array<Index, 10> nodes;
    for (int a = 0; a < nodes_per_tet; ++a)
      nodes[a] = node_at(ele_file, ele_file.integer_in_line("a node number"), first, num_nodes);
    mesh.add_tet(std::span(nodes).first(nodes_per_tet));
    double region = 0;
    for (std::int64_t k = 0; k < num_attributes; ++k) region = ele_file.real_in_line("an attribute");
    if (num_attributes > 0) mesh.attribute.push_back(region);
    ele_file.rest_of_line();
  }
  order_mid_edges(mesh, ele_file);
}

}  // namespace supple
