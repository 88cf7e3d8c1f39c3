#include <core/check.hpp>
#include <core/stopwatch.hpp>
#include <core/text.hpp>
#include <viewer/session/view_session.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace supple {

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double budget = 1.0 / 30;         // of an advance [s]
constexpr double slowest_frame = 1.0 / 60;  // of a mode that plays [s]
constexpr double shortest_period = 1;       // that a mode plays in at speed 1 [s]: the eye follows no faster one

Vector unit_shape(const ViewModel& model, Index mode) {
  const Vector phi = model.mode(mode);
  const float largest = model.geometry.surface_displacements(phi).rowwise().norm().maxCoeff();
  return largest > 0 ? Vector(phi / static_cast<double>(largest)) : phi;
}

double playing_frequency(const ViewModel& model, Index mode) {
  return std::min(model.frequency(mode), 1 / shortest_period);
}

}  // namespace

ViewSession::ViewSession(std::shared_ptr<const ViewModel> model, Clock clock)
    : model_(std::move(model)),
      clock_(clock ? std::move(clock) : [watch = Stopwatch()] { return watch.seconds(); }),
      simulation_(model_),
      edit_(model_),
      edit_error_(not_known) {
  shown_mode_.shape = unit_shape(*model_, 0);
  if (model_->recordings.empty()) return;
  replay_.emplace(model_);
  mode_ = ViewMode::Replay;
}

void ViewSession::join(int client) {
  require(std::ranges::find(clients_, client) == clients_.end(),
          "there is a client " + std::to_string(client) + " already");
  clients_.push_back(client);
}

void ViewSession::leave(int client) {
  std::erase(clients_, client);
  apply_one(client, request::Release{});
}

void ViewSession::apply(int client, const Request& request) {
  require(std::ranges::find(clients_, client) != clients_.end(),
          "client " + std::to_string(client) + " is not in this session");
  std::visit([&](const auto& one) { apply_one(client, one); }, request);
  ++changes_;
  ++moments_;
}

