#pragma once
// A force from outside of one's own: a steady wind on the surface, which turns with it.

#include <physics/load/outside_force_library.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <vector>

struct WindParameters {
  double x = 0, y = 0, z = 5;  // of the air [m/s]
  double density = 1.2;        // of the air [kg/m³]
};

/// Presses on each triangle that faces the wind with ρ |w · n| (w · n) n an area, n its normal where it is now. There is no
/// potential: integrators and Newton's method take it all the same, minimisers refuse it.
class Wind {
 public:
  Wind(const supple::TouchedNodes& where, const WindParameters& p)
      : nodes_(where.nodes), wind_(p.x, p.y, p.z), density_(p.density) {
    std::vector<supple::Index> position(where.rest_positions.rows(), -1);
    rest_.resize(static_cast<supple::Index>(nodes_.size()), 3);
    for (std::size_t a = 0; a < nodes_.size(); ++a) {
      position[nodes_[a]] = static_cast<supple::Index>(a);
      rest_.row(static_cast<supple::Index>(a)) = where.rest_positions.row(nodes_[a]);
    }
    for (const auto& [a, b, c] : where.triangles) triangles_.push_back({position[a], position[b], position[c]});
  }

  std::span<const supple::Index> nodes() const { return nodes_; }
  void force(const supple::Points& u, supple::Points& f) const {
    f.setZero(u.rows(), 3);
    const supple::Points x = rest_ + u;
    for (const auto& [a, b, c] : triangles_) {
      const supple::Point twice_area = (x.row(b) - x.row(a)).cross(x.row(c) - x.row(a)).transpose();
      const supple::Point n = twice_area.normalized();
      const double against = std::min(0.0, wind_.dot(n));  // outward normals face the wind where this is negative
      const supple::Point third = density_ * against * against * twice_area.norm() / 6 * -n;
      for (const supple::Index corner : {a, b, c}) f.row(corner) += third.transpose();
    }
  }

 private:
  std::vector<supple::Index> nodes_;
  supple::Points rest_;
  std::vector<std::array<supple::Index, 3>> triangles_;
  supple::Point wind_;
  double density_;
};
static_assert(supple::OutsideForce<Wind>);
