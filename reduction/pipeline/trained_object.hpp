#pragma once
/// \file Object trained in a subspace, from which models of several sizes come: reduce() in two steps.

#include <core/progress.hpp>
#include <reduction/model/reduced_model.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <reduction/pipeline/stage_clock.hpp>

#include <functional>

namespace supple {

/// A body in a subspace with its training poses and their forces: what models that differ in their number of points share.
class TrainedObject {
 public:
  /// \throws as reduce().
  TrainedObject(const Body& body, const ReduceOptions& options, const Progress& progress = {});

  /// The model that reduce() would make of the body by these options with so many points.
  /// \param points  s, as in ReduceOptions.  \param report  its times count those of the training, too.
  ReducedModel model(Index points, ReduceReport* report = nullptr) const;

 private:
  Body body_;
  ReduceOptions options_;
  StageClock stage_;  // of the training
  double seconds_ = 0;
  std::function<ReducedModel(const ReduceOptions& options, StageClock& stage, ReduceReport* report)> select_;
};

}  // namespace supple
