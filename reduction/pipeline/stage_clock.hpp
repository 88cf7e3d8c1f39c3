#pragma once
/// \file Clock that names stages, tells of them and notes their times.

#include <core/progress.hpp>
#include <core/stopwatch.hpp>

#include <string>
#include <utility>
#include <vector>

namespace supple {

class StageClock {
 public:
  explicit StageClock(Progress progress = {}) : progress_(std::move(progress)) {}

  /// Runs work(share), where share(x) tells how much of it is done, and notes how long it took.
  template <typename Work>
  decltype(auto) operator()(const std::string& name, Work&& work) {
    struct Finish {
      StageClock& clock;
      const std::string& name;
      Stopwatch watch;
      ~Finish() { clock.seconds_.emplace_back(name, watch.seconds()); }
    } finish{*this, name, {}};
    tell(progress_, name, 0);
    return work([this, &name](double share) { tell(progress_, name, share); });
  }

  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }  ///< by stage, in order
  double total_seconds() const { return total_.seconds(); }                                ///< since construction
  const Progress& progress() const { return progress_; }

 private:
  Progress progress_;
  Stopwatch total_;
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace supple
