#pragma once
/// \file Non-negativity-constrained hard thresholding pursuit (von Tycowicz et al. 2013, Sec. 4.1, Algorithm
/// 1).

#include <sparse/hard_threshold.hpp>
#include <sparse/selection_run.hpp>

namespace supple {

/// The adaptive step μ = α ‖g_S‖² / ‖A g_S‖² along −g_S, g = ∇‖A w − b‖² = 2 Aᵀ(A w − b).
enum class StepLength {
  Paper,  ///< α = 1, Eq. 9: twice the minimising step, so that f does not change before thresholding
  Exact,  ///< α = ½, the minimiser along −g_S
};

constexpr double step_factor(StepLength step) {
  return step == StepLength::Paper ? 1.0 : 0.5;
}

/// Fits b by at most s columns of A with positive weights: each iteration takes a projected gradient step
/// over the support and the best of c randomly drawn columns, and solves NNLS on the s columns that survive.
/// Returns the best iterate, which need not be the last. \note O(rows (s + c)) entries of A and O(rows s²)
/// operations an iteration. \see docs/selectors.md for where it departs from Algorithm 1, and why; Foucart
/// 2011.
struct NnHtp {
  double tolerance = 0;  ///< stop at this relative error, if the request has no larger one; the paper: 0.03
  Index max_iterations = 20;  ///< the paper: 10, but 18 for its dragon; each may improve the selection
  double candidates_per_size =
      5;  ///< c/s: more is slower and, Sec. 4.1, not always better; infinity: all columns
  StepLength step = StepLength::Paper;
  Index patience = 3;  ///< stop after so many draws in a row that change nothing
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(candidates_per_size > 0, "candidates_per_size is not positive, expected about 5");
    SelectionRun<P> run(problem, request);
    const Index s = run.rules.size(), c = share(candidates_per_size, s);
    Random random(seed);

    WorkingSet<P> X = run.start();
    Vector w = X.fit().w;
    Vector r = run.record(X, w);
    run.drop_unused(X, w);

    Index iterations = 0, unchanged = 0;
    std::vector<Index> previous;
    const auto finish = [&](Status status, const char* reason) {
      return run.finish(X, FinalWeights::NonNegative, status, iterations, reason);
    };
    for (; iterations < max_iterations; ++iterations) {
      if (run.met(tolerance)) return finish(Status::Converged, "target error reached");
      run.tell(iterations, max_iterations);

      const std::vector<Index> rest = run.rules.eligible_without(X.indices());
      const Evaluated<P> drawn = run.evaluate(random.sample(rest, c));
      const Vector descent =
          improving(drawn.block.transpose_times(r), drawn.norms, run.b_norm()).correlations;
      const std::vector<Index> entering = largest_positive(descent, s);
      const ColumnsOf<P> fresh = drawn.block.subset(entering);  // S = X ∪ fresh, Eq. 8

      const Vector g_X = -2 * X.block().transpose_times(r), g_fresh = -2 * descent(entering);
      const Vector A_g = X.block().times(g_X) + fresh.times(g_fresh);
      const double mu =
          step_factor(step) * (g_X.squaredNorm() + g_fresh.squaredNorm()) / A_g.squaredNorm();  // Eq. 9

      Vector x(w.size() + g_fresh.size());
      x << w - mu * g_X, -mu * g_fresh;
      for (Index k = 0; k < w.size(); ++k)
        if (run.rules.must_keep(X.block().index(k))) x[k] = std::numeric_limits<double>::infinity();
      const auto [kept, chosen] = split_at(w.size(), largest_positive(x, s));  // H_s⁺

      const std::vector<Index> next = sorted_union(indices_at(X.block(), kept), indices_at(fresh, chosen));
      const bool repeats =
          next == previous || (chosen.empty() && static_cast<Index>(kept.size()) == X.size());
      if (repeats) {
        if (static_cast<Index>(rest.size()) <= c)
          return finish(Status::Converged, "no column improves the selection");
        if (++unchanged >= patience) return finish(Status::Stagnated, "repeated draws change nothing");
        continue;
      }
      unchanged = 0;
      previous = next;
      X.keep(kept);
      X.append(fresh.subset(chosen));
      w = X.fit_on(all_positions(X.size()));  // Eq. 10 with w ≥ 0
      r = run.record(X, w);
      run.drop_unused(X, w);
    }
    if (run.met(tolerance)) return finish(Status::Converged, "target error reached");
    return finish(Status::MaxIterations, "limit of iterations reached");
  }
};
static_assert(SubsetSelector<NnHtp>);

}  // namespace supple
