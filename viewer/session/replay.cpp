#include <core/check.hpp>
#include <core/text.hpp>
#include <viewer/session/replay.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

namespace supple {

Replay::Replay(std::shared_ptr<const ViewModel> model) : model_(std::move(model)) {
  std::tie(begin_, end_) = common_time(model_->recordings);
  time_ = begin_;
  if (num_recordings() < 2) return;
  const ViewRecording& reference = model_->recordings[1];
  reference_size_ = reference.frames.cast<double>().norm() / std::sqrt(static_cast<double>(reference.num_frames()));
}

void Replay::seek(double time) {
  require(time >= begin_ && time <= end_,
          "time is " + shown(time) + " s, expected " + shown(begin_) + " to " + shown(end_) + " s");
  time_ = time;
}

void Replay::pass(double seconds) {
  time_ += std::max(seconds, 0.0);
  if (time_ > end_) time_ = duration() > 0 ? begin_ + std::fmod(time_ - begin_, duration()) : begin_;
}

void Replay::step(Index count) {
  const Vector& moments = model_->recordings[0].time;
  const double rounding = 1e-9 * duration();
  while (count-- > 0) {
    const auto next = std::upper_bound(moments.begin(), moments.end(), time_ + rounding);
    time_ = next == moments.end() || *next > end_ ? begin_ : *next;
  }
}

ViewGeometry::Floats Replay::displacements(Index which) const {
  const ViewRecording& recording = model_->recordings[static_cast<std::size_t>(which)];
  const Vector& moments = recording.time;
  const Index later = std::upper_bound(moments.begin(), moments.end(), time_) - moments.begin();
  const Index last = later - 1, next = std::min(later, moments.size() - 1);  // the same at the end
  const double share = next > last ? (time_ - moments[last]) / (moments[next] - moments[last]) : 0;
  ViewGeometry::Floats u(model_->geometry.num_surface_nodes, 3);
  Eigen::Map<Eigen::RowVectorXf>(u.data(), u.size()) = static_cast<float>(1 - share) * recording.frames.row(last) +
                                                       static_cast<float>(share) * recording.frames.row(next);
  return u;
}

double Replay::difference() const {
  if (!(reference_size_ > 0)) return std::numeric_limits<double>::quiet_NaN();
  return (displacements(0) - displacements(1)).cast<double>().norm() / reference_size_;
}

}  // namespace supple
