#include <core/check.hpp>
#include <physics/load/follower_pressure.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace supple {

FollowerPressure::FollowerPressure(const Points& rest_positions, const std::vector<std::array<Index, 3>>& triangles,
                                   const PressureParameters& parameters)
    : triangles_(triangles), pressure_(parameters.pressure) {
  require(!triangles.empty(), "no face of the surface has all of its nodes among those of the pressure");
  require(std::isfinite(pressure_), "the pressure is not finite");
  for (const auto& triangle : triangles)
    for (const Index v : triangle) {
      require(v >= 0 && v < rest_positions.rows(), "the pressure is to act on node " + std::to_string(v) +
                                                       ", expected 0 to " + std::to_string(rest_positions.rows() - 1));
      nodes_.push_back(v);
    }
  std::ranges::sort(nodes_);
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  for (auto& triangle : triangles_)
    for (Index& v : triangle) v = std::ranges::lower_bound(nodes_, v) - nodes_.begin();
  rest_ = rest_positions(nodes_, Eigen::all);
}

void FollowerPressure::force(const Points& u, Points& f) const {
  f.setZero(rest_.rows(), 3);
  const Points x = rest_ + u;
  for (const auto& [a, b, c] : triangles_) {
    const Eigen::RowVector3d normal = (x.row(b) - x.row(a)).cross(x.row(c) - x.row(a));
    for (const Index v : {a, b, c}) f.row(v) -= pressure_ / 6 * normal;
  }
}

void FollowerPressure::stiffness(const Points& u, ForceGradient& K) const {
  const Points x = rest_ + u;
  for (const auto& triangle : triangles_)
    for (int j = 0; j < 3; ++j) {  // ∂(x_b − x_a) × (x_c − x_a) / ∂x_j = [the side opposite j]×
      const Eigen::RowVector3d side = pressure_ / 6 *
                                      (x.row(triangle[static_cast<std::size_t>((j + 2) % 3)]) -
                                       x.row(triangle[static_cast<std::size_t>((j + 1) % 3)]));
      Matrix3<double> block;
      block << 0, -side[2], side[1], side[2], 0, -side[0], -side[1], side[0], 0;
      for (const Index i : triangle) K.add(i, triangle[static_cast<std::size_t>(j)], block);
    }
}

}  // namespace supple
