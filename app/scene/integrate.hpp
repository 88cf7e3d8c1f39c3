#pragma once
/// \file The loop over time steps, for any system.

#include <app/scene/simulation.hpp>
#include <core/stopwatch.hpp>

namespace supple {

/// A scene's loads in the unknowns of a system. Everything is projected once; what changes over time is the
/// sum.
template <DynamicalSystem System>
class SceneLoads {
  using Load = AffineLoad<typename System::MatrixType>;

 public:
  SceneLoads(const System& system, const Scene& scene) : scene_(scene), load_{Vector::Zero(system.dim()), {}} {
    for (const TimedLoads& timed : scene.loads) columns_.push_back(system.project(timed.loads).force);
    for (const TimedSprings& timed : scene.springs) {
      Loads loads;
      for (const auto& [node, stiffness] : timed.springs) loads.springs.push_back({node, stiffness, Point::Zero()});
      for (int x = 0; x < 3; ++x) {
        for (PointSpring& spring : loads.springs) spring.displacement = Point::Unit(x);
        Load unit = system.project(loads);
        columns_.push_back(std::move(unit.force));
        if (x == 0) stiffness_.push_back(std::move(unit.stiffness));
      }
    }
    active_.resize(scene.springs.size());
  }

  const Load& at(double t) {
    std::vector<double> shares;
    shares.reserve(columns_.size());
    for (const TimedLoads& timed : scene_.loads) shares.push_back(timed.when.share(t));
    std::vector<bool> active;
    for (const TimedSprings& timed : scene_.springs) {
      active.push_back(timed.when.contains(t));
      const Point displacement = timed.when.share(t) * timed.displacement(t);
      shares.insert(shares.end(), displacement.begin(), displacement.end());
    }
    if (shares != shares_) {
      load_.force.setZero();
      for (std::size_t k = 0; k < columns_.size(); ++k)
        if (shares[k] != 0) load_.force += shares[k] * columns_[k];
      shares_ = std::move(shares);
    }
    if (active != active_) {
      load_.stiffness = {};
      for (std::size_t k = 0; k < active.size(); ++k)
        if (active[k] && stiffness_[k].size() > 0) {
          if (load_.stiffness.size() == 0)
            load_.stiffness = stiffness_[k];
          else
            load_.stiffness += stiffness_[k];
        }
      active_ = std::move(active);
    }
    return load_;
  }

 private:
  const Scene& scene_;
  std::vector<Vector> columns_;  // of each load, then three of each group of springs: at unit displacements
  std::vector<typename System::MatrixType> stiffness_;  // of each group of springs
  std::vector<double> shares_;
  std::vector<bool> active_;
  Load load_;
};

/// \param frame  unknowns → the coordinates that frames keep.
/// \param displacement  (unknowns, node) → displacement of a node [m].
template <DynamicalSystem System, typename Frame, typename Displacement>
Simulation integrate(const System& system, const Scene& scene, const SimulationOptions& options, const Frame& frame,
                     const Displacement& displacement, const Progress& progress) {
  Simulation result;
  result.unknowns = system.dim();
  const Index num_frames = options.num_steps / options.every + 1;
  result.tracked.resize(options.num_steps + 1, 3 * static_cast<Index>(scene.track.size()));
  result.steps.reserve(options.num_steps + 1);

  Stopwatch setup;
  SceneLoads loads(system, scene);
  Newmark newmark(system, options.step, options.newmark);
  State state = State::at_rest(system.dim());
  newmark.balance(loads.at(0), state);
  const auto external_force = [&](const auto& load) -> Vector {
    return load.has_stiffness() ? Vector(load.force - load.stiffness * state.u) : load.force;
  };
  Vector external = external_force(loads.at(0));
  result.setup_seconds = setup.seconds();

  const auto record = [&](const StepReport& report, double work) {
    const Index k = static_cast<Index>(result.steps.size());
    result.steps.push_back({static_cast<double>(k) * options.step, newmark.kinetic_energy(state),
                            system.energy(state.u), work, report.iterations, report.refreshes, report.residual,
                            report.status});
    for (std::size_t j = 0; j < scene.track.size(); ++j)
      result.tracked.template block<1, 3>(k, 3 * j) = displacement(state.u, scene.track[j]).transpose();
    if (k % options.every != 0) return;
    const Vector u = frame(state.u), v = frame(state.v);
    const Index f = static_cast<Index>(result.times.size());
    if (f == 0) {
      result.u.resize(num_frames, u.size());
      result.v.resize(num_frames, v.size());
    }
    result.u.row(f) = u.transpose();
    result.v.row(f) = v.transpose();
    result.times.push_back(result.steps.back().time);
  };
  StepReport start;
  start.status = Status::Converged;
  start.residual = 0;
  record(start, 0);
  for (Index k = 1; k <= options.num_steps; ++k) {
    const Vector u_before = state.u;
    Stopwatch watch;
    const auto& load = loads.at(static_cast<double>(k) * options.step);
    const StepReport report = newmark.step(load, state);
    result.integration_seconds += watch.seconds();
    const bool finite = report.status != Status::NotFinite && state.u.allFinite() && state.v.allFinite();
    if (!finite) {
      result.steps.push_back(result.steps.back());
      result.steps.back().status = Status::NotFinite;
      result.steps.back().residual = report.residual;
      break;
    }
    const Vector now = external_force(load);
    record(report, result.steps.back().work + 0.5 * (external + now).dot(state.u - u_before));
    external = now;
    tell(progress, "time steps", static_cast<double>(k) / static_cast<double>(options.num_steps));
  }
  const Index frames = static_cast<Index>(result.times.size());
  result.u.conservativeResize(frames, Eigen::NoChange);
  result.v.conservativeResize(frames, Eigen::NoChange);
  result.tracked.conservativeResize(static_cast<Index>(result.steps.size()), Eigen::NoChange);
  if (!result.finite()) result.tracked.bottomRows(1) = result.tracked.row(result.tracked.rows() - 2).eval();
  return result;
}

}  // namespace supple
