// SubsetSelector: operator()(problem, request) must return a Selection
#include <sparse/selection/explain_subset_selector.hpp>

using namespace supple;

struct FirstColumns {
  template <FittingProblem P>
  std::vector<Index> operator()(const P& problem, const SelectionRequest& request) const;
};
static_assert(explain_subset_selector<FirstColumns>());
