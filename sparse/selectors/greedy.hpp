#pragma once
/// \file Growth of a selection column by column: the loop that the greedy selectors share.

#include <sparse/nnls/pruning.hpp>
#include <sparse/selection/hard_threshold.hpp>
#include <sparse/selection/selection_run.hpp>

namespace supple {

/// By what a column is judged against the residual.
enum class Measure { Cosine, Correlation };  // a_jᵀ r / ‖a_j‖, a_jᵀ r

struct Growth {
  double tolerance;
  Index candidates;    ///< drawn anew in each step
  Index batch;         ///< columns added in each step
  Index largest_size;  ///< to grow to before pruning, if that is more than s
  Measure measure;
  std::uint64_t seed;
};

/// Adds the best `batch` of `candidates` random columns to the working set and refits by NNLS, until the set
/// has its size, the error its target, or nothing improves; then prunes to s if the set has outgrown that.
template <FittingProblem P>
Selection grow(const Growth& growth, const P& problem, const SelectionRequest& request) {
  SelectionRun<P> run(problem, request);
  const Index s = run.rules.size(), n = static_cast<Index>(run.rules.eligible().size());
  const Index largest_size = std::clamp(growth.largest_size, s, n);
  const Index max_iterations = 5 * largest_size + 50, patience = 10;
  Random random(growth.seed);

  WorkingSet<P> S = run.start();
  Vector w = S.fit();
  Vector r = run.record(S, w);
  run.drop_unused(S, w);

  Index iterations = 0, unchanged = 0;
  // Joined without effect since the last progress: to rounding these depend on the others.
  std::vector<Index> barred;
  const auto finish = [&](Status status, const char* reason) {
    if (S.size() > s) {
      w = S.fit_on(prune(S.gram(), w, s, run.must_keep(S)));
      run.record(S, w);
    }
    return run.finish(S, status, iterations, reason);
  };
  for (; iterations < max_iterations; ++iterations) {
    if (run.met(growth.tolerance)) return finish(Status::Converged, "target error reached");
    if (S.size() >= largest_size) return finish(run.status_at_size(), "size reached");
    run.tell(S.size(), largest_size);

    const std::vector<Index> rest = run.rules.eligible_without(sorted_union(S.indices(), barred));
    const Scan<P> drawn = run.scan(random.sample(rest, growth.candidates), r);
    const Vector values = growth.measure == Measure::Cosine ? drawn.cosines() : drawn.correlations;
    const std::vector<Index> entering = largest_positive(values, std::min(growth.batch, largest_size - S.size()));
    if (entering.empty()) {
      if (drawn.size() == static_cast<Index>(rest.size()))
        return finish(run.status_at_size(), "no column improves the fit");
      if (++unchanged >= patience) return finish(Status::Stagnated, "repeated draws improve nothing");
      continue;
    }
    for (Index k : entering) barred.push_back(drawn.indices[k]);
    S.append(run.columns(drawn, entering));
    w = S.fit();
    const double before = r.norm();
    r = run.record(S, w);
    if (r.norm() < before) {
      barred.clear();
      unchanged = 0;
    }
    run.drop_unused(S, w);
  }
  return finish(Status::MaxIterations, "limit of iterations reached");
}

}  // namespace supple
