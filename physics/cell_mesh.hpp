#pragma once
/// \file Meshes of cells with any number of nodes: hexahedra, quadratic tets.

#include <physics/elements.hpp>
#include <physics/tet_mesh.hpp>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace supple {

/// Nodes [m] and cells of `nodes_per_cell` nodes, in the order that the element type states (see
/// elements.hpp). A mesh of hexahedra or quadratic tets that went through check_mesh or an io reader promises: finite
/// coordinates, indices in range, nodes of a cell distinct, det J > 0 where forces and masses are taken and at the
/// corners of a hexahedron, every node used, and at most two cells at a face, one on either side of it.
template <int nodes_per_cell>
struct CellMesh {
  Points nodes = {};                                          ///< n × 3 [m]
  std::vector<std::array<Index, nodes_per_cell>> cells = {};  ///< positively oriented
  std::vector<int> region = {};                               ///< one tag a cell, or empty
  std::map<int, std::string> region_names = {};

  Index num_nodes() const { return nodes.rows(); }
  Index num_cells() const { return static_cast<Index>(cells.size()); }
};

using HexMesh = CellMesh<8>;
using QuadraticTetMesh = CellMesh<10>;

/// The element type that a mesh of solids stands for, and its cells, whatever they are called.
template <typename Mesh>
struct element_of;
template <>
struct element_of<TetMesh> {
  using type = LinearTet;
};
template <>
struct element_of<HexMesh> {
  using type = TrilinearHex;
};
template <>
struct element_of<QuadraticTetMesh> {
  using type = QuadraticTet;
};
template <typename Mesh>
using ElementOf = typename element_of<Mesh>::type;

inline const std::vector<Tet>& cells_of(const TetMesh& mesh) {
  return mesh.tets;
}
template <int nodes_per_cell>
const std::vector<std::array<Index, nodes_per_cell>>& cells_of(const CellMesh<nodes_per_cell>& mesh) {
  return mesh.cells;
}
inline std::vector<Tet>& cells_of(TetMesh& mesh) {
  return mesh.tets;
}
template <int nodes_per_cell>
std::vector<std::array<Index, nodes_per_cell>>& cells_of(CellMesh<nodes_per_cell>& mesh) {
  return mesh.cells;
}
template <typename Mesh>
Index num_cells(const Mesh& mesh) {
  return static_cast<Index>(cells_of(mesh).size());
}

/// The tets of a mesh as cells.
CellMesh<4> cell_mesh(const TetMesh& mesh);

/// A box of nx × ny × nz hexahedra with one corner in the origin. Node (i, j, k) is number
/// i + (nx + 1) (j + (ny + 1) k), cell (i, j, k) number i + nx (j + ny k).
/// \param size  the sides of the box [m].  \throws std::invalid_argument unless counts and sides are
/// positive.
HexMesh hex_box(Index nx, Index ny, Index nz, const Point& size);

/// The same tets with a node amid each edge, sides straight: displacements in them become quadratic. Corners
/// keep their numbers; mid-edge nodes follow, in order of the lower, then of the higher corner of their edge.
QuadraticTetMesh quadratic_mesh(const TetMesh& mesh);

/// Signed volume [m³] of cell e, exact.
double cell_volume(const TetMesh& mesh, Index e);
double cell_volume(const HexMesh& mesh, Index e);
double cell_volume(const QuadraticTetMesh& mesh, Index e);

/// The same cell with its sense turned over, for cells of negative volume.
Tet reversed(const Tet& cell);
std::array<Index, 8> reversed(const std::array<Index, 8>& cell);
std::array<Index, 10> reversed(const std::array<Index, 10>& cell);

/// Quality of a hexahedron: over its corners, the least volume that the three edges span, relative to their lengths. 1
/// for a brick, 0 where a corner is flat, below where it is turned inside out. \see Knupp 2000.
double scaled_jacobian(const HexMesh& mesh, Index e);
/// Of the corners of quadratic tet e alone. \see radius_ratio(const TetMesh&, Index)
double radius_ratio(const QuadraticTetMesh& mesh, Index e);

/// Makes sure that a mesh is fit for elasticity: keeps what CellMesh promises.
/// \throws std::invalid_argument that names the first cell, node or face at fault.
/// \note O(n + m log k), k the largest number of cells at a node.
void check_mesh(const HexMesh& mesh, const MeshNumbers& numbers = {});
void check_mesh(const QuadraticTetMesh& mesh, const MeshNumbers& numbers = {});

/// Faces that belong to one cell only, oriented outward, in order of cells, each cut into triangles: the two halves of a
/// quadrilateral; the three corners of a six-node face and what is between its mid-edge nodes.
std::vector<Triangle> boundary_faces(const HexMesh& mesh);
std::vector<Triangle> boundary_faces(const QuadraticTetMesh& mesh);
template <typename Mesh>
inline constexpr Index triangles_per_face = ElementOf<Mesh>::num_nodes == 8    ? 2
                                            : ElementOf<Mesh>::num_nodes == 10 ? 4
                                                                               : 1;

/// Where the boundary is not a surface.
Hinges boundary_hinges(const HexMesh& mesh);
Hinges boundary_hinges(const QuadraticTetMesh& mesh);

/// Connected components of the object, through shared nodes.
NodeComponents connected_components(const HexMesh& mesh);
NodeComponents connected_components(const QuadraticTetMesh& mesh);

}  // namespace supple
