#pragma once
/// \file The geometry of a solid: tetrahedra over nodes.

#include <core/types.hpp>
#include <physics/mesh_numbers.hpp>
#include <physics/node_components.hpp>
#include <physics/triangle_mesh.hpp>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace supple {

using Tet = std::array<Index, 4>;

/// Nodes [m] and tetrahedra. A mesh that went through check_mesh or an io reader promises: finite
/// coordinates, indices in range, four different nodes in a tet, volumes > 0, every node used, and at most
/// two tets at a face, one on either side of it.
struct TetMesh {
  Points nodes;             ///< n × 3 [m]
  std::vector<Tet> tets;    ///< m, each positively oriented: det(b − a, c − a, d − a) > 0
  std::vector<int> region;  ///< one tag a tet, or empty
  std::map<int, std::string> region_names;

  Index num_nodes() const { return nodes.rows(); }
  Index num_tets() const { return static_cast<Index>(tets.size()); }
};

/// Signed volume [m³] of tet e.
double tet_volume(const TetMesh& mesh, Index e);

/// What linear shape functions need of a tet.
struct TetShape {
  Matrix3<double> inverse_edges;  ///< D⁻¹ with D = [b − a, c − a, d − a] [1/m]; row a is ∇Nₐ₊₁
  double volume;                  ///< [m³]
};
/// \throws std::invalid_argument if tet e names a node that does not exist or its volume is not positive.
TetShape tet_shape(const TetMesh& mesh, Index e);

/// 1 if tet e is positively oriented, −1 if reversed, 0 if so flat that rounding may decide its sign.
/// Relative to the size of the tet, so meshes in micrometres and in kilometres are judged alike.
/// \see Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates".
int tet_orientation(const TetMesh& mesh, Index e);

/// 3 inradius / circumradius of tet e: 1 if regular, 0 if flat.
double radius_ratio(const TetMesh& mesh, Index e);
double radius_ratio(const Points& nodes, const Tet& tet);

/// Makes sure that a mesh is fit for elasticity: keeps what TetMesh promises.
/// \throws std::invalid_argument that names the first tet, node or face at fault.
/// \note O(n + m log k), k the largest number of tets at a node.
void check_mesh(const TetMesh& mesh, const MeshNumbers& numbers = {});

/// The two corners of the axis-aligned bounding box of all nodes [m]; its diagonal is `extent().norm()`.
struct BoundingBox {
  Point lower, upper;
  Point extent() const { return upper - lower; }
  double diagonal() const { return extent().norm(); }
};
BoundingBox bounding_box(const Points& nodes);

/// Faces that belong to one tet only, oriented outward, in order of tets.
std::vector<Triangle> boundary_faces(const TetMesh& mesh);

/// Where the boundary is not a surface.
Hinges boundary_hinges(const TetMesh& mesh);

/// Connected components of the object, through shared nodes.
NodeComponents connected_components(const TetMesh& mesh);

}  // namespace supple
