#include <reduction/pipeline/body_training.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/pipeline/reduction.hpp>
#include <sparse/selectors/selector_library.hpp>

namespace supple {

ReducedModel reduce(const Body& body, const ReduceOptions& options, ReduceReport* report_out,
                    const Progress& progress) {
  check(options);
  StageClock stage(progress);
  const AnySelector select(options.selector, RunSeeds(options).selection);
  ReducedModel model;
  with_object(body, options, stage, [&](const auto& system, const auto& subspace) {
    auto reduction = reduce(system, subspace, traits_of(body, options), select, options, stage);
    static_cast<ReducedForces<AnyBasis>&>(model) = {std::move(reduction.subspace), std::move(reduction.rest_stiffness),
                                                    std::move(reduction.indices), std::move(reduction.weights)};
    if (report_out) *report_out = std::move(reduction.report);
  });
  model.body = body;
  model.subspace_name = options.subspace;
  return model;
}

}  // namespace supple
