#pragma once
/// \file Volume, shape and orientation of single tets.

#include <physics/mesh/cell_mesh.hpp>

namespace supple {

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

}  // namespace supple
