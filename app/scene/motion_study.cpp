#include <app/scene/comparison.hpp>
#include <app/scene/motion_study.hpp>
#include <core/median.hpp>

#include <limits>

namespace supple {

namespace {

constexpr double enough = 0.2;  // seconds of steps to time a model by
constexpr int most_runs = 10;

void add_seconds(const Simulation& run, std::vector<double>& seconds) {
  for (std::size_t k = 1; k < run.steps.size(); ++k)
    if (run.steps[k].status != Status::NotFinite) seconds.push_back(run.steps[k].seconds);
}

}  // namespace

void MotionStudy::run_full(const ReducedModel& model, const Progress& progress) {
  const SimulationOptions options = for_full_system(options_);
  const Simulation run = simulate_full(model.body, scene_, options, progress);
  if (!run.complete()) throw SolverError("the full object: " + reason_to_end(run, options));
  std::vector<double> seconds;
  add_seconds(run, seconds);
  full_step_seconds_ = median(std::move(seconds));
  reference_ = trajectory_of(run, options, /*reduced=*/false);
}

MotionMeasure MotionStudy::measure(const ReducedModel& model, std::optional<double> tolerance,
                                   const Progress& progress) const {
  Scene scene = scene_;
  SimulationOptions options = complete(scene, model);
  if (tolerance) options.steps.tolerance = *tolerance;
  Simulation run = simulate_reduced(model, scene, options, progress);
  MotionMeasure measure{.step_seconds = 0,
                        .mean_iterations = run.effort.mean_iterations(),
                        .missed_steps = run.effort.missed,
                        .complete = run.complete(),
                        .trajectory_error = std::numeric_limits<double>::quiet_NaN()};
  if (reference_ && run.complete()) {
    std::vector<std::pair<Index, Index>> frames;
    for (Index f = 0; f < reference_->num_frames(); ++f) frames.emplace_back(f, f);
    const Trajectory trajectory = trajectory_of(run, options, /*reduced=*/true);
    measure.trajectory_error = compare({trajectory, model}, {*reference_, model}, frames, progress).position.relative();
  }
  std::vector<double> seconds;
  add_seconds(run, seconds);
  double spent = run.effort.seconds;
  for (int runs = 1; runs < most_runs && spent < enough && run.complete(); ++runs) {
    run = simulate_reduced(model, scene, options, progress);
    add_seconds(run, seconds);
    spent += run.effort.seconds;
  }
  measure.step_seconds = median(std::move(seconds));
  return measure;
}

}  // namespace supple
