#include <core/check.hpp>
#include <physics/load/penalty_floor.hpp>

#include <cmath>

namespace supple {

PenaltyFloor::PenaltyFloor(const Points& rest_positions, std::vector<Index> nodes, const Vector& shares,
                           const FloorParameters& parameters)
    : nodes_(std::move(nodes)), axis_(static_cast<int>(parameters.axis)) {
  require_size("shares", shares.size(), static_cast<Index>(nodes_.size()));
  require(std::isfinite(parameters.height), "the floor's height is not finite");
  require(std::isfinite(parameters.stiffness) && parameters.stiffness > 0,
          "the floor's stiffness is " + std::to_string(parameters.stiffness) + " N/m, expected > 0");
  stiffness_ = parameters.stiffness * shares;
  above_.resize(shares.size());
  for (Index a = 0; a < above_.size(); ++a) {
    const Index v = nodes_[static_cast<std::size_t>(a)];
    require(v >= 0 && v < rest_positions.rows(), "the floor is to touch node " + std::to_string(v) +
                                                     ", expected 0 to " + std::to_string(rest_positions.rows() - 1));
    above_[a] = rest_positions(v, axis_) - parameters.height;
  }
}

void PenaltyFloor::force(const Points& u, Points& f) const {
  f.setZero(above_.size(), 3);
  for (Index a = 0; a < above_.size(); ++a) f(a, axis_) = stiffness_[a] * depth(u, a);
}

double PenaltyFloor::potential(const Points& u) const {
  double sum = 0;
  for (Index a = 0; a < above_.size(); ++a) sum += 0.5 * stiffness_[a] * depth(u, a) * depth(u, a);
  return sum;
}

void PenaltyFloor::stiffness(const Points& u, ForceGradient& K) const {
  for (Index a = 0; a < above_.size(); ++a)
    if (depth(u, a) > 0) {
      Matrix3<double> block = Matrix3<double>::Zero();
      block(axis_, axis_) = stiffness_[a];
      K.add(a, a, block);
    }
}

}  // namespace supple
