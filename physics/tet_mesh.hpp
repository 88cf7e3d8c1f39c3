#pragma once
/// \file The geometry of a solid: tetrahedra over nodes.

#include <core/types.hpp>

#include <array>
#include <map>
#include <string>
#include <vector>

namespace supple {

using Tet = std::array<Index, 4>;
using Triangle = std::array<Index, 3>;

/// Nodes [m] and tetrahedra. A mesh that went through check_mesh or an io reader promises: finite coordinates,
/// indices in range, four different nodes in a tet, volumes > 0, every node used.
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

/// The two corners of the axis-aligned bounding box of all nodes [m]; its diagonal is `extent().norm()`.
struct BoundingBox {
  Point lower, upper;
  Point extent() const { return upper - lower; }
  double diagonal() const { return extent().norm(); }
};
BoundingBox bounding_box(const Points& nodes);

/// Faces that belong to one tet only, oriented outward, in order of tets.
std::vector<Triangle> boundary_faces(const TetMesh& mesh);

/// Number of the connected component (through shared nodes) of each node, 0 … count − 1 in order of first nodes.
struct NodeComponents {
  std::vector<Index> of_node;
  Index count = 0;
};
NodeComponents connected_components(const TetMesh& mesh);

}  // namespace supple
