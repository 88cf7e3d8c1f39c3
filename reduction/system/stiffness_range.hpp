#pragma once
/// \file Range of a fitted stiffness against the exact one.

#include <core/types.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {

struct ReducedModes;

/// Smallest and largest λ of K̃ x = λ K̄ x over motions with energy: how much too soft and too stiff a fitted stiffness is
/// in its worst directions. NaN where nothing has energy.
struct StiffnessRange {
  double smallest = std::numeric_limits<double>::quiet_NaN(), largest = smallest;

  /// Of the direction that is farthest off.
  double deviation() const { return std::max(1 - smallest, largest - 1); }
  /// Whether no direction is 30 % off or more.
  bool is_sound() const { return deviation() < sound; }
  /// Whether a direction has less than a tenth of its stiffness left: loads along it displace more than ten times too far.
  bool is_weak() const { return smallest < weak; }
  /// Whether one has less than a hundredth left, none or a negative stiffness: nothing that the model answers holds.
  bool is_singular() const { return smallest < singular; }
  /// How many components would make it sound where so many do not: deviations of fits to all components fall a little
  /// faster than 1 / s (docs/decisions).
  Index points_for_sound(Index points) const {
    return static_cast<Index>(std::ceil(deviation() / sound * static_cast<double>(points)));
  }

 private:
  static constexpr double sound = 0.3, weak = 0.1, singular = 0.01;
};

/// \param stiffness  K̃, d × d. \param exact  modes of K̄.
StiffnessRange stiffness_range(const Matrix& stiffness, const ReducedModes& exact);

}  // namespace supple
