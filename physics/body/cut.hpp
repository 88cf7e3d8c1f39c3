#pragma once
/// \file Internal force and moment through a cut.

#include <physics/body/body.hpp>

namespace supple {

/// A plane across an axis.
struct CutPlane {
  int axis = 0;           ///< 0, 1 or 2
  double coordinate = 0;  ///< at rest [m]
};

/// What the part beyond a plane exerts on the part before it, by the forces of the cells between them.
struct CutForce {
  Point force = Point::Zero();   ///< [N]
  Point moment = Point::Zero();  ///< about a point, in the deformed state [N m]
  Index components = 0;          ///< before the plane that touch it
};

/// The cut runs along the faces of cells: a cell, or a component of the force model, lies where the mean of its nodes at rest
/// does. In equilibrium the force is that of the loads and supports beyond the cut; those at nodes in the cut count there.
/// \param u  displacements of all nodes, 3n [m].  \param about  of moments [m].
/// \throws std::invalid_argument if nothing lies on one side.
CutForce cut_force(const Body& body, VectorIn u, const CutPlane& plane, const Point& about = Point::Zero());

}  // namespace supple
