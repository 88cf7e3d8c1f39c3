#pragma once
/// \file Hard thresholding pursuit, non-negative (von Tycowicz et al. 2013, Sec. 4.1, Algorithm 1) and plain.

#include <sparse/selection/hard_threshold.hpp>
#include <sparse/selection/selection_run.hpp>
#include <sparse/selection/smallest_selection.hpp>

namespace supple {

/// The adaptive step μ = α ‖g_S‖² / ‖A g_S‖² along −g_S, g = ∇‖A w − b‖² = 2 Aᵀ(A w − b).
enum class StepLength {
  Paper,  ///< α = 1, Eq. 9: twice the minimising step, so that f does not change before thresholding
  Exact,  ///< α = ½: the minimiser along −g_S
};

/// Fits b by at most s columns of A with positive weights: each iteration takes a projected gradient step
/// over the support and the best of c randomly drawn columns, and solves NNLS on the s columns that survive.
/// Returns the best iterate, which need not be the last. \note O(rows (s + c)) entries of A and O(rows s²)
/// operations an iteration. \see docs/selectors.md for where it departs from Algorithm 1, and why; Foucart
/// 2011.
struct NnHtp {
  /// Stop at this relative error, if the request has none. The paper: 0.03.
  double tolerance = 0;
  /// The paper: 10, but 18 for its dragon. The error is not monotone, each iteration may bring the best one.
  Index max_iterations = 40;
  /// c/s. More is slower and, Sec. 4.1, not always better; infinity: all columns, which costs least for a
  /// FullGradientProblem.
  double candidates_per_size = 5;
  StepLength step = StepLength::Paper;
  /// Stop after so many draws in a row that change nothing.
  Index patience = 10;
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const;
};

/// The same without the sign: weights are any but 0, fitted by plain least squares, and columns are chosen by
/// magnitude (Foucart 2011, with the step of Eq. 9). For compressed sensing; a reduced force with it is not a
/// potential's.
struct Htp {
  double tolerance = 0;
  Index max_iterations = 50;
  double candidates_per_size = std::numeric_limits<double>::infinity();
  StepLength step = StepLength::Exact;
  Index patience = 3;
  std::uint64_t seed = 0;
  static constexpr Signs signs = Signs::Any;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const;
};

template <typename Options, FittingProblem P>
Selection hard_thresholding_pursuit(const Options& options, Signs signs, const P& problem,
                                    const SelectionRequest& request) {
  require(options.candidates_per_size > 0, "candidates_per_size is not positive, expected about 5");
  SelectionRun<P> run(problem, request);
  const Index s = run.rules.size(), c = share(options.candidates_per_size, s);
  Random random(options.seed);

  WorkingSet<P> X = run.start();
  Vector w = X.fit(signs, all_positions(X.size())).w;
  Vector r = run.record(X, w);
  run.drop_unused(X, w);

  Index iterations = 0, unchanged = 0;
  std::vector<Index> previous;
  const auto finish = [&](Status status, const char* reason) {
    return run.finish(X, status, iterations, reason, FinalWeights::Refitted, signs);
  };
  for (; iterations < options.max_iterations; ++iterations) {
    if (run.met(options.tolerance)) return finish(Status::Converged, "target error reached");
    run.tell(iterations, options.max_iterations);

    const std::vector<Index> rest = run.rules.eligible_without(X.indices());
    const Scan<P> drawn = run.scan(random.sample(rest, c), r);
    const std::vector<Index> entering = hard_threshold(signs, drawn.correlations, s);
    const ColumnsOf<P> fresh = run.columns(drawn, entering);  // S = X ∪ fresh, Eq. 8

    Vector p(w.size() + fresh.size()), x(p.size());  // p = −g/2
    p << X.block().transpose_times(r), drawn.correlations(entering);
    const double step = minimising_step(p, [&](const Vector& v) -> Vector {
      return X.block().times(v.head(w.size())) + fresh.times(v.tail(fresh.size()));
    });
    x << w, Vector::Zero(fresh.size());
    x += (options.step == StepLength::Paper ? 2 : 1) * step * p;  // Eq. 9
    for (Index k = 0; k < w.size(); ++k)
      if (run.rules.must_keep(X.block().index(k))) x[k] = std::numeric_limits<double>::infinity();
    const auto [kept, chosen] = split_at(w.size(), hard_threshold(signs, x, s));

    std::vector<Index> next = sorted_union(indices_at(X.block(), kept), indices_at(fresh, chosen));
    const bool same = chosen.empty() && static_cast<Index>(kept.size()) == X.size();
    if (entering.empty() || same || next == previous) {
      if (static_cast<Index>(rest.size()) <= c) return finish(run.status_at_size(), "no column improves the selection");
      if (++unchanged >= options.patience) return finish(Status::Stagnated, "repeated draws change nothing");
      continue;
    }
    unchanged = 0;
    previous = std::move(next);
    X.keep(kept);
    X.append(fresh.subset(chosen));
    w = X.fit(signs, all_positions(X.size())).w;  // Eq. 10
    r = run.record(X, w);
    run.drop_unused(X, w);
  }
  if (run.met(options.tolerance)) return finish(Status::Converged, "target error reached");
  return finish(Status::MaxIterations, "limit of iterations reached");
}

template <FittingProblem P>
Selection NnHtp::operator()(const P& problem, const SelectionRequest& request) const {
  if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
  return hard_thresholding_pursuit(*this, Signs::NonNegative, problem, request);
}

template <FittingProblem P>
Selection Htp::operator()(const P& problem, const SelectionRequest& request) const {
  if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
  return hard_thresholding_pursuit(*this, Signs::Any, problem, request);
}

static_assert(SubsetSelector<NnHtp> && SubsetSelector<Htp>);

}  // namespace supple
