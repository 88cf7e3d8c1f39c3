#include <reduction/pipeline/body_training.hpp>
#include <reduction/pipeline/reduction.hpp>
#include <reduction/pipeline/trained_object.hpp>
#include <sparse/selectors/selector_library.hpp>

namespace supple {

TrainedObject::TrainedObject(const Body& body, const ReduceOptions& options, const Progress& progress)
    : body_(body), options_(options), stage_(progress) {
  check(options_);
  with_object(body_, options_, stage_, [&](const auto& system, const auto& subspace) {
    auto training = train(system, subspace, traits_of(body_, options_), options_, stage_);
    select_ = [training = std::make_shared<const decltype(training)>(std::move(training))](
                  const ReduceOptions& chosen, StageClock& stage, ReduceReport* report) {
      auto reduction = reduce(*training, AnySelector(chosen.selector, RunSeeds(chosen).selection), chosen, stage);
      if (report) *report = std::move(reduction.report);
      ReducedModel model;
      static_cast<ReducedForces<AnyBasis>&>(model) = {std::move(reduction.subspace),
                                                      std::move(reduction.rest_stiffness), std::move(reduction.indices),
                                                      std::move(reduction.weights), std::move(reduction.indicator)};
      return model;
    };
  });
  seconds_ = stage_.total_seconds();
}

ReducedModel TrainedObject::model(Index points, ReduceReport* report) const {
  ReduceOptions options = options_;
  options.points = points;
  check(options);
  const Stopwatch watch;
  StageClock stage = stage_;
  ReducedModel model = select_(options, stage, report);
  if (report) report->total_seconds = seconds_ + watch.seconds();
  model.body = body_;
  model.subspace_name = options.subspace;
  return model;
}

}  // namespace supple
