#pragma once
/// \file Simulation of a scene, and what is recorded on the way.

#include <app/scene/scene.hpp>
#include <app/scene/trajectory.hpp>
#include <core/progress.hpp>
#include <physics/time/energy_account.hpp>
#include <physics/time/implicit_step.hpp>
#include <physics/time/step_control.hpp>
#include <reduction/model/reduced_model.hpp>

#include <cmath>
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

/// What the steps of a run took, all together.
struct Effort {
  Index steps = 0, iterations = 0, most_iterations = 0, refreshes = 0, missed = 0;
  double seconds = 0;         ///< wall-clock time of the steps alone
  double worst_residual = 0;  ///< of those that are finite

  void add(const StepRecord& step);

  double mean_iterations() const {
    return steps > 0 ? static_cast<double>(iterations) / static_cast<double>(steps) : 0;
  }
  double steps_per_second() const { return seconds > 0 ? static_cast<double>(steps) / seconds : 0; }
  /// The most energy that the integrator had made, and the most it had taken, at any time, over the turnover of the run.
  double energy_made() const { return turnover_ > 0 ? most_made_ / turnover_ : 0; }
  double energy_taken() const { return turnover_ > 0 ? most_taken_ / turnover_ : 0; }
  bool makes_energy() const { return energy_made() > tolerated; }

  static constexpr double tolerated = 0.01;  ///< what may be made without a warning

 private:
  double most_made_ = 0, most_taken_ = 0, turnover_ = 0;  // [J]
};

/// Error of a motion by its estimates.
struct IndicatedError {
  Index estimates = 0;
  double worst_time = 0;      ///< [s]
  Index beyond_training = 0;  ///< estimates that were for states larger than what forces were fitted to
  double first_beyond = 0;    ///< time of the first of these [s]

  void add(const ErrorRecord& error);

  /// Rms of the estimates over rms of the displacements; 0 where nothing moved.
  double relative() const { return largest_ > 0 ? std::sqrt(squares_ / sizes_) : 0; }
  /// Largest estimate over the largest displacement.
  double worst() const { return largest_ > 0 ? worst_ / largest_ : 0; }

 private:
  double squares_ = 0, sizes_ = 0, largest_ = 0, worst_ = 0;
};

/// A run, in memory that does not grow with the number of its steps: records of every step, or, where there are more than
/// most_records steps, of every `stride`-th, which is enough for tables and plots. Sums and extremes count all steps.
struct Simulation {
  static constexpr Index most_records = 100'000;

  Index unknowns = 0;
  Index num_steps = 0;            ///< that were taken, the one that ended the run included
  Index stride = 1;               ///< steps from record to record
  std::vector<StepRecord> steps;  ///< the first is the start; where it ends early, the last repeats the last good one
  RowMatrix tracked;              ///< one row a record: displacements of the scene's tracked nodes [m]
  Vector reach;                   ///< largest displacement of each tracked node [m]
  Effort effort;
  Ending ending = Ending::Complete;
  EnergyBalance refused;                ///< energies of the step that was not taken, where it would have had too much
  StepRecord last_good;                 ///< the last step that was taken
  std::vector<double> times;            ///< of the frames [s]
  std::vector<EnergyBalance> energies;  ///< of the frames
  /// Frames × coordinates: reduced coordinates, or displacements [m] and velocities [m/s] of all nodes.
  RowMatrix u, v;
  std::vector<ErrorRecord> errors;  ///< of a reduced model that has an indicator, every fourth step, or stride of these
  IndicatedError indicated;
  double setup_seconds = 0;     ///< system, loads, first factorisation
  double estimate_seconds = 0;  ///< the estimates of the error alone

  Index halved_steps = 0;   ///< steps that were taken in parts
  Index rescued_parts = 0;  ///< of these parts, those that backward Euler took, for the integrator had failed

  bool complete() const { return ending == Ending::Complete; }
};

/// What ended it, with the step and what may help. \pre it is not complete.
std::string reason_to_end(const Simulation& run, const SimulationOptions& options);

/// Its frames, of no model in a file yet. \param reduced  whether they are reduced coordinates.
Trajectory trajectory_of(const Simulation& run, const SimulationOptions& options, bool reduced);

/// From rest at t = 0, or from the equilibrium under the loads then. \throws SolverError if the system has no stable rest
/// state, or no such equilibrium is found.
Simulation simulate_reduced(const ReducedModel& model, const Scene& scene, const SimulationOptions& options,
                            const Progress& progress);
Simulation simulate_full(const Body& body, const Scene& scene, const SimulationOptions& options,
                         const Progress& progress);

}  // namespace supple
