#pragma once
/// \file One scene for many models of an object: the time of a step, and the error of the motion.

#include <app/scene/simulation.hpp>

#include <limits>
#include <optional>

namespace supple {

/// What a model makes of the scene.
struct MotionMeasure {
  double step_seconds = 0;     ///< of a step, median [s]
  double mean_iterations = 0;  ///< of a step
  Index missed_steps = 0;      ///< those that did not reach the tolerance
  bool complete = true;        ///< whether the motion runs to its end
  /// Of positions against the full object, see Deviation::relative(); NaN if that was not run, or the motion is not complete.
  double trajectory_error = 0;
};

/// A scene that models of one object run alike, and the motion of the full object to compare with.
class MotionStudy {
 public:
  /// \param scene  what it leaves open is decided as for `model`, see complete().
  MotionStudy(Scene scene, const ReducedModel& model) : scene_(std::move(scene)), options_(complete(scene_, model)) {}

  /// Runs the full object, which takes as long as it takes. \throws SolverError if that motion is not complete.
  void run_full(const ReducedModel& model, const Progress& progress);
  /// \param tolerance  of a step, instead of the scene's.
  MotionMeasure measure(const ReducedModel& model, std::optional<double> tolerance, const Progress& progress) const;

  const Scene& scene() const { return scene_; }
  const SimulationOptions& options() const { return options_; }
  double full_step_seconds() const { return full_step_seconds_; }  ///< median [s]; NaN if it was not run

 private:
  Scene scene_;
  SimulationOptions options_;
  std::optional<Trajectory> reference_;
  double full_step_seconds_ = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace supple
