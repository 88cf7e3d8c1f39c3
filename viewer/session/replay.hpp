#pragma once
/// \file Motions that were computed before, played again: one, or two beside each other.

#include <viewer/session/view_model.hpp>

#include <memory>
#include <string>
#include <vector>

namespace supple {

/// Plays the recordings of a model in a loop: what it was, and if there is a second one, what it ought to have been.
/// Between two stored moments displacements are interpolated linearly. No threads and no clock.
///
///     Replay replay(model);
///     replay.pass(0.02);
///     const ViewGeometry::Floats u = replay.displacements(0);
class Replay {
 public:
  /// \pre the model has recordings.
  explicit Replay(std::shared_ptr<const ViewModel> model);

  Index num_recordings() const { return static_cast<Index>(model_->recordings.size()); }
  double begin() const { return begin_; }            ///< the first time that all recordings have [s]
  double duration() const { return end_ - begin_; }  ///< of what all recordings have [s]
  double time() const { return time_; }              ///< within begin() and begin() + duration() [s]

  /// \throws std::invalid_argument for a time beyond the recordings.
  void seek(double time);
  void pass(double seconds);  ///< time passes; behind the end it begins again
  void step(Index count);     ///< to the stored moments of the first recording that follow, in a loop

  /// x − X of the surface's nodes at this time, one a row [m]. \param which  recording: 0, or 1 for the reference.
  ViewGeometry::Floats displacements(Index which) const;
  /// Distance of the first from the second at this time over the second's displacement, both root mean squares over the
  /// surface's nodes, the latter over all its frames, too: it would vanish wherever an object swings through rest. NaN where
  /// there is no second, or where it never moves.
  double difference() const;

 private:
  std::shared_ptr<const ViewModel> model_;
  double begin_ = 0, end_ = 0, time_ = 0;  // [s]
  double reference_size_ = 0;              // ‖u‖ of the second, rms over its frames [m]
};

}  // namespace supple
