#pragma once
/// \file Scene of what happens to an object: loads and springs over time, from a JSON file; see docs/scene.md.

#include <core/registry.hpp>
#include <core/types.hpp>
#include <numerics/optimize/warm_solver.hpp>
#include <physics/load/loads.hpp>
#include <physics/system/damping.hpp>
#include <reduction/model/reduced_model.hpp>

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// When something acts, both ends included, and how it sets in.
struct TimeSpan {
  double from = 0, until = std::numeric_limits<double>::infinity();  ///< [s]
  double ramp = 0;  ///< it grows linearly from nothing during this time [s]

  bool contains(double t) const;
  /// 0 outside, 1 inside when the ramp is over.
  double share(double t) const;
};

/// Loads in fixed proportions, times the share of their time span. No springs.
struct TimedLoads {
  Loads loads;
  TimeSpan when;
};

/// Springs that pull nodes along one common path.
struct TimedSprings {
  std::vector<std::pair<Index, double>> springs;  ///< node and stiffness [N/m]
  Vector times;                                   ///< of the path, ascending [s]
  Points displacements;                           ///< one for each time [m]; linear between, constant outside
  TimeSpan when;                                  ///< the ramp scales the displacement

  Point displacement(double t) const;
};

/// Another force from outside, while it acts.
struct TimedForce {
  AnyOutsideForce force;
  TimeSpan when;  ///< without ramp
};

struct Scene {
  std::optional<double> duration, step;  ///< [s]
  std::vector<TimedLoads> loads;
  std::vector<TimedSprings> springs;
  std::vector<TimedForce> others;
  bool starts_in_equilibrium = false;  ///< under the loads at t = 0, instead of at rest without them
  std::optional<RayleighDamping> damping;
  std::optional<Choice> integrator;  ///< one of integrators()
  std::optional<NonlinearSolver> solver;
  std::optional<double> tolerance;
  std::optional<Index> max_iterations, max_halvings, every;
  std::vector<Index> track;  ///< nodes
  std::string description;   ///< in a line
};

/// \throws InputError naming file, place and what was expected there; unknown keys are refused.
Scene read_scene(const std::filesystem::path& path, const Body& body);

/// What acts at a time, on nodes.
Loads loads_at(const Scene& scene, double t);
/// When all ramps and paths of a scene are over, or what they belong to ends [s]: loads stay as they are then, or have ended.
double time_of_full_load(const Scene& scene);
/// How many loads, springs and other forces of a scene do not act at a time.
Index num_idle(const Scene& scene, double t);

/// A scene for any model: pulled for half a period T of its softest flexible mode, then released, for three
/// periods in steps of T/60. Held objects are pulled sideways as by gravity, along the axis that gives way
/// most; free ones are bent by forces in balance, along their softest mode. By linear theory the motion
/// reaches a tenth of the diagonal.
Scene pluck_scene(const ReducedModel& model);

}  // namespace supple
