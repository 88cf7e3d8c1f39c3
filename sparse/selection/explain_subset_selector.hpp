#pragma once
/// \file Check that says in words, as the compiler's first error, what a selector lacks.

#include <sparse/selection/subset_selector.hpp>

namespace supple {

/// True; or compilation ends at the first requirement of SubsetSelector that S does not meet, with a sentence that names
/// it. reduce() asks; ask yourself beside your selector: `static_assert(explain_subset_selector<MySelector>());`.
template <typename S>
consteval bool explain_subset_selector() {
  using P = archetype::Fitting;
  static_assert(
      requires(S & select, const P& problem, const SelectionRequest& request) { select(problem, request); },
      "SubsetSelector: `template <FittingProblem P> Selection operator()(const P& problem, const "
      "SelectionRequest& request) const` is missing, or does not take every FittingProblem");
  static_assert(
      requires(const S& select, const P& problem, const SelectionRequest& request) { select(problem, request); },
      "SubsetSelector: operator()(problem, request) must be const");
  static_assert(SubsetSelectorFor<S, P>, "SubsetSelector: operator()(problem, request) must return a Selection");
  return true;
}

}  // namespace supple
