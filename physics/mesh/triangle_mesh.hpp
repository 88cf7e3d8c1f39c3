#pragma once
/// \file Meshes of surfaces: triangles over nodes.

#include <core/types.hpp>
#include <physics/mesh/mesh_numbers.hpp>
#include <physics/mesh/node_components.hpp>

#include <array>
#include <vector>

namespace supple {

using Triangle = std::array<Index, 3>;

/// Nodes [m] and triangles. A mesh that went through check_mesh or an io reader promises: finite coordinates,
/// indices in range, three different nodes in a triangle, areas > 0, no two triangles with the same nodes,
/// every node used, at most two triangles at an edge, which run along it in opposite directions: so each
/// connected piece has two sides, and the corners of a triangle turn counterclockwise as seen from the one
/// that its normals point to.
struct TriangleMesh {
  Points nodes;                     ///< n × 3 [m]
  std::vector<Triangle> triangles;  ///< normal (b − a) × (c − a)
  NodePlaces places = {};           ///< of the nodes in their file

  Index num_nodes() const { return nodes.rows(); }
  Index num_triangles() const { return static_cast<Index>(triangles.size()); }
};

/// Area [m²] of triangle t.
double triangle_area(const TriangleMesh& mesh, Index t);

/// 2 inradius / circumradius of triangle t: 1 if equilateral, 0 if its corners lie in a line.
double radius_ratio(const TriangleMesh& mesh, Index t);

/// Makes sure that a mesh is fit for shells: keeps what TriangleMesh promises. Areas are judged relative to
/// the size of their triangle, so meshes in micrometres and in kilometres are treated alike.
/// \throws std::invalid_argument that names the first triangle, node or edge at fault.
/// \note O(n + m log k), k the largest number of triangles at a node.
void check_mesh(const TriangleMesh& mesh, const MeshNumbers& numbers = {});

/// Turns triangles over until neighbours run along their common edge in opposite directions: in every piece
/// that is connected through edges, the smaller part (if equal, the one without its first triangle). Edges of
/// more than two triangles connect nothing.
/// \return the number of triangles turned over.
/// \throws std::invalid_argument if a piece has only one side (a Möbius strip); names an edge where it shows.
Index orient_consistently(TriangleMesh& mesh, const MeshNumbers& numbers = {});

/// The side 3 t + k, from corner k of triangle t to the next, has a neighbour: the side of the triangle
/// across the same edge. One number a side; −1 at the boundary. For meshes that passed check_mesh.
std::vector<Index> neighbour_sides(const TriangleMesh& mesh);

/// Two triangles with a common edge: (a, b, c) and (b, a, d).
struct Flap {
  std::array<Index, 4> nodes;      ///< a, b, c, d
  std::array<Index, 2> triangles;  ///< (a, b, c) and (b, a, d)
};

/// The interior edges with their triangles, in order of the first triangle and its corners. For meshes that
/// passed check_mesh.
std::vector<Flap> interior_edges(const TriangleMesh& mesh);

/// The edges of one triangle only, directed as in it, in order of triangles and their corners.
std::vector<std::array<Index, 2>> boundary_edges(const TriangleMesh& mesh);

/// Where triangles do not form a surface: parts hang together by an edge or a node only and turn about it
/// freely.
struct Hinges {
  Index edges = 0;  ///< that belong to more than two triangles
  Index nodes = 0;  ///< off those edges, with more than one fan of triangles
};
Hinges surface_hinges(const std::vector<Triangle>& triangles, Index num_nodes);

/// Connected components of the object, through shared nodes.
NodeComponents connected_components(const TriangleMesh& mesh);

}  // namespace supple
