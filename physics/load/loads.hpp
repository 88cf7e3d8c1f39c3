#pragma once
/// \file External loads, given on nodes and projected to the unknowns of a system.

#include <core/types.hpp>

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

/// What acts on an object at one moment.
struct Loads {
  Point gravity = Point::Zero();  ///< acceleration [m/s²]
  std::vector<NodalForce> forces = {};
  std::vector<PointSpring> springs = {};
};

/// Loads in the unknowns of a system: f_ext(u) = force − stiffness u. An empty stiffness stands for zero.
template <typename MatrixType>
struct AffineLoad {
  Vector force;
  MatrixType stiffness;

  bool has_stiffness() const { return stiffness.size() > 0; }
};

/// Throws std::invalid_argument if a load names a node outside 0 … num_nodes − 1 or is not finite, or a
/// spring is not positive.
void check_loads(const Loads& loads, Index num_nodes);

}  // namespace supple
