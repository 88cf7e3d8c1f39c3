#pragma once
/// \file Simulation of a scene, and what is recorded on the way.

#include <app/scene/scene.hpp>
#include <app/scene/trajectory.hpp>
#include <core/progress.hpp>
#include <physics/time/energy_account.hpp>
#include <physics/time/implicit_step.hpp>
#include <physics/time/step_control.hpp>
#include <reduction/model/reduced_model.hpp>

#include <vector>

namespace supple {

struct SimulationOptions {
  double step = 0;  ///< [s]
  Index num_steps = 0;
  Index every = 1;                            ///< a frame after so many steps
  Choice integrator{"average-vector-field"};  ///< one of integrators()
  StepOptions steps;
  StepControl control;
  RowPrecision precision = RowPrecision::Double;  ///< of a reduced system
};

/// Decides what a scene leaves open: duration, step and tracked node as in pluck_scene(), the rest as for a reduced system.
/// \throws InputError for a duration or a step that is not positive, and for too many steps.
SimulationOptions complete(Scene& scene, const ReducedModel& model);
/// The same for the full system: solvers of reduced ones give way to WarpedBfgs.
SimulationOptions for_full_system(SimulationOptions options);

/// The state after a step, and what the step took.
struct StepRecord {
  double time = 0;  ///< [s]
  EnergyBalance energy;
  Index iterations = 0, refreshes = 0;
  double residual = 0;  ///< relative, see StepOptions::tolerance
  double seconds = 0;   ///< wall-clock time of the step alone [s]
  Status status = Status::Converged;
};

/// What a MotionErrorEstimator says of the state after a step.
struct ErrorRecord {
  double time = 0;                         ///< [s]
  double fit = 0, outside = 0, total = 0;  ///< estimated distances from the full object, rms over its mass [m]
  double size = 0;                         ///< displacement, rms over its mass [m]
  bool beyond_training = false;            ///< larger than what forces were fitted to
};

/// Why a motion ends.
enum class Ending {
  Complete,
  NotFinite,          ///< the next step would not be
  EnergyFromNothing,  ///< it would have twice the energy that start and loads can have given
};
std::string_view to_string(Ending ending);  ///< "complete", "not-finite", "energy-from-nothing"

struct Simulation {
  Index unknowns = 0;
  std::vector<StepRecord> steps;  ///< the first is the start; where it ends early, the last repeats the one before
  Ending ending = Ending::Complete;
  EnergyBalance refused;      ///< energies of the step that was not taken, where it would have had too much
  RowMatrix tracked;          ///< one row a step: displacements of the scene's tracked nodes [m]
  std::vector<double> times;  ///< of the frames [s]
  /// Frames × coordinates: reduced coordinates, or displacements [m] and velocities [m/s] of all nodes.
  RowMatrix u, v;
  std::vector<ErrorRecord> errors;  ///< of a reduced model that has an indicator, every fourth step
  double setup_seconds = 0;         ///< system, loads, first factorisation
  double integration_seconds = 0;   ///< the steps alone
  double estimate_seconds = 0;      ///< the estimates of the error alone

  Index halved_steps = 0;  ///< steps that were taken in parts

  Index num_steps() const { return static_cast<Index>(steps.size()) - 1; }
  bool complete() const { return ending == Ending::Complete; }
  const StepRecord& last_good() const { return steps[steps.size() - (complete() ? 1 : 2)]; }
};

/// What ended it, with the step and what may help. \pre it is not complete.
std::string reason_to_end(const Simulation& run, const SimulationOptions& options);

/// What the steps took, all together.
struct Effort {
  double mean_iterations = 0, worst_residual = 0, steps_per_second = 0;
  Index most_iterations = 0, refreshes = 0, missed = 0;
  /// The most energy that the integrator had made, and the most it had taken, at any time, over the turnover of the run.
  double energy_made = 0, energy_taken = 0;

  explicit Effort(const Simulation& run);
  bool makes_energy() const { return energy_made > tolerated; }

  static constexpr double tolerated = 0.01;  ///< what may be made without a warning
};

/// Error of a motion by its estimates.
struct IndicatedError {
  double relative = 0;        ///< rms of the estimates over rms of the displacements
  double worst = 0;           ///< largest estimate over the largest displacement
  double worst_time = 0;      ///< [s]
  Index beyond_training = 0;  ///< estimates that were for states larger than what forces were fitted to
  double first_beyond = 0;    ///< time of the first of these [s]

  /// \param errors  at least one.
  explicit IndicatedError(const std::vector<ErrorRecord>& errors);
};

/// Its frames, of no model in a file yet. \param reduced  whether they are reduced coordinates.
Trajectory trajectory_of(const Simulation& run, const SimulationOptions& options, bool reduced);

/// From rest at t = 0. \throws SolverError if the system has no stable rest state.
Simulation simulate_reduced(const ReducedModel& model, const Scene& scene, const SimulationOptions& options,
                            const Progress& progress);
Simulation simulate_full(const Body& body, const Scene& scene, const SimulationOptions& options,
                         const Progress& progress);

}  // namespace supple
