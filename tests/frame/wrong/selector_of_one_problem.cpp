// SubsetSelector: `template <FittingProblem P> Selection operator()(const P& problem, const SelectionRequest& request) const` is missing
#include <sparse/selection/explain_subset_selector.hpp>

using namespace supple;

struct FirstColumns {
  Selection operator()(const DenseProblem& problem, const SelectionRequest& request) const;
};
static_assert(explain_subset_selector<FirstColumns>());
