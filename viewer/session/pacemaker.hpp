#pragma once
/// \file Pacemaker of a simulation: how session time keeps up with the clock on the wall.

#include <algorithm>

namespace supple {

/// Says how many steps are due as wall-clock time passes. What hiccups of up to a quarter of a second leave undone is caught
/// up with; beyond that the time is lost, and for a second it says that it falls behind. Knows no clock.
class Pacemaker {
 public:
  /// \param wall  time that has passed since the last call [s].  \param speed  session time over wall-clock time wanted.
  void pass(double wall, double speed) {
    wall = std::max(wall, 0.0);
    measure(wall);
    owed_ += wall * speed;
    behind_for_ = std::max(0.0, behind_for_ - wall);
    if (const double most = patience * speed; owed_ > most) {
      owed_ = most;
      behind_for_ = 1;
    }
  }
  /// Forgets what is owed: nothing was to move.
  void rest(double wall) {
    owed_ = 0;
    behind_for_ = 0;
    measure(std::max(wall, 0.0));
  }
  bool is_due(double step) const { return owed_ >= step * (1 - 1e-9); }
  /// Wall-clock time until a step is due [s].
  double until_due(double step, double speed) const { return std::max(0.0, (step - owed_) / speed); }
  void stepped(double step) {
    owed_ -= step;
    ++steps_;
    moved_ += step;
  }
  /// The same for steps that nobody owed.
  void stepped_extra(double step) {
    ++steps_;
    moved_ += step;
  }

  bool falls_behind() const { return behind_for_ > 0; }
  double steps_per_second() const { return rate_; }  ///< of late
  double speed() const { return speed_; }            ///< session time over wall-clock time, of late

 private:
  static constexpr double patience = 0.25, window = 0.5;  // [s]

  /// Of what has passed before, with its steps; those of this time are still to come.
  void measure(double wall) {
    if (elapsed_ >= window) {
      rate_ = static_cast<double>(steps_) / elapsed_;
      speed_ = moved_ / elapsed_;
      elapsed_ = moved_ = 0;
      steps_ = 0;
    }
    elapsed_ += wall;
  }

  double owed_ = 0, behind_for_ = 0;
  double elapsed_ = 0, moved_ = 0;  // in this window [s]
  long long steps_ = 0;
  double rate_ = 0, speed_ = 0;
};

}  // namespace supple
