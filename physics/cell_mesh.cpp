#include <core/check.hpp>
#include <physics/cell_mesh.hpp>
#include <physics/elements.hpp>
#include <physics/equal_keys.hpp>

#include <algorithm>

namespace supple {

CellMesh<4> cell_mesh(const TetMesh& mesh) {
  return {mesh.nodes, mesh.tets};
}

HexMesh hex_box(Index nx, Index ny, Index nz, const Point& size) {
  require(nx > 0 && ny > 0 && nz > 0, "a box needs at least one cell along each axis");
  require((size.array() > 0).all(), "a box needs sides > 0");
  HexMesh mesh;
  const auto node = [&](Index i, Index j, Index k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  mesh.nodes.resize(node(0, 0, nz + 1), 3);
  for (Index k = 0; k <= nz; ++k)
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i)
        mesh.nodes.row(node(i, j, k)) << size[0] * static_cast<double>(i) / static_cast<double>(nx),
            size[1] * static_cast<double>(j) / static_cast<double>(ny),
            size[2] * static_cast<double>(k) / static_cast<double>(nz);
  mesh.cells.reserve(nx * ny * nz);
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        std::array<Index, 8> cell;
        for (int a = 0; a < 8; ++a) {
          const auto& corner = TrilinearHex::corners[a];
          cell[a] = node(i + corner[0], j + corner[1], k + corner[2]);
        }
        mesh.cells.push_back(cell);
      }
  return mesh;
}

QuadraticTetMesh quadratic_mesh(const TetMesh& mesh) {
  constexpr Index edges_per_tet = QuadraticTet::edges.size();
  QuadraticTetMesh result;
  result.cells.resize(mesh.tets.size());
  std::vector<std::array<Index, 2>> edges(edges_per_tet * mesh.tets.size());
  for (Index id = 0; id < static_cast<Index>(edges.size()); ++id) {
    const auto [a, b] = QuadraticTet::edges[id % edges_per_tet];
    const Tet& tet = mesh.tets[id / edges_per_tet];
    edges[id] = {std::min(tet[a], tet[b]), std::max(tet[a], tet[b])};
  }
  std::vector<std::array<Index, 2>> distinct;
  visit_equal(edges, mesh.num_nodes(), [&](std::span<const Index> ids) {
    for (const Index id : ids)
      result.cells[id / edges_per_tet][4 + id % edges_per_tet] =
          mesh.num_nodes() + static_cast<Index>(distinct.size());
    distinct.push_back(edges[ids[0]]);
  });
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) std::ranges::copy(mesh.tets[e], result.cells[e].begin());
  result.nodes.resize(mesh.num_nodes() + static_cast<Index>(distinct.size()), 3);
  result.nodes.topRows(mesh.num_nodes()) = mesh.nodes;
  for (std::size_t k = 0; k < distinct.size(); ++k)
    result.nodes.row(mesh.num_nodes() + static_cast<Index>(k)) =
        (mesh.nodes.row(distinct[k][0]) + mesh.nodes.row(distinct[k][1])) / 2;
  return result;
}

}  // namespace supple
