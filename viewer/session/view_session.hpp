#pragma once
/// \file Session of a viewer: one object that several clients simulate, edit and look at together.

#include <viewer/session/edit_session.hpp>
#include <viewer/session/pacemaker.hpp>
#include <viewer/session/replay.hpp>
#include <viewer/session/requests.hpp>
#include <viewer/session/simulation_session.hpp>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace supple {

/// The object at one moment.
struct ViewFrame {
  double time = 0;                                           ///< [s]
  double kinetic = 0, elastic = 0, potential = 0, made = 0;  ///< energies [J], `made` by the integrator
  double residual = 0;                                       ///< of the last step or solve, relative
  Index iterations = 0;
  double seconds = 0;                      ///< that it took
  double steps_per_second = 0, speed = 0;  ///< of late; see Pacemaker
  /// Estimated, over the size of the motion, or in a replay measured; NaN where there is no telling.
  double error = 0;
  bool playing = false, falls_behind = false, missed = false, beyond_training = false;
  Index num_steps = 0;
  Vector q = {};  ///< but in a replay
  /// x − X of the surface's nodes of each recording that is played [m]; in a replay alone.
  std::vector<ViewGeometry::Floats> displacements = {};
};

/// One object and all that acts on it, for any number of clients: each sees what all do, the last word counts, and each has a
/// pull of its own. Simulation and editing have a state each. Time passes by advance() alone; there are no threads, no network
/// and, but for the budget of an advance(), no clock. Begins paused, at rest, in simulation; with recordings it plays these.
///
///     ViewSession session(std::make_shared<const ViewModel>(load_model("bar.supple"), "bar"));
///     session.join(/*client=*/1);
///     session.apply(1, request::PullAt{{.node = 3, .target = {1, 1, 0}}});
///     session.apply(1, request::Play{});
///     session.advance(0.5);
///     const ViewFrame frame = session.frame();
class ViewSession {
 public:
  /// Time that somebody measures [s], from any origin.
  using Clock = std::function<double()>;

  /// \param clock  of the budget of an advance(); empty: the machine's.
  explicit ViewSession(std::shared_ptr<const ViewModel> model, Clock clock = {});

  /// A client comes, by a number that nobody has. \throws std::invalid_argument if somebody has it.
  void join(int client);
  void leave(int client);  ///< who leaves lets go
  Index num_clients() const { return static_cast<Index>(clients_.size()); }

  /// Does what a client asks for. \throws std::invalid_argument saying why it is refused; nothing has changed then.
  void apply(int client, const Request& request);

  /// Wall-clock time passes: steps that are due are taken, edits solved, for at most about a thirtieth of a second.
  void advance(double wall_seconds);
  /// Wall-clock time until advance() has something to do [s]; infinite while nothing moves.
  double until_due() const;

  ViewFrame frame() const;
  /// Counts the moments that differ; a frame need be sent only when it has grown.
  Index num_moments() const { return moments_; }

  ViewMode mode() const { return mode_; }
  bool playing() const { return playing_[static_cast<std::size_t>(mode_)]; }
  const ViewSettings& settings() const { return simulation_.settings(); }
  const SimulationSession& simulation() const { return simulation_; }
  const EditSession& edit() const { return edit_; }
  /// Counts changes of what a client may have asked for: mode, settings, handles, pulls.
  Index num_changes() const { return changes_; }
  /// What users should know that has come up since the last call.
  std::vector<std::string> take_warnings() { return std::exchange(warnings_, {}); }

  const ViewModel& model() const { return *model_; }

 private:
  void set_playing(bool playing) { playing_[static_cast<std::size_t>(mode_)] = playing; }
  void advance_simulation(double wall, double end);
  void advance_edit(double end);
  void step();
  void judge_edit();

  void apply_one(int client, const request::Play&);
  void apply_one(int client, const request::Pause&);
  void apply_one(int client, const request::Reset&);
  void apply_one(int client, const request::Step&);
  void apply_one(int client, const request::SetMode&);
  void apply_one(int client, const request::Set&);
  void apply_one(int client, const request::PullAt&);
  void apply_one(int client, const request::Release&);
  void apply_one(int client, const request::Fix&);
  void apply_one(int client, const request::MakeHandle&);
  void apply_one(int client, const request::MoveHandle&);
  void apply_one(int client, const request::RemoveHandle&);
  void apply_one(int client, const request::Undo&);
  void apply_one(int client, const request::Redo&);
  void apply_one(int client, const request::ShowMode&);
  void apply_one(int client, const request::Seek&);
  void apply_one(int client, const request::Load&);

  std::shared_ptr<const ViewModel> model_;
  Clock clock_;
  SimulationSession simulation_;
  EditSession edit_;
  std::optional<Replay> replay_;
  Pacemaker pace_;

  std::vector<int> clients_;
  ViewMode mode_ = ViewMode::Simulate;
  std::array<bool, 4> playing_{false, false, true, true};
  Index steps_to_take_ = 0;  // that somebody asked for one by one
  Index moments_ = 1, changes_ = 1;
  std::vector<std::string> warnings_;

  struct {
    SolveReport report{{.status = Status::Converged, .iterations = 0, .residual = 0}};
    double seconds = 0;
  } last_step_, last_solve_;
  bool told_of_energy_ = false, told_of_handles_ = false;
  double edit_error_;
  bool edit_beyond_training_ = false;

  struct {
    Index number = 0;
    double amplitude = 0.1, time = 0;
    Vector shape;  // moves no node of the surface by more than 1 m
  } shown_mode_;
};

}  // namespace supple
