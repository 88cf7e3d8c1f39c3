#include <app/report/terminal.hpp>
#include <app/scene/simulation.hpp>
#include <app/scene/statics.hpp>
#include <core/stopwatch.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <physics/body/body_system.hpp>
#include <physics/statics/static_solver.hpp>
#include <physics/time/integrator_library.hpp>
#include <reduction/system/error_estimator.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

namespace supple {

namespace {

/// A scene's loads in the unknowns of a system. Loads are projected once, springs when others of them begin to act; what
/// else changes over time is how much of each there is, and where springs pull to.
template <typename MatrixType>
class SceneLoads {
  using Load = SystemLoad<MatrixType>;

 public:
  /// \param system, scene  must outlive the loads.
  SceneLoads(const AnySystem<MatrixType>& system, const Scene& scene)
      : system_(system), scene_(scene), active_(scene.springs.size() + scene.others.size()) {
    load_.force.setZero(system.dim());
    for (const TimedLoads& timed : scene.loads) columns_.push_back(system.project(timed.loads).force);
    for (const TimedForce& timed : scene.others) {
      Loads loads;
      loads.others.push_back(timed.force);
      others_.push_back(system.project(loads).others.front());
    }
  }

  const Load& at(double t) {
    std::vector<double> shares, targets;
    std::vector<bool> active;
    for (const TimedLoads& timed : scene_.loads) shares.push_back(timed.when.share(t));
    for (const TimedSprings& timed : scene_.springs) {
      active.push_back(timed.when.contains(t));
      if (!active.back()) continue;
      const Point displacement = timed.when.share(t) * timed.displacement(t);
      for (std::size_t k = 0; k < timed.springs.size(); ++k)
        targets.insert(targets.end(), displacement.begin(), displacement.end());
    }
    for (const TimedForce& timed : scene_.others) active.push_back(timed.when.contains(t));
    if (active == active_ && shares == shares_ && targets == targets_) return load_;
    if (active != active_) take_hold(active);
    load_.force.setZero();
    for (std::size_t k = 0; k < columns_.size(); ++k)
      if (shares[k] != 0) load_.force += shares[k] * columns_[k];
    if (!load_.springs.empty()) {
      load_.springs.targets = Eigen::Map<const Vector>(targets.data(), static_cast<Index>(targets.size()));
      load_.force += load_.springs.pull_of_targets();
    }
    active_ = std::move(active);
    shares_ = std::move(shares);
    targets_ = std::move(targets);
    return load_;
  }

 private:
  /// Springs and other forces that act, wherever springs pull to.
  void take_hold(const std::vector<bool>& active) {
    Loads loads;
    for (std::size_t k = 0; k < scene_.springs.size(); ++k)
      if (active[k])
        for (const auto& [node, stiffness] : scene_.springs[k].springs)
          loads.springs.push_back({node, stiffness, Point::Zero()});
    load_ = system_.project(loads);
    for (std::size_t k = 0; k < others_.size(); ++k)
      if (active[scene_.springs.size() + k]) load_.others.push_back(others_[k]);  // themselves, as solvers know them
  }

