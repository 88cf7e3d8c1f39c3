#pragma once
/// \file State of a moving object, and the report of a step.

#include <core/types.hpp>
#include <numerics/optimize/objective.hpp>

namespace supple {

/// Displacements u [m], velocities v [m/s], accelerations a [m/s²] of the unknowns at one time [s].
struct State {
  Vector u, v, a;
  double time = 0;

  static State at_rest(Index dim) { return {Vector::Zero(dim), Vector::Zero(dim), Vector::Zero(dim), 0}; }
};

/// What a step took: a SolveReport of its nonlinear solve.
using StepReport = SolveReport;

}  // namespace supple
