#pragma once
/// \file Surface of an object, as pictures, ParaView and viewers see it.

#include <physics/body/body.hpp>

#include <vector>

namespace supple {

/// The boundary of a solid, its faces cut into triangles, or a shell itself: triangles over `nodes`, which are indices
/// into the mesh.
struct Surface {
  std::vector<Triangle> triangles;
  std::vector<Index> nodes;

  explicit Surface(const Body& body);
  /// The rows of the surface's nodes.
  Points rows(const Points& all) const;
};

}  // namespace supple
