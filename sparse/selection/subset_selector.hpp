#pragma once
/// \file Concept of a best-subset selector: min ‖A w − b‖ subject to w ≥ 0, |supp w| ≤ s (von Tycowicz et
/// al. 2013, Eq. 6).

#include <sparse/problem/fitting_problem.hpp>
#include <sparse/selection/selection.hpp>

#include <concepts>
#include <cstdint>

namespace supple {

namespace archetype {
/// The least that is a FittingProblem; declared only.
struct Fitting {
  Index rows() const;
  Index cols() const;
  const Vector& rhs() const;
  void column(Index j, VectorOut out) const;
};
static_assert(FittingProblem<Fitting>);
}  // namespace archetype

/// A selector also promises, and supple::testing checks: at most s indices, ascending, each a candidate or
/// must-keep; weights > 0 (must-keep: ≥ 0); the residual in the report is that of a direct evaluation; equal
/// requests give equal bits, whatever the number of threads; no larger residual than a warm start that may be kept; with a
/// target error and no size, fewer columns than all where fewer reach it; std::invalid_argument for a request that makes
/// no sense, InputError for a column or right-hand side that is not finite.
template <typename S, typename P>
concept SubsetSelectorFor = FittingProblem<P> &&
    requires(const S& select, const P& problem, const SelectionRequest& request) {
  { select(problem, request) } -> std::same_as<Selection>;
};

template <typename S>
concept SubsetSelector = SubsetSelectorFor<S, archetype::Fitting>;

/// A selector with another seed, where it draws at random.
template <typename Selector>
Selector seeded(Selector selector, std::uint64_t seed) {
  if constexpr (requires { selector.seed = seed; }) selector.seed = seed;
  return selector;
}

}  // namespace supple
