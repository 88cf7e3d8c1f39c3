#pragma once
/// \file Search for the smallest size that reaches an error, for selectors that need a size.

#include <sparse/selection/selection_run.hpp>

namespace supple {

/// The smallest selection, to 5 % of its size and within the request's, by which `select` reaches the request's
/// target error: sizes are doubled until one does, then bisected; each run starts from the largest selection that failed.
/// Seconds, iterations and columns evaluated are those of all runs together, the history that of the answer.
/// \note about 2 log₂(size) runs of `select`. If no size reaches the target, the largest is returned, with
/// the reason.
template <typename S, FittingProblem P>
Selection smallest_selection(const S& select, const P& problem, SelectionRequest request) {
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
  const auto reached = [&](const Selection& c) { return c.report.training_error <= request.target_error; };

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

}  // namespace supple
