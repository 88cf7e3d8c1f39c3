#pragma once
/// \file Pull of an object, by which a selection is judged.

#include <core/types.hpp>

#include <string>

namespace supple {

/// A load from rest, for `steps` steps of a 60th of the slowest period: a uniform acceleration of an object that is
/// held; a force along the slowest flexible mode of one that is free, which would fly off without deforming.
struct PullScene {
  std::string name;
  double target = 0.25;             ///< largest displacement of a node, as a share of the object's diagonal
  double ramp = 0;                  ///< steps over which the pull grows; 0: it is there at once
  double damping = 0;               ///< ratio of the slowest mode, half by α M and half by β K
  Point direction = {0.5, 0.1, 1};  ///< of the acceleration
  int steps = 120;
};

}  // namespace supple
