#pragma once
/// \file Soft floor: an outside force that keeps nodes above a plane.

#include <core/registry.hpp>
#include <physics/load/outside_force.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace supple {

enum class FloorAxis { X, Y, Z };
template <>
inline constexpr std::array names_of<FloorAxis>{Named{FloorAxis::X, "x"}, Named{FloorAxis::Y, "y"},
                                                Named{FloorAxis::Z, "z"}};

struct FloorParameters {
  FloorAxis axis = FloorAxis::Y;  ///< which way is up
  double height = 0;              ///< of the floor [m]
  double stiffness = 1e4;         ///< of all nodes together, shared out [N/m]
};

/// A plane that pushes nodes below it back up: V = ½ Σ_v k_v d_v² with the depth d_v = max(0, height − x_v) of node v. No
/// friction. A model of PotentialOutsideForce and StiffOutsideForce.
class PenaltyFloor {
 public:
  /// \param rest_positions  n × 3 [m].  \param nodes  those that it may touch.  \param shares  of these in the stiffness,
  /// such as their shares of the mass, so that a finer mesh meets the same floor.
  PenaltyFloor(const Points& rest_positions, std::vector<Index> nodes, const Vector& shares,
               const FloorParameters& parameters);

  std::span<const Index> nodes() const { return nodes_; }
  void force(const Points& u, Points& f) const;
  double potential(const Points& u) const;
  void stiffness(const Points& u, ForceGradient& K) const;

 private:
  double depth(const Points& u, Index a) const { return std::max(0.0, -above_[a] - u(a, axis_)); }

  std::vector<Index> nodes_;
  Vector above_;      // of the floor, at rest [m]
  Vector stiffness_;  // [N/m]
  int axis_;
};

}  // namespace supple
