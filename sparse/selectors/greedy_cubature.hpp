#pragma once
/// \file Greedy cubature (An et al. 2008) and its batched variant (Kim & Delaney 2013): the baselines of the
/// field.

#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selectors/greedy.hpp>

namespace supple {

/// Adds one column at a time: of a few random candidates the one whose direction fits the residual best,
/// and refits by NNLS. With subset training, candidates are compared and weights fitted on a few random
/// groups of rows (training poses) only, anew in each step; all rows are fitted now and then, for the
/// history and the target error, and at the end.
/// \note s NNLS problems; O(|C| rows) for entries of A a step, or |C| + size times the rows of T_s groups.
/// \see An, Kim & James 2008, Optimizing cubature for efficient integration of subspace deformations.
struct GreedyCubature {
  double tolerance = 0;    ///< stop at this relative error, if the request has none
  Index candidates = 100;  ///< |C|, drawn anew in each step; An et al.: 100 to 1000
  /// T_s: groups of rows to train on, where the problem has groups; An et al.: 10; 0: all
  Index subset_groups = 0;
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(candidates >= 1, "candidates is less than 1, expected about 100");
    require(subset_groups >= 0, "subset_groups is negative, expected 0 (all) or about 10");
    if constexpr (GroupedFittingProblem<P>)
      if (0 < subset_groups && subset_groups < problem.num_groups()) return with_subset_training(problem, request);
    return grow({.tolerance = tolerance,
                 .candidates = candidates,
                 .batch = 1,
                 .largest_size = 0,
                 .measure = Measure::Cosine,
                 .seed = seed},
                problem, request);
  }

 private:
  template <GroupedFittingProblem P>
  Selection with_subset_training(const P& problem, const SelectionRequest& request) const {
    SelectionRun<P> run(problem, request);
    const Index s = run.rules.size();
    Random random(seed);

    WorkingSet<P> S = run.start();
    Vector w = S.fit();
    run.record(S, w);
    run.drop_unused(S, w);

    Index iterations = 0;
    const Index max_iterations = 5 * s + 50;
    std::vector<Index> joined;  // since the last fit to all rows
    const auto fit_to_all_rows = [&] {
      S.append(run.evaluate(joined).block);
      w = S.fit();
      run.record(S, w);
      run.drop_unused(S, w);
      joined.clear();
    };
    const auto finish = [&](Status status, const char* reason) { return run.finish(S, status, iterations, reason); };
    for (; iterations < max_iterations; ++iterations) {
      const auto num_joined = static_cast<Index>(joined.size()), size = S.size() + num_joined;
      if (size >= s || num_joined > size / 20) {
        fit_to_all_rows();
        if (run.met(tolerance)) return finish(Status::Converged, "target error reached");
        if (S.size() >= s) return finish(run.status_at_size(), "size reached");
      }
      run.tell(S.size(), s);

      const auto subset = problem.restricted_to(random.sample(all_positions(problem.num_groups()), subset_groups));
      const std::vector<Index> present = sorted_union(S.indices(), joined);
      const std::vector<Index> rest = run.rules.eligible_without(present);
      const std::vector<Index> drawn = random.sample(rest, candidates);
      if (drawn.empty()) {
        fit_to_all_rows();
        return finish(run.status_at_size(), "no columns left");
      }
      WorkingSet<std::remove_const_t<decltype(subset)>> trained(subset);
      trained.append(columns_of(subset, std::span<const Index>(present)));
      const auto block = columns_of(subset, std::span<const Index>(drawn));
      run.account(static_cast<Index>(present.size() + drawn.size()) * subset_groups / problem.num_groups());
      const Vector g = block.transpose_times(trained.residual(trained.fit())),
                   norms = block.squared_norms().cwiseSqrt();
      if (!norms.allFinite()) run.evaluate(drawn);  // which says which column it is, and throws
      Index best = 0;
      (norms.array() > 0).select(g.cwiseQuotient(norms), -std::numeric_limits<double>::infinity()).maxCoeff(&best);
      joined.push_back(drawn[best]);
    }
    return finish(Status::MaxIterations, "limit of iterations reached");
  }
};

/// Adds several columns between two NNLS solves: the best directions among candidates drawn at random.
/// \see Kim & Delaney 2013, Subspace fluid re-simulation.
struct BatchedGreedy {
  double tolerance = 0;  ///< stop at this relative error, if the request has none
  /// share of s that joins in each step; fewer: smaller error, more NNLS problems
  double added_per_size = 0.1;
  double candidates_per_added = 10;  ///< drawn anew in each step; few: less alike, many: better directions
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(added_per_size > 0, "added_per_size is not positive, expected about 0.1");
    require(candidates_per_added >= 1, "candidates_per_added is less than 1, expected about 10");
    if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
    const Index batch = std::max<Index>(1, share(added_per_size, std::min(request.size, problem.cols())));
    return grow({.tolerance = tolerance,
                 .candidates = share(candidates_per_added, batch),
                 .batch = batch,
                 .largest_size = 0,
                 .measure = Measure::Cosine,
                 .seed = seed},
                problem, request);
  }
};

static_assert(SubsetSelector<GreedyCubature> && SubsetSelector<BatchedGreedy>);

}  // namespace supple
