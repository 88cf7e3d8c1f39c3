#pragma once
/// \file Shares of nodes in a part of a surface: what tractions and pressures do to them.

#include <physics/body/body.hpp>

#include <vector>

namespace supple {

/// What a node has of a surface at rest, by the shape functions N of its faces.
struct SurfaceShare {
  Index node = 0;
  double area = 0;               ///< ∫ N dA [m²]: times a traction [Pa] it is the force on the node
  Point normal = Point::Zero();  ///< ∫ N n dA, outward [m²]: times −p it is the force of a pressure p
};

/// The part of a solid's boundary, or of a shell, that is made of the faces of a group, or where it has none of those whose
/// nodes are all among its: a share for each node of that part, ascending. Forces that follow from them are those of the elements themselves, so that a uniform traction on a box is
/// borne by uniform stress.
/// \return empty if there is no such face.
std::vector<SurfaceShare> surface_shares(const Body& body, const NodeGroup& part);
inline std::vector<SurfaceShare> surface_shares(const Body& body, std::vector<Index> nodes) {
  return surface_shares(body, NodeGroup{std::move(nodes), {}});
}

/// The same faces, cut into triangles with corners counter-clockwise as seen from outside.
std::vector<Triangle> surface_triangles(const Body& body, const NodeGroup& part);

}  // namespace supple