void ViewSession::apply_one(int, const request::Play&) {
  require(mode_ != ViewMode::Edit, "there is nothing to play in the mode edit");
  set_playing(true);
  steps_to_take_ = 0;
}
void ViewSession::apply_one(int, const request::Pause&) {
  set_playing(false);
  steps_to_take_ = 0;
}
void ViewSession::apply_one(int, const request::Reset&) {
  steps_to_take_ = 0;
  if (mode_ == ViewMode::Modes) {
    shown_mode_.time = 0;
  } else if (mode_ == ViewMode::Replay) {
    replay_->seek(replay_->begin());
  } else {
    simulation_.reset();
    edit_.reset();
    pace_ = {};
    last_step_ = last_solve_ = {};
    told_of_energy_ = false;
    judge_edit();
  }
}
void ViewSession::apply_one(int, const request::Step& step) {
  require(step.count >= 1 && step.count <= 1000,
          "count is " + std::to_string(step.count) + ", expected 1 to 1000 steps");
  require(mode_ != ViewMode::Edit, "there are no steps in the mode edit");
  set_playing(false);
  if (mode_ == ViewMode::Simulate) steps_to_take_ += step.count;
  if (mode_ == ViewMode::Replay) replay_->step(step.count);
  if (mode_ == ViewMode::Modes) shown_mode_.time += static_cast<double>(step.count) * slowest_frame;
}
void ViewSession::apply_one(int, const request::SetMode& set) {
  require(set.mode != ViewMode::Replay || replay_.has_value(), "there is no recording to play");
  mode_ = set.mode;
  steps_to_take_ = 0;
}
void ViewSession::apply_one(int, const request::Set& set) {
  simulation_.set(set.change.applied_to(settings()));
  told_of_energy_ = false;
}
void ViewSession::apply_one(int client, const request::PullAt& pull) {
  simulation_.pull(client, pull.pull);
}
void ViewSession::apply_one(int client, const request::Release&) {
  if (!simulation_.pulls().contains(client)) return;
  simulation_.release(client);
  ++changes_;
  ++moments_;
}
void ViewSession::apply_one(int, const request::Fix& fix) {
  simulation_.hold(fix.nodes);
}
void ViewSession::apply_one(int, const request::MakeHandle& make) {
  (void)edit_.add({.name = make.name,
                   .nodes = model_->geometry.in_mesh(make.nodes),
                   .samples = {},
                   .weight = {},
                   .movable = make.movable});
}
void ViewSession::apply_one(int, const request::MoveHandle& move) {
  edit_.move(move.handle, move.motion, move.grab ? EditSession::Grab::Yes : EditSession::Grab::No);
}
void ViewSession::apply_one(int, const request::RemoveHandle& remove) {
  edit_.remove(remove.handle);
}
void ViewSession::apply_one(int, const request::Undo&) {
  require(edit_.can_undo(), "there is nothing to undo");
  edit_.undo();
  judge_edit();
}
void ViewSession::apply_one(int, const request::Redo&) {
  require(edit_.can_redo(), "there is nothing to redo");
  edit_.redo();
  judge_edit();
}
void ViewSession::apply_one(int, const request::ShowMode& show) {
  require(show.mode >= 0 && show.mode < model_->num_flexible_modes(),
          "mode " + std::to_string(show.mode) + " does not exist, expected 0 to " +
              std::to_string(model_->num_flexible_modes() - 1));
  require(show.amplitude >= 0 && show.amplitude <= 1,
          "amplitude is " + shown(show.amplitude) + ", expected 0 to 1 of the diagonal");
  if (show.mode != shown_mode_.number) {
    shown_mode_.shape = unit_shape(*model_, show.mode);
    shown_mode_.time = 0;
  }
  shown_mode_.number = show.mode;
  shown_mode_.amplitude = show.amplitude;
}
void ViewSession::apply_one(int, const request::Seek& seek) {
  require(replay_.has_value(), "there is no recording to seek in");
  replay_->seek(seek.time);
}
void ViewSession::apply_one(int, const request::Load& load) {
  edit_.load(load.scene);
}

void ViewSession::advance(double wall) {
  const double end = clock_() + budget;
  if (mode_ == ViewMode::Modes && playing()) {
    shown_mode_.time += std::clamp(wall, 0.0, 0.25) * settings().speed;
    ++moments_;
  }
  if (mode_ == ViewMode::Replay && playing()) {
    replay_->pass(std::clamp(wall, 0.0, 0.25) * settings().speed);
    ++moments_;
  }
  if (mode_ == ViewMode::Edit) advance_edit(end);
  if (mode_ == ViewMode::Simulate && (playing() || steps_to_take_ > 0))
    advance_simulation(wall, end);
  else
    pace_.rest(wall);
}

void ViewSession::advance_simulation(double wall, double end) {
  const double h = settings().step;
  while (steps_to_take_ > 0 && clock_() < end) {
    --steps_to_take_;
    pace_.stepped_extra(h);
    step();
  }
  if (!playing()) return pace_.rest(wall);
  pace_.pass(wall, settings().speed);
  while (playing() && pace_.is_due(h) && clock_() < end) {
    pace_.stepped(h);
    step();
  }
}

void ViewSession::step() {
  const StepOutcome outcome = simulation_.step();
  ++moments_;
  if (!outcome.failure.empty()) {
    warnings_.push_back("the simulation pauses at " + shown(simulation_.state().time) + " s: " + outcome.failure);
    set_playing(false);
    steps_to_take_ = 0;
    ++changes_;
  } else if (simulation_.makes_energy() && !told_of_energy_) {
    warnings_.push_back(
        settings().integrator.name +
        " makes energy that no load brings; a shorter step, average-vector-field or backward-euler may help");
    told_of_energy_ = true;
  }
  last_step_ = {outcome.report, outcome.seconds};
}

