#pragma once
/// \file Simulation that somebody plays with: pulls, holds, drops and sets anything while it runs.

#include <physics/time/step_control.hpp>
#include <viewer/session/settings.hpp>
#include <viewer/session/view_model.hpp>

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace supple {

/// A number of a session or of its frames that there is no telling of.
inline constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// A spring by which somebody pulls at a node of the surface.
struct Pull {
  Index node = 0;                        ///< of the ViewGeometry
  Point target = Point::Zero();          ///< where it pulls to [m]
  std::optional<double> stiffness = {};  ///< [N/m]; none: default_pull_stiffness()
};

/// What a pull has unless one says otherwise: four times as stiff as the whole object against its softest mode [N/m].
double default_pull_stiffness(const ViewModel& model);

/// How a step went.
struct StepOutcome {
  StepReport report;
  double seconds = 0;        ///< wall-clock time that it took
  std::string failure = {};  ///< why it was taken back; empty if it was not
};

/// The motion of a reduced object under gravity, pulls, held regions and a floor, all of which may change between two steps.
/// The state is always one that can be shown: a step that ends in no finite state, or with energy from nothing, is taken
/// back. No threads and no clock: whoever owns it decides when to step.
///
///     SimulationSession session(model);
///     session.pull(/*client=*/1, {.node = 17, .target = {0.5, 0.2, 0}});
///     for (int k = 0; k < 100; ++k) (void)session.step();
///     const Vector& q = session.state().u;
class SimulationSession {
 public:
  explicit SimulationSession(std::shared_ptr<const ViewModel> model);
  SimulationSession(const SimulationSession&) = delete;  // integrators refer to the system in here
  SimulationSession& operator=(const SimulationSession&) = delete;

  /// \throws std::invalid_argument for settings out of range; nothing has changed then.
  void set(const ViewSettings& settings);
  const ViewSettings& settings() const { return settings_; }

  /// Holds a node to a target; each client has one pull, the last.
  /// \throws std::invalid_argument for a node that is not on the surface or that the model holds, a target farther than 100
  /// diagonals from the object, or a stiffness out of range.
  void pull(int client, const Pull& pull);
  void release(int client);
  const std::map<int, Pull>& pulls() const { return pulls_; }  ///< by client, their stiffness stated

  /// Holds nodes where they are now by stiff springs, instead of those held so before: a spread sample of them if they are many.
  /// \throws std::invalid_argument for nodes that do not exist.
  void hold(const std::vector<Index>& nodes);
  const std::vector<Index>& held() const { return held_; }

  /// One step; time stays where it fails.
  StepOutcome step();
  /// To rest at time 0, with all that acts; what is held is held at rest.
  void reset();

  const State& state() const { return state_; }
  Index num_steps() const { return num_steps_; }
  double kinetic_energy() const { return 0.5 * state_.v.squaredNorm(); }  ///< [J]; the mass is I
  double elastic_energy() const { return system_.energy(state_.u); }      ///< [J]
  double outside_potential() const;                                       ///< of all that acts [J]
  /// Energy that the integrator has made (> 0) or taken since the last reset [J].
  double energy_made() const { return made_before_ + made_; }
  /// Whether that is more than a hundredth of what went around since the last change of settings.
  bool makes_energy() const { return makes_energy_; }

  /// Estimated distance from the full object over the size of the motion, both rms; NaN where there is no telling: without an
  /// indicator, at rest, and with a factor on the stiffness.
  double estimated_error() const { return estimated_error_; }
  bool beyond_training() const { return beyond_training_; }

 private:
  void rebuild_integrator();
  void restart_estimate();
  void project_loads();
  void aim_springs();
  void estimate();
  std::shared_ptr<const OutsideTerm<Matrix>> floor_term(const Floor& floor) const;
  std::vector<PointSpring> springs() const;

  std::shared_ptr<const ViewModel> model_;
  ViewSettings settings_;
  AnySystem<Matrix> system_;
  std::optional<ControlledIntegrator<AnySystem<Matrix>>> integrator_;
  State state_;
  Index num_steps_ = 0;

  std::map<int, Pull> pulls_;
  std::vector<Index> held_;           // as asked for
  std::vector<PointSpring> holding_;  // a sample of these
  std::shared_ptr<const OutsideTerm<Matrix>> floor_;
  SystemLoad<Matrix> load_;
  Vector dead_force_;

  double made_ = 0, made_before_ = 0;  // by this integrator, by those before it [J]
  bool makes_energy_ = false;
  std::optional<MotionErrorEstimator> estimator_;
  double estimate_from_ = 0;  // [s]
  double estimated_error_;
  bool beyond_training_ = false;
};

/// At most `count` of the points, spread as widely as can be: each next one is the farthest from those before it.
std::vector<Index> spread_sample(const Points& points, Index count);

}  // namespace supple
