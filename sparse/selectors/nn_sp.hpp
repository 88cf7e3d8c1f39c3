#pragma once
/// \file Non-negative subspace pursuit: few columns, small error, little time.

#include <sparse/nnls/pruning.hpp>
#include <sparse/selection/hard_threshold.hpp>
#include <sparse/selection/selection_run.hpp>
#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selection/weighted_sample.hpp>
#include <sparse/selectors/exchanging.hpp>

namespace supple {

/// Improves a selection by growing and pruning it: each iteration draws c columns at random, the more likely the
/// larger they are, deals them into groups, adds of each group the one whose direction fits the residual best, solves
/// NNLS on the union, prunes that to s by backward elimination, exchanges single columns as long as that helps, and
/// keeps the result if the error is smaller. As many groups as columns are missing, plus a share of s. The groups keep
/// the new columns diverse; which stay is for pruning and exchanging to decide, and they decide with the refit in view,
/// where a gradient sees one column at a time. The error never increases; there is no certificate that it is the
/// smallest.
/// \note O(c rows) for entries of A, O(rows s²) for the Gram matrix of the added share, O(s³) for fit, pruning and
/// exchanges, an iteration.
/// \see Dai & Milenkovic 2009 (subspace pursuit); docs/selectors.md for measurements.
struct NnSp {
  /// Stop at this relative error, if the request has none.
  double tolerance = 0;
  /// 0: 6000 / s, but at least 24. From 12 on, twice as many lower the error by 5 to 10 %.
  Index max_iterations = 0;
  /// c/s, but at least 500 columns. More costs more columns and gains little.
  double candidates_per_size = 5;
  /// Share of s that each iteration tries to exchange, but at least 100 columns, which cost nothing where s is small.
  /// A quarter takes a third of the time for 10 to 20 % more error and a trajectory twice as far off.
  double added_per_size = 1;
  /// Stop after so many draws in a row that improve nothing.
  Index patience = 10;
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(candidates_per_size > 0, "candidates_per_size is not positive, expected about 5");
    require(added_per_size > 0, "added_per_size is not positive, expected about 1");
    if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
    SelectionRun<P> run(problem, request);
    const Index s = run.rules.size(), c = std::max(share(candidates_per_size, s), Index{500});
    const Index limit = max_iterations > 0 ? max_iterations : std::max(Index{24}, 6000 / s);
    const Index added = std::max(share(added_per_size, s), Index{100});
    Random random(seed);
    const Vector draw_weight = draw_weights(problem, random);

    WorkingSet<P> S = run.start();
    Vector w = S.fit();
    Vector r = run.record(S, w);
    run.drop_unused(S, w);

    Index iterations = 0, unchanged = 0;
    const auto finish = [&](Status status, const char* reason) { return run.finish(S, status, iterations, reason); };
    for (; iterations < limit; ++iterations) {
      if (run.met(tolerance)) return finish(Status::Converged, "target error reached");
      run.tell(iterations, limit);

      const Index old_size = S.size(), groups = s - old_size + added;
      const std::vector<Index> rest = run.rules.eligible_without(S.indices());
      const Scan<P> drawn = run.scan(weighted_sample(rest, draw_weight, std::max(c, groups), random), r);
      const std::vector<Index> entering = best_of_groups(drawn.cosines(), groups);
      if (entering.empty() && drawn.size() == static_cast<Index>(rest.size()))
        return finish(run.status_at_size(), "no column improves the selection");

      S.append(run.columns(drawn, entering));
      Vector w_next = S.fit();
      if (static_cast<Index>(run.used_positions(S, w_next).size()) > s) {
        const std::vector<char> fixed = run.must_keep(S);
        w_next = S.fit_on(prune(S.gram(), w_next, s, fixed));
        w_next = S.fit_on(exchange(S.gram(), S.atb(), w_next, fixed));
      }

      const double error = run.error();
      const Vector r_next = run.record(S, w_next);
      if (run.error() < error) {
        w = w_next;
        r = r_next;
        run.drop_unused(S, w);
        unchanged = 0;
      } else {
        S.keep(all_positions(old_size));
        if (++unchanged >= patience) return finish(Status::Stagnated, "repeated draws improve nothing");
      }
    }
    if (run.met(tolerance)) return finish(Status::Converged, "target error reached");
    return finish(Status::MaxIterations, "limit of iterations reached");
  }

 private:
  // The norms of the columns, from as many groups of rows as tell them well enough, and a little more: a column may
  // be zero just there. Equal where norms would cost as much as columns.
  template <FittingProblem P>
  static Vector draw_weights(const P& problem, Random& random) {
    if constexpr (FullGradientProblem<P> && GroupedFittingProblem<P>) {
      const std::vector<Index> some = random.sample(all_positions(problem.num_groups()), 32);
      const Vector norms = Vector(problem.restricted_to(some).squared_norms()).cwiseSqrt();
      if (norms.allFinite() && norms.maxCoeff() > 0) return norms.array() + 0.1 * norms.mean();
    }
    return Vector::Ones(problem.cols());
  }
};
static_assert(SubsetSelector<NnSp>);

}  // namespace supple