void ViewSession::advance_edit(double end) {
  if (edit_.settled()) return;
  do {
    const Stopwatch watch;
    try {
      last_solve_.report = edit_.solve();
    } catch (const SolverError& error) {
      warnings_.push_back(std::string("the shape cannot be solved for: ") + error.what());
      edit_.give_up();
    }
    last_solve_.seconds = watch.seconds();
  } while (!edit_.settled() && clock_() < end);
  ++moments_;
  judge_edit();
}

void ViewSession::judge_edit() {
  edit_error_ = not_known;
  edit_beyond_training_ = false;
  if (const double size = edit_.state().norm(); model_->estimator && size > 0) {
    const ErrorEstimate error = (*model_->estimator)(edit_.state(), model_->system.force(edit_.state()));
    edit_error_ = error.total() / size;
    edit_beyond_training_ = error.beyond_training;
  }
  if (!edit_.settled()) return;
  const double held = edit_.held();
  if (held > held_over_diagonal_at_most && !told_of_handles_)
    warnings_.push_back(
        "the reduced model cannot take the shape that these handles ask for, and misses them by about " +
        std::to_string(std::lround(100 * held)) +
        " % of the diagonal: the full object would look different by as much. Smaller motions, fewer or "
        "smaller handles, or a model of more modes are followed better");
  told_of_handles_ = held > held_over_diagonal_at_most;
}

double ViewSession::until_due() const {
  switch (mode_) {
    case ViewMode::Simulate:
      if (steps_to_take_ > 0) return 0;
      return playing() ? pace_.until_due(settings().step, settings().speed) : infinity;
    case ViewMode::Edit:
      return edit_.settled() ? infinity : 0;
    case ViewMode::Modes:
    case ViewMode::Replay:
      return playing() ? slowest_frame : infinity;
  }
  return infinity;
}

ViewFrame ViewSession::frame() const {
  ViewFrame frame{.error = not_known, .playing = playing()};
  const auto took = [&](const auto& last) {
    frame.residual = last.report.residual;
    frame.iterations = last.report.iterations;
    frame.missed = last.report.status != Status::Converged;
    frame.seconds = last.seconds;
  };
  switch (mode_) {
    case ViewMode::Simulate:
      frame.time = simulation_.state().time;
      frame.kinetic = simulation_.kinetic_energy();
      frame.elastic = simulation_.elastic_energy();
      frame.potential = simulation_.outside_potential();
      frame.made = simulation_.energy_made();
      frame.error = simulation_.estimated_error();
      frame.beyond_training = simulation_.beyond_training();
      frame.q = simulation_.state().u;
      frame.num_steps = simulation_.num_steps();
      frame.steps_per_second = pace_.steps_per_second();
      frame.speed = pace_.speed();
      frame.falls_behind = pace_.falls_behind();
      took(last_step_);
      break;
    case ViewMode::Edit:
      frame.elastic = edit_.elastic_energy();
      frame.potential = edit_.control_energy();
      frame.error = edit_error_;
      frame.beyond_training = edit_beyond_training_;
      frame.q = edit_.state();
      took(last_solve_);
      break;
    case ViewMode::Modes: {
      const double omega = 2 * std::numbers::pi * model_->frequency(shown_mode_.number);
      const double phase = 2 * std::numbers::pi * playing_frequency(*model_, shown_mode_.number) * shown_mode_.time;
      const double size = shown_mode_.amplitude * model_->diagonal;
      frame.time = shown_mode_.time;
      frame.q = size * std::sin(phase) * shown_mode_.shape;
      frame.kinetic = 0.5 * (size * omega * std::cos(phase) * shown_mode_.shape).squaredNorm();
      frame.elastic = 0.5 * (omega * frame.q).squaredNorm();
      break;
    }
    case ViewMode::Replay:
      frame.time = replay_->time();
      frame.error = replay_->difference();
      for (Index k = 0; k < replay_->num_recordings(); ++k) frame.displacements.push_back(replay_->displacements(k));
      break;
  }
  return frame;
}

}  // namespace supple
