#pragma once
/// \file Meshes of cells with any number of nodes: hexahedra, quadratic tets.

#include <physics/tet_mesh.hpp>

#include <array>
#include <vector>

namespace supple {

/// Nodes [m] and cells of `nodes_per_cell` nodes, in the order that the element type states (see
/// elements.hpp).
template <int nodes_per_cell>
struct CellMesh {
  Points nodes;                                          ///< n × 3 [m]
  std::vector<std::array<Index, nodes_per_cell>> cells;  ///< positively oriented

  Index num_nodes() const { return nodes.rows(); }
  Index num_cells() const { return static_cast<Index>(cells.size()); }
};

using HexMesh = CellMesh<8>;
using QuadraticTetMesh = CellMesh<10>;

/// The tets of a mesh as cells; regions are left behind.
CellMesh<4> cell_mesh(const TetMesh& mesh);

/// A box of nx × ny × nz hexahedra with one corner in the origin. Node (i, j, k) is number
/// i + (nx + 1) (j + (ny + 1) k), cell (i, j, k) number i + nx (j + ny k).
/// \param size  the sides of the box [m].  \throws std::invalid_argument unless counts and sides are
/// positive.
HexMesh hex_box(Index nx, Index ny, Index nz, const Point& size);

/// The same tets with a node amid each edge, sides straight: displacements in them become quadratic. Corners
/// keep their numbers; mid-edge nodes follow, in order of the lower, then of the higher corner of their edge.
QuadraticTetMesh quadratic_mesh(const TetMesh& mesh);

}  // namespace supple
