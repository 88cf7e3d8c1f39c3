#pragma once
/// \file Empirical cubature (Hernández et al. 2017).

#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selectors/nn_omp.hpp>
#include <sparse/selectors/row_compression.hpp>

namespace supple {

/// Empirical cubature method: replaces the rows of A by an orthonormal basis of its row space, as many as
/// columns are wanted, and picks the best direction among all columns until the fit of that basis is exact;
/// then fits the weights to all rows. Selects s columns for s basis rows.
/// \note two passes over all columns, 2 (s + 10) numbers a column of memory.
/// \see Hernández, Caicedo & Ferrer 2017, Dimensional hyper-reduction of nonlinear finite element models
/// via empirical cubature; docs/selectors.md for differences.
struct Ecm {
  double tolerance = 0;    ///< stop at this relative error on the basis
  Index num_modes = 0;     ///< rows of the basis; 0: s
  std::uint64_t seed = 0;  ///< of the randomised singular value decomposition

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(num_modes >= 0, "num_modes is " + std::to_string(num_modes) + ", expected 0 (automatic) or more");
    if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
    const Stopwatch stopwatch;
    const SelectionRules rules(request, problem.cols(), problem.rhs());
    const Index modes = std::min(num_modes > 0 ? num_modes : rules.size(), problem.rows());
    return select_on_rows(whitened_rows(modes, seed, problem, rules.eligible()),
                          NnOmp{.tolerance = tolerance, .seed = seed}, problem, request, stopwatch);
  }
};

static_assert(SubsetSelector<Ecm>);

}  // namespace supple
