#pragma once
/// \file Loads on the nodes of an object.

#include <core/types.hpp>
#include <physics/load/outside_force.hpp>

#include <vector>

namespace supple {

struct NodalForce {
  Index node;
  Point force;  ///< [N]
};

/// A zero-length Hookean spring from a node to a point in space: energy ½ k |u_v − u*|².
struct PointSpring {
  Index node;
  double stiffness;    ///< k [N/m]
  Point displacement;  ///< u* = target − rest position of the node [m]
};

/// What acts on an object at one moment. Gravity, forces and springs are affine in the displacements and projected to
/// the unknowns of a system once; others are evaluated wherever the system is.
struct Loads {
  Point gravity = Point::Zero();  ///< acceleration [m/s²]
  std::vector<NodalForce> forces = {};
  std::vector<PointSpring> springs = {};
  std::vector<AnyOutsideForce> others = {};
};

/// Throws std::invalid_argument if a load names a node outside 0 … num_nodes − 1 or is not finite, a spring is not
/// positive, or another force touches a node twice.
void check_loads(const Loads& loads, Index num_nodes);

}  // namespace supple
