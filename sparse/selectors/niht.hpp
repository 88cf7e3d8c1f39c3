#pragma once
/// \file Normalized iterative hard thresholding (Blumensath & Davies 2010), plain and non-negative: gradient
/// steps and thresholding, no least-squares problem is solved.

#include <core/stable_norm.hpp>
#include <sparse/selection/hard_threshold.hpp>
#include <sparse/selection/selection_run.hpp>
#include <sparse/selection/smallest_selection.hpp>

#include <tuple>

namespace supple {

/// The step μ = α ‖g_S‖² / ‖A g_S‖² along −g_S, g = ∇‖A w − b‖² = 2 Aᵀ(A w − b).
enum class NihtStep {
  Normalized,  ///< α = ½, S = supp w; halved until the squared error decreases if the support changes
  Paper,       ///< α = 1, S of Eq. 8 (von Tycowicz et al. 2013, Eq. 9)
  Exact,       ///< α = ½, S of Eq. 8
};

/// w ← H_s(w − μ g), Eq. 7: the baseline of the family, with weights of any sign. Returns the best iterate.
/// \note one Aᵀ r over the columns considered, and O(rows s) operations, an iteration.
struct Niht {
  double tolerance = 0;        ///< stop at this relative error, if the request has none
  Index max_iterations = 300;  ///< convergence is linear: more for ill-conditioned columns
  /// c/s, drawn anew in each iteration
  double candidates_per_size = std::numeric_limits<double>::infinity();
  NihtStep step = NihtStep::Normalized;
  Index patience = 10;  ///< stop after so many draws in a row that change nothing
  std::uint64_t seed = 0;
  static constexpr Signs signs = Signs::Any;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const;
};

/// The same with H_s⁺, which ignores negative entries (von Tycowicz et al. 2013, Sec. 4.1).
struct NnNiht {
  double tolerance = 0;
  Index max_iterations = 300;
  double candidates_per_size = std::numeric_limits<double>::infinity();
  NihtStep step = NihtStep::Normalized;
  Index patience = 10;
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const;
};

template <typename Options, FittingProblem P>
Selection iterative_hard_thresholding(const Options& options, Signs signs, const P& problem,
                                      const SelectionRequest& request) {
  require(options.candidates_per_size > 0, "candidates_per_size is not positive, expected 1 or more");
  SelectionRun<P> run(problem, request);
  const Index s = run.rules.size(), c = share(options.candidates_per_size, s);
  const bool normalized = options.step == NihtStep::Normalized;
  Random random(options.seed);

  WorkingSet<P> X = run.start();
  Vector w = X.fit(signs, all_positions(X.size())).w;
  Vector r = run.record(X, w);

  Index iterations = 0, unchanged = 0;
  const auto finish = [&](Status status, const char* reason) {
    return run.finish(X, status, iterations, reason, FinalWeights::AsTheyAre, signs);
  };
  for (; iterations < options.max_iterations; ++iterations) {
    if (run.met(options.tolerance)) return finish(Status::Converged, "target error reached");
    run.tell(iterations, options.max_iterations);

    const std::vector<Index> rest = run.rules.eligible_without(X.indices());
    const Scan<P> drawn = run.scan(random.sample(rest, c), r);
    const std::vector<Index> entering = hard_threshold(signs, drawn.correlations, s);
    const ColumnsOf<P> fresh = run.columns(drawn, entering);  // S = X ∪ fresh, Eq. 8
    const Index n = X.size();
    const auto A_S = [&](const Vector& v) -> Vector {
      return X.block().times(v.head(n)) + fresh.times(v.tail(fresh.size()));
    };

    Vector p(n + fresh.size()), w_S(p.size());  // p = −g/2
    p << X.block().transpose_times(r), drawn.correlations(entering);
    w_S << w, Vector::Zero(fresh.size());
    Vector along = p;  // p_S
    if (normalized && stable_norm(p.head(n)) > 1e-12 * stable_norm(p)) along.tail(fresh.size()).setZero();
    double mu = (options.step == NihtStep::Paper ? 2 : 1) * minimising_step(along, A_S);

    Vector w_next, change;
    std::vector<Index> kept, chosen;
    for (;; mu /= 1.98) {
      const Vector x = w_S + mu * p;
      Vector ranked = x;
      for (Index k = 0; k < n; ++k)
        if (run.rules.must_keep(X.block().index(k))) ranked[k] = std::numeric_limits<double>::infinity();
      const std::vector<Index> support = hard_threshold(signs, ranked, s);
      w_next = Vector::Zero(x.size());
      for (Index k : support) w_next[k] = signs == Signs::NonNegative ? std::max(x[k], 0.0) : x[k];
      std::tie(kept, chosen) = split_at(n, support);
      change = w_next - w_S;
      const bool same_support = chosen.empty() && static_cast<Index>(kept.size()) == n;
      const bool too_long = std::sqrt(mu) * A_S(change).norm() > std::sqrt(0.99) * stable_norm(change);
      if (!normalized || same_support || !too_long) break;
    }
    if (!(stable_norm(change) > 1e-12 * stable_norm(w_next))) {
      if (drawn.size() == static_cast<Index>(rest.size()))
        return finish(run.status_at_size(), "the weights do not change");
      if (++unchanged >= options.patience) return finish(Status::Stagnated, "repeated draws change nothing");
      continue;
    }
    unchanged = 0;

    X.keep(kept);
    X.append(fresh.subset(chosen));
    std::vector<Index> support = kept;
    for (Index k : chosen) support.push_back(n + k);
    w = w_next(support);
    r = run.record(X, w);
  }
  if (run.met(options.tolerance)) return finish(Status::Converged, "target error reached");
  return finish(Status::MaxIterations, "limit of iterations reached");
}

template <FittingProblem P>
Selection Niht::operator()(const P& problem, const SelectionRequest& request) const {
  if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
  return iterative_hard_thresholding(*this, Signs::Any, problem, request);
}

template <FittingProblem P>
Selection NnNiht::operator()(const P& problem, const SelectionRequest& request) const {
  if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
  return iterative_hard_thresholding(*this, Signs::NonNegative, problem, request);
}

static_assert(SubsetSelector<Niht> && SubsetSelector<NnNiht>);

}  // namespace supple
