// SubsetSelector: operator()(problem, request) must be const
#include <sparse/selection/explain_subset_selector.hpp>

using namespace supple;

struct FirstColumns {
  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request);
};
static_assert(explain_subset_selector<FirstColumns>());
