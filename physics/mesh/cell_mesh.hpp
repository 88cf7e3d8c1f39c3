#pragma once
/// \file Meshes of solids: cells over nodes.

#include <physics/mesh/mesh_numbers.hpp>
#include <physics/mesh/node_components.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace supple {

/// Nodes [m] and cells of `size` nodes each, in the order that the element type states (see elements.hpp). A mesh that
/// went through check_mesh or an io reader promises: finite coordinates, indices in range, nodes of a cell distinct,
/// det J > 0 where forces and masses are taken and at the corners of a hexahedron, every node used, and at most two
/// cells at a face, one on either side of it.
template <int size>
struct CellMesh {
  static constexpr int nodes_per_cell = size;

  Points nodes = {};                                ///< n × 3 [m]
  std::vector<std::array<Index, size>> cells = {};  ///< m, positively oriented
  std::vector<int> region = {};                     ///< one tag a cell, or empty
  std::map<int, std::string> region_names = {};
  /// The groups of cells that are in several: by a tag that only these cells have, the tags of their groups.
  std::map<int, std::vector<int>> region_groups = {};
  NodePlaces places = {};       ///< of the nodes in their file
  NodeGroups node_groups = {};  ///< of faces, edges and nodes in their file

  Index num_nodes() const { return nodes.rows(); }
  Index num_cells() const { return static_cast<Index>(cells.size()); }
};

using TetMesh = CellMesh<4>;
using HexMesh = CellMesh<8>;
using QuadraticTetMesh = CellMesh<10>;
using Tet = std::array<Index, 4>;  ///< positively oriented: det(b − a, c − a, d − a) > 0

struct LinearTet;
struct TrilinearHex;
struct QuadraticTet;

/// The element type (see elements.hpp) that a mesh of solids stands for.
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

/// The two corners of the axis-aligned bounding box of all nodes [m]; its diagonal is `extent().norm()`.
struct BoundingBox {
  Point lower, upper;
  Point extent() const { return upper - lower; }
  double diagonal() const { return extent().norm(); }
};
BoundingBox bounding_box(const Points& nodes);

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
void check_mesh(const TetMesh& mesh, const MeshNumbers& numbers = {});
void check_mesh(const HexMesh& mesh, const MeshNumbers& numbers = {});
void check_mesh(const QuadraticTetMesh& mesh, const MeshNumbers& numbers = {});

/// Faces that belong to one cell only, oriented outward, in order of cells, each cut into triangles: the two halves of a
/// quadrilateral; the three corners of a six-node face and what is between its mid-edge nodes.
std::vector<Triangle> boundary_faces(const TetMesh& mesh);
std::vector<Triangle> boundary_faces(const HexMesh& mesh);
std::vector<Triangle> boundary_faces(const QuadraticTetMesh& mesh);
template <typename Mesh>
inline constexpr Index triangles_per_face = Mesh::nodes_per_cell == 8    ? 2
                                            : Mesh::nodes_per_cell == 10 ? 4
                                                                         : 1;

/// Where the boundary is not a surface.
Hinges boundary_hinges(const TetMesh& mesh);
Hinges boundary_hinges(const HexMesh& mesh);
Hinges boundary_hinges(const QuadraticTetMesh& mesh);

/// Connected components of the object, through shared nodes.
NodeComponents connected_components(const TetMesh& mesh);
NodeComponents connected_components(const HexMesh& mesh);
NodeComponents connected_components(const QuadraticTetMesh& mesh);

}  // namespace supple
