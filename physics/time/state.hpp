#pragma once
/// \file State of a moving object, and the report of a step.

#include <core/types.hpp>
#include <numerics/optimize/objective.hpp>

#include <optional>

namespace supple {

/// Displacements u [m], velocities v [m/s], accelerations a [m/s²] of the unknowns at one time [s].
struct State {
  /// Displacements, velocities and time where the last step started.
  struct Before {
    Vector u, v;
    double time = 0;
  };

  Vector u, v, a;
  double time = 0;
  std::optional<Before> before = {};  ///< for Bdf2; empty at the start of a trajectory, and after setting u by hand

  static State at_rest(Index dim) { return {Vector::Zero(dim), Vector::Zero(dim), Vector::Zero(dim)}; }
};

/// What a step took: a SolveReport of its nonlinear solve.
using StepReport = SolveReport;

}  // namespace supple
