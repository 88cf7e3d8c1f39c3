#pragma once
// A selector of one's own: looks at all components, and in each round adds a batch of those whose direction fits what
// is left best.

#include <sparse/selection/hard_threshold.hpp>
#include <sparse/selection/selection_run.hpp>

struct BatchedOmp {
  supple::Index batch = 10;

  template <supple::FittingProblem P>
  supple::Selection operator()(const P& problem, const supple::SelectionRequest& request) const {
    supple::SelectionRun<P> run(problem, request);  // checks the request, keeps the best iterate, accounts for it all
    supple::WorkingSet<P> chosen = run.start();     // must-keep components and those of an earlier selection
    supple::Vector w = chosen.fit();                // non-negative least squares
    supple::Vector left = run.record(chosen, w);    // b − A w
    supple::Index rounds = 0;
    for (; chosen.size() < run.rules.size() && !run.met(request.target_error); ++rounds) {
      const auto all = run.scan(run.rules.eligible_without(chosen.indices()), left);
      const auto best = supple::largest_positive(all.cosines(), std::min(batch, run.rules.size() - chosen.size()));
      if (best.empty()) break;
      chosen.append(run.columns(all, best));
      w = chosen.fit();
      left = run.record(chosen, w);
    }
    return run.finish(chosen, run.status_at_size(), rounds, "size or error reached, or nothing improves");
  }
};
static_assert(supple::SubsetSelector<BatchedOmp>);
