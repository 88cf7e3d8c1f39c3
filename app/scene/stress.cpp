#include <app/scene/coloured_picture.hpp>
#include <app/scene/stress.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

namespace supple {

namespace {

/// An object, its softest flexible mode and its ends along its longest axis.
struct Subject {
  Points nodes;
  Vector mass;
  double diagonal, period, omega;
  int axis = 0;
  double low, span;

  explicit Subject(const ReducedModel& model, double softest)
      : nodes(node_positions(model.body)),
        mass(nodal_mass(model.body)),
        diagonal(bounding_box(nodes).diagonal()),
        period(2 * std::numbers::pi / softest),
        omega(softest) {
    const Eigen::RowVector3d least = nodes.colwise().minCoeff();
    span = (nodes.colwise().maxCoeff() - least).maxCoeff(&axis);
    low = least[axis];
  }

  /// Nodes beyond a share of the longest axis: above it, or below.
  std::vector<Index> end(double share, bool above) const {
    std::vector<Index> result;
    for (Index i = 0; i < nodes.rows(); ++i)
      if ((nodes(i, axis) - low > share * span) == above) result.push_back(i);
    return result;
  }
  /// At most so many of them, spread evenly.
  static std::vector<Index> thinned(const std::vector<Index>& nodes, Index most) {
    std::vector<Index> result;
    const Index count = static_cast<Index>(nodes.size()), kept = std::min(count, most);
    for (Index k = 0; k < kept; ++k) result.push_back(nodes[k * count / kept]);
    return result;
  }
  /// An acceleration across the longest axis, of the half beyond its middle.
  Loads push(double acceleration) const {
    Loads loads;
    const Point direction = Point::Unit((axis + 1) % 3);
    for (const Index i : end(0.5, true)) loads.forces.push_back({i, mass[i] * acceleration * direction});
    return loads;
  }
  /// Springs, together a thousand times as stiff as the softest mode.
  TimedSprings grip(const std::vector<Index>& nodes_held) const {
    TimedSprings grip;
    const double stiffness = 1e3 * mass.sum() * omega * omega / static_cast<double>(nodes_held.size());
    for (const Index i : nodes_held) grip.springs.emplace_back(i, stiffness);
    grip.times = Vector::Zero(1);
    grip.displacements = Points::Zero(1, 3);
    return grip;
  }
  /// Both ends held, and the far one moved along the axis by a distance [m] within a period.
  std::vector<TimedSprings> press(double distance) const {
    TimedSprings near = grip(thinned(end(0.1, false), most_held)), far = grip(thinned(end(0.9, true), most_held));
    far.times = (Vector(2) << 0, period).finished();
    far.displacements.setZero(2, 3);
    far.displacements(1, axis) = -distance;
    return {near, far};
  }
  /// The far end turned about the axis so many times within three periods.
  std::vector<TimedSprings> wring(double turns) const {
    constexpr Index corners = 24;  // of a turn
    std::vector<TimedSprings> springs{grip(thinned(end(0.1, false), most_held))};
    const std::vector<Index> held = thinned(end(0.9, true), most_held);
    Point centre = Point::Zero();
    for (const Index i : held) centre += nodes.row(i).transpose() / static_cast<double>(held.size());
    const Index count = static_cast<Index>(turns * corners) + 1;
    for (const Index i : held) {
      TimedSprings one = grip({i});
      one.springs.front().second /= static_cast<double>(held.size());
      one.times = Vector::LinSpaced(count, 0, 3 * period);
      one.displacements.resize(count, 3);
      const Point arm = nodes.row(i).transpose() - centre;
      for (Index k = 0; k < count; ++k) {
        const Eigen::AngleAxisd turn(2 * std::numbers::pi * static_cast<double>(k) / corners, Point::Unit(axis));
        one.displacements.row(k) = (turn * arm - arm).transpose();
      }
      springs.push_back(std::move(one));
    }
    return springs;
  }

  static constexpr Index most_held = 16;
};

}  // namespace

std::vector<Hardship> hardships(const ReducedModel& model) {
  const Scene pluck = pluck_scene(model);
  const Subject subject(model, 2 * std::numbers::pi / (*pluck.duration / 3));
  const double T = subject.period, speed = subject.diagonal / T, acceleration = subject.diagonal / (T * T);
  Scene quiet;
  quiet.duration = 3 * T;
  quiet.track = pluck.track;
  quiet.damping = RayleighDamping{};

  std::vector<Scene> scenes;  // in the order of all_hardships
  for (const double factor : {1.0, 10.0, 100.0}) {
    Scene& scene = scenes.emplace_back(quiet);
    scene.loads = pluck.loads;
    for (TimedLoads& timed : scene.loads) {
      timed.loads.gravity *= factor;
      for (NodalForce& load : timed.loads.forces) load.force *= factor;
    }
  }
  scenes.emplace_back(quiet).springs = subject.press(subject.span);
  scenes.emplace_back(quiet).springs = subject.press(2 * subject.span);
  scenes.emplace_back(quiet).springs = subject.wring(6);
  scenes.emplace_back(quiet).loads = {{subject.push(100 * speed / T), {.from = 0, .until = T / 10}}};
  Scene& jumps = scenes.emplace_back(quiet);
  for (int k = 0; k < 12; ++k)
    jumps.loads.push_back(
        {subject.push((k % 2 == 0 ? 20 : -20) * acceleration), {.from = k * T / 4, .until = (k + 1) * T / 4}});

  std::vector<Hardship> all;
  for (std::size_t k = 0; k < all_hardships.size(); ++k) all.push_back({all_hardships[k], std::move(scenes[k])});
  return all;
}

std::string_view to_string(Verdict verdict) {
  switch (verdict) {
    case Verdict::Sound:
      return "sound";
    case Verdict::Warned:
      return "warned";
    case Verdict::Stopped:
      return "stopped";
  }
  return "";
}

Verdict StressRun::verdict() const {
  if (ending != Ending::Complete) return Verdict::Stopped;
  return missed > 0 || energy_made > Effort::tolerated ? Verdict::Warned : Verdict::Sound;
}

StressRun endure(const ReducedModel& model, const Hardship& hardship, const std::string& integrator,
                 double steps_per_period, bool full) {
  Scene scene = hardship.scene;
  scene.step = *scene.duration / 3 / steps_per_period;
  scene.integrator = Choice::parse(integrator);
  SimulationOptions options = complete(scene, model);
  if (full) options = for_full_system(options);
  const Simulation run =
      full ? simulate_full(model.body, scene, options, nullptr) : simulate_reduced(model, scene, options, nullptr);
  return {.hardship = std::string(hardship.info.name),
          .integrator = integrator,
          .steps_per_period = steps_per_period,
          .steps_asked = options.num_steps,
          .steps_done = run.num_steps - (run.complete() ? 0 : 1),
          .halved = run.halved_steps,
          .rescued = run.rescued_parts,
          .missed = run.effort.missed,
          .worst_residual = run.effort.worst_residual,
          .energy_made = run.effort.energy_made(),
          .energy_taken = run.effort.energy_taken(),
          .reach = run.reach[0] / bounding_box(node_positions(model.body)).diagonal(),
          .seconds = run.effort.seconds,
          .ending = run.ending};
}

}  // namespace supple
