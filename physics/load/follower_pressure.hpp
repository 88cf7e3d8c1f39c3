#pragma once
/// \file Pressure on a surface that it follows: an outside force.

#include <physics/load/outside_force.hpp>

#include <array>
#include <vector>

namespace supple {

struct PressureParameters {
  double pressure = 0;  ///< pushing inward [Pa]
};

/// A pressure that stays normal to a surface and grows with its area: f = −p/6 (x_b − x_a) × (x_c − x_a) on each corner of
/// every triangle (a, b, c). It has no potential but where the surface is closed. A model of StiffOutsideForce.
class FollowerPressure {
 public:
  static constexpr bool is_load = true;

  /// \param rest_positions  of all nodes, n × 3 [m].  \param triangles  of nodes, corners counter-clockwise seen from outside.
  /// \throws std::invalid_argument for no triangles, a node that does not exist and a pressure that is not finite.
  FollowerPressure(const Points& rest_positions, const std::vector<std::array<Index, 3>>& triangles,
                   const PressureParameters& parameters);

  std::span<const Index> nodes() const { return nodes_; }
  void force(const Points& u, Points& f) const;
  void stiffness(const Points& u, ForceGradient& K) const;

 private:
  std::vector<Index> nodes_;
  std::vector<std::array<Index, 3>> triangles_;  // positions in nodes_
  Points rest_;                                  // of nodes_ [m]
  double pressure_;
};

}  // namespace supple
