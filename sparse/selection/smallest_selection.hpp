#pragma once
/// \file Search for the smallest size that reaches a goal, for selectors that need a size.

#include <sparse/selection/selection_run.hpp>

#include <concepts>

namespace supple {

/// The smallest selection, to 5 % of its size and within the request's, of those that `select` makes for which
/// `reached(selection)` holds: sizes are doubled until it does, then bisected; each run starts from the largest selection
/// for which it did not. Seconds, iterations and columns evaluated are those of all runs together, the history that of the
/// answer.
/// \note about 2 log₂(size) runs of `select`. If none reaches it, the largest is returned, with the reason.
template <typename S, FittingProblem P, std::predicate<const Selection&> Reached>
Selection smallest_selection(const S& select, const P& problem, SelectionRequest request, const Reached& reached) {
  const Stopwatch stopwatch;
  const SelectionRules rules(request, problem.cols(), problem.rhs());
  const Index largest = rules.size();
  Index iterations = 0, columns_evaluated = 0;
  const auto select_at = [&](Index size) {
    request.size = size;
    Selection selection = select(problem, request);
    iterations += selection.report.iterations;
    columns_evaluated += selection.report.columns_evaluated;
    return selection;
  };

  Index failing = 0, size = std::min(largest, std::max<Index>(8, static_cast<Index>(rules.start().size())));
  Selection best = select_at(size);
  while (!reached(best) && size < largest) {
    failing = size;
    size = std::min(largest, 2 * size);
    request.warm_start = best;
    best = select_at(size);
  }
  if (reached(best)) {
    size = std::max(failing + 1, best.size());
    while (size - failing > std::max<Index>(1, size / 20)) {
      const Index middle = (failing + size) / 2;
      if (middle < static_cast<Index>(rules.must_keep().size())) break;
      Selection trial = select_at(middle);
      if (reached(trial)) {
        size = std::max(failing + 1, trial.size());
        best = std::move(trial);
      } else {
        failing = middle;
        request.warm_start = std::move(trial);
      }
    }
  }
  best.report.iterations = iterations;
  best.report.columns_evaluated = columns_evaluated;
  best.report.seconds = stopwatch.seconds();
  return best;
}

/// The smallest selection that reaches the request's target error.
template <typename S, FittingProblem P>
Selection smallest_selection(const S& select, const P& problem, const SelectionRequest& request) {
  return smallest_selection(select, problem, request, [error = request.target_error](const Selection& c) {
    return c.report.training_error <= error;
  });
}

}  // namespace supple
