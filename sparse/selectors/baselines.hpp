#pragma once
/// \file Baselines: columns at random and all columns, floor and ceiling of a comparison.

#include <sparse/selection/selection_run.hpp>
#include <sparse/selection/smallest_selection.hpp>

namespace supple {

/// s columns at random, with must-keep and warm start among them, weighted by NNLS: what a selector must
/// beat.
struct UniformRandom {
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
    SelectionRun<P> run(problem, request);
    WorkingSet<P> S = run.start();
    S.append(
        run.evaluate(Random(seed).sample(run.rules.eligible_without(S.indices()), run.rules.size() - S.size())).block);
    run.record(S, S.fit());
    return run.finish(S, run.status_at_size(), 1, "size reached");
  }
};

/// All candidates, weighted by NNLS: no selection among them has a smaller error.
/// \throws std::invalid_argument if the request's size is less than the number of candidates.
/// \note O(m²) memory and O(rows m²) operations for m candidates: for problems of some thousand columns.
struct AllColumns {
  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    SelectionRun<P> run(problem, request);
    require(run.rules.size() == static_cast<Index>(run.rules.eligible().size()),
            "size is " + std::to_string(run.rules.size()) + ", expected the number of candidates, " +
                std::to_string(run.rules.eligible().size()));
    WorkingSet<P> S(problem);
    S.append(run.evaluate(run.rules.eligible()).block);
    run.record(S, S.fit());
    return run.finish(S, run.status_at_size(), 1, "all columns considered");
  }
};

static_assert(SubsetSelector<UniformRandom> && SubsetSelector<AllColumns>);

}  // namespace supple
