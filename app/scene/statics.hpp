#pragma once
/// \file Static equilibrium of an object under loads, full or reduced.

#include <core/progress.hpp>
#include <numerics/optimize/warm_solver.hpp>
#include <physics/load/loads.hpp>
#include <reduction/model/reduced_model.hpp>

namespace supple {

struct StaticsOptions {
  NonlinearSolver solver = Newton{};
  double tolerance = 1e-9;    ///< residual against the forces of the object, see Equilibrium
  Index max_iterations = 50;  ///< of a load step
  Index steps = 1;            ///< in which the loads grow; those that fail are halved
};

struct Statics {
  Vector u;            ///< displacements of all nodes, 3n [m]
  double elastic = 0;  ///< [J]
  Index unknowns = 0, steps = 0, halved_steps = 0, iterations = 0;
  double residual = 0;  ///< of the last load step
  double seconds = 0;   ///< of the solver alone
};

/// Whether a state counts as an equilibrium: the solver converged, or rounding let it come no nearer than a residual that is good
/// enough, as that of stiff objects under small loads, whose forces are differences of large numbers.
bool is_equilibrium(const SolveReport& report);

/// The equilibrium of an object that rests without loads, on the way along which all loads grow together; floors and the
/// like act from the start. \throws SolverError if a load step fails however small; InputError if a motion of the object is
/// held by nothing.
Statics full_equilibrium(const Body& body, const Loads& loads, const StaticsOptions& options, const Progress& progress);
Statics reduced_equilibrium(const ReducedModel& model, const Loads& loads, const StaticsOptions& options,
                            const Progress& progress);

/// Rigid motions of an object, or of a part of it, that neither its supports nor springs hold, in words: "move along x, turn
/// about y"; empty if there are none.
std::string unheld_motions(const Body& body, const std::vector<PointSpring>& springs);

}  // namespace supple