  const AnySystem<MatrixType>& system_;
  const Scene& scene_;
  std::vector<Vector> columns_;  // of each load
  std::vector<std::shared_ptr<const OutsideTerm<MatrixType>>> others_;
  std::vector<bool> active_;              // of springs, then of others
  std::vector<double> shares_, targets_;  // of each load; of the springs that act [m]
  Load load_;
};

/// Of a state at the end of a step; of an equilibrium to start from, at time 0, before.
using Estimate = std::function<ErrorRecord(double time, VectorIn u)>;
constexpr Index estimate_every = MotionErrorEstimator::every;

/// \param frame  unknowns → the coordinates that frames keep. \param estimate  of the error, or null.
template <typename MatrixType, typename Frame>
Simulation integrate(const AnySystem<MatrixType>& system, const Scene& scene, const SimulationOptions& options,
                     const Frame& frame, const Estimate& estimate, const Progress& progress) {
  Simulation result;
  result.unknowns = system.dim();
  result.stride = (options.num_steps - 1) / Simulation::most_records + 1;
  const Index num_frames = options.num_steps / options.every + 1;
  const Index num_records = (options.num_steps - 1) / result.stride + 2;
  const Index num_tracked = static_cast<Index>(scene.track.size());
  result.tracked.resize(num_records, 3 * num_tracked);
  result.reach.setZero(num_tracked);
  result.steps.reserve(num_records);

  Stopwatch setup;
  SceneLoads loads(system, scene);
  auto integrator =
      make_controlled_integrator(options.integrator, system, options.step, options.steps, options.control);
  State state = integrator.at_rest();
  if (scene.starts_in_equilibrium) {
    StaticSolver<AnySystem<MatrixType>> settle(system, {.tolerance = 1e-10});
    const SolveReport report = settle.solve(loads.at(0), state.u);
    if (!is_equilibrium(report))
      throw SolverError("no equilibrium under the loads at t = 0 to start from (" +
                        std::string(to_string(report.status)) + "): is the object held, or is there one?");
    if (estimate) (void)estimate(0, state.u);
  }
  integrator.balance(loads.at(0), state);
  result.setup_seconds = setup.seconds();

  const auto record = [&](Index k, const StepRecord& step) {
    result.last_good = step;
    Vector displacements(3 * num_tracked);
    for (Index j = 0; j < num_tracked; ++j) {
      displacements.segment<3>(3 * j) = system.displacement(state.u, scene.track[j]);
      result.reach[j] = std::max(result.reach[j], displacements.segment<3>(3 * j).norm());
    }
    if (k % result.stride == 0 || k == options.num_steps) {
      result.tracked.row(static_cast<Index>(result.steps.size())) = displacements.transpose();
      result.steps.push_back(step);
    }
    if (k % options.every != 0) return;
    const Vector u = frame(state.u), v = frame(state.v);
    const Index f = static_cast<Index>(result.times.size());
    if (f == 0) {
      result.u.resize(num_frames, u.size());
      result.v.resize(num_frames, v.size());
    }
    result.u.row(f) = u.transpose();
    result.v.row(f) = v.transpose();
    result.times.push_back(step.time);
    result.energies.push_back(step.energy);
  };
  // a load at the end of step k, whatever rounding has made of the state's time
  const auto during = [&](Index k) {
    return [&loads, end = static_cast<double>(k) * options.step, h = options.step ](double t) -> const auto& {
      return loads.at(std::abs(t - end) <= 1e-9 * h ? end : t);
    };
  };
  record(0, {.energy = EnergyAccount<AnySystem<MatrixType>>(system, options.steps.damping, state).now()});
  for (Index k = 1; k <= options.num_steps; ++k) {
    Stopwatch watch;
    const StepReport report = integrator.step(during(k), state);
    state.time = static_cast<double>(k) * options.step;  // rounding does not add up
    StepRecord step{.time = state.time,
                    .energy = integrator.energies(),
                    .iterations = report.iterations,
                    .refreshes = report.tangents,
                    .residual = report.residual,
                    .seconds = watch.seconds(),
                    .status = report.status};
    if (report.status == Status::NotFinite)
      result.ending = Ending::NotFinite;
    else if (step.energy.made_share() > 1)
      result.ending = Ending::EnergyFromNothing;
    result.num_steps = k;
    if (!result.complete()) {
      result.refused = step.energy;
      step.time = result.last_good.time;
      step.energy = result.last_good.energy;
    }
    result.effort.add(step);
    if (!result.complete()) {
      const Index last = static_cast<Index>(result.steps.size());
      result.tracked.row(last) = result.tracked.row(last - 1).eval();
      result.steps.push_back(step);
      break;
    }
    record(k, step);
    if (estimate && (k % estimate_every == 0 || k == options.num_steps)) {
      watch.restart();
      const ErrorRecord error = estimate(state.time, state.u);
      result.indicated.add(error);
      if ((k / estimate_every) % result.stride == 0 || k == options.num_steps) result.errors.push_back(error);
      result.estimate_seconds += watch.seconds();
    }
    tell(progress, "time steps", static_cast<double>(k) / static_cast<double>(options.num_steps));
  }
  result.halved_steps = integrator.halved_steps();
  result.rescued_parts = integrator.rescued_parts();
  const Index frames = static_cast<Index>(result.times.size());
  result.u.conservativeResize(frames, Eigen::NoChange);
  result.v.conservativeResize(frames, Eigen::NoChange);
  result.tracked.conservativeResize(static_cast<Index>(result.steps.size()), Eigen::NoChange);
  return result;
}

/// How long the loads of a scene, all at once, take to carry the whole object by its own diagonal from rest [s]; springs and
/// other forces do not count.
double time_across(const Scene& scene, const Body& body) {
  const Vector mass = nodal_mass(body);
  double acceleration = 0;
  for (const TimedLoads& timed : scene.loads) {
    Point force = mass.sum() * timed.loads.gravity;
    for (const NodalForce& load : timed.loads.forces) force += load.force;
    acceleration += force.norm() / mass.sum();
  }
  return std::sqrt(2 * bounding_box(node_positions(body)).diagonal() / acceleration);  // infinite without loads
}

}  // namespace

SimulationOptions complete(Scene& scene, const ReducedModel& model) {
  if (!scene.duration || !scene.step || scene.track.empty()) {
    const Scene pluck = pluck_scene(model);
    if (!scene.duration) scene.duration = pluck.duration;
    if (!scene.step) scene.step = std::min({*pluck.step, time_across(scene, model.body) / 60, *scene.duration});
    if (scene.track.empty()) scene.track = pluck.track;
  }
  if (!(*scene.duration > 0)) throw InputError("the duration is " + shown(*scene.duration) + " s, expected > 0");
  if (!(*scene.step > 0)) throw InputError("the step is " + shown(*scene.step) + " s, expected > 0");
  if (*scene.step > *scene.duration * (1 + 1e-6))
    throw InputError("the step is " + shown(*scene.step) + " s, longer than the duration of " + shown(*scene.duration) +
                     " s");
  const double steps = std::max(1.0, std::ceil(*scene.duration / *scene.step - 1e-6));
  if (steps > 1e8) throw InputError(shown(steps) + " steps are more than the 1e8 that a run may have");

  SimulationOptions options;
  options.step = *scene.step;
  options.num_steps = static_cast<Index>(steps);
  options.every = scene.every.value_or((options.num_steps + 99) / 100);
  if (scene.integrator) options.integrator = *scene.integrator;
  (void)energy_behaviour(options.integrator);  // or it is refused
  options.steps.damping = scene.damping.value_or(damping(model.body));
  options.steps.solver = scene.solver.value_or(Bfgs{});
  if (!is_step_solver_for(false, options.steps.solver)) options.steps.solver = Bfgs{};
  if (scene.tolerance) options.steps.tolerance = *scene.tolerance;
  if (scene.max_iterations) options.steps.max_iterations = *scene.max_iterations;
  if (scene.max_halvings) options.control.max_halvings = static_cast<int>(*scene.max_halvings);
  options.precision = default_precision(model);
  return options;
}

SimulationOptions for_full_system(SimulationOptions options) {
  if (!is_step_solver_for(true, options.steps.solver)) options.steps.solver = WarpedBfgs{};
  options.precision = RowPrecision::Double;
  return options;
}

std::string_view to_string(Ending ending) {
  switch (ending) {
    case Ending::Complete:
      return "complete";
    case Ending::NotFinite:
      return "not-finite";
    case Ending::EnergyFromNothing:
      return "energy-from-nothing";
  }
  return "";
}

std::string reason_to_end(const Simulation& run, const SimulationOptions& options) {
  const std::string step = "step " + std::to_string(run.num_steps) +
                           " (t = " + shown(static_cast<double>(run.num_steps) * options.step) + " s) ";
  if (run.ending == Ending::NotFinite) return step + "is not finite. A shorter --step or --solver newton may help";
  return step + "has " + shown(run.refused.kinetic + run.refused.elastic) + " J where loads have done " +
         shown(run.refused.work) + " J of work: energy from nothing, which " + options.integrator.name +
         " makes in such large motions. A shorter --step, --integrator average-vector-field, which keeps the energy, "
         "or "
         "backward-euler, which damps most, may help";
}

void Effort::add(const StepRecord& step) {
  ++steps;
  iterations += step.iterations;
  most_iterations = std::max(most_iterations, step.iterations);
  refreshes += step.refreshes;
  missed += step.status != Status::Converged;
  seconds += step.seconds;
  if (std::isfinite(step.residual)) worst_residual = std::max(worst_residual, step.residual);
  most_made_ = std::max(most_made_, step.energy.made());
  most_taken_ = std::max(most_taken_, -step.energy.made());
  turnover_ = std::max(turnover_, step.energy.turnover);
}

void IndicatedError::add(const ErrorRecord& error) {
  ++estimates;
  squares_ += error.total * error.total;
  sizes_ += error.size * error.size;
  largest_ = std::max(largest_, error.size);
  if (error.total > worst_) {
    worst_ = error.total;
    worst_time = error.time;
  }
  if (error.beyond_training && beyond_training++ == 0) first_beyond = error.time;
}

Trajectory trajectory_of(const Simulation& run, const SimulationOptions& options, bool reduced) {
  Trajectory trajectory{.reduced = reduced,
                        .model = {},
                        .model_checksum = {},
                        .step = options.step,
                        .steps_per_second = run.effort.steps_per_second(),
                        .time = Eigen::Map<const Vector>(run.times.data(), static_cast<Index>(run.times.size())),
                        .kinetic = {},
                        .elastic = {},
                        .work = {},
                        .u = run.u,
                        .v = run.v};
  for (Vector* values : {&trajectory.kinetic, &trajectory.elastic, &trajectory.work})
    values->resize(trajectory.num_frames());
  for (Index f = 0; f < trajectory.num_frames(); ++f) {
    trajectory.kinetic[f] = run.energies[f].kinetic;
    trajectory.elastic[f] = run.energies[f].elastic;
    trajectory.work[f] = run.energies[f].work;
  }
  return trajectory;
}

Simulation simulate_reduced(const ReducedModel& model, const Scene& scene, const SimulationOptions& options,
                            const Progress& progress) {
  const Stopwatch watch;
  const AnySystem<Matrix> system = model.system(options.precision);
  Estimate estimate;
  if (const std::optional<ErrorEstimator> states = error_estimator(model))
    estimate = [&system, estimator = MotionErrorEstimator(*states, options.steps.damping),
                root_mass = std::sqrt(nodal_mass(model.body).sum())](double time, VectorIn q) mutable {
      if (time == 0) {
        estimator.start_from(q, system.force(q));
        return ErrorRecord{};
      }
      const ErrorEstimate error = estimator.advance(time, q, system.force(q));
      return ErrorRecord{.time = time,
                         .fit = error.fit / root_mass,
                         .outside = error.outside / root_mass,
                         .total = error.total() / root_mass,
                         .size = q.norm() / root_mass,
                         .beyond_training = error.beyond_training};
    };
  const double construction = watch.seconds();
  Simulation result = integrate(
      system, scene, options, [](VectorIn q) -> Vector { return q; }, estimate, progress);
  result.setup_seconds += construction;
  return result;
}

Simulation simulate_full(const Body& body, const Scene& scene, const SimulationOptions& options,
                         const Progress& progress) {
  const Stopwatch watch;
  tell(progress, "full system", 0);
  const AnySystem<SparseMatrix> system = full_system(body);
  const double construction = watch.seconds();
  Simulation result = integrate(
      system, scene, options, [&](VectorIn u) { return system.expand(u); }, nullptr, progress);
  result.setup_seconds += construction;
  return result;
}

}  // namespace supple
