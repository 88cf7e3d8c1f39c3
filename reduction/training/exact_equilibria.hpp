#pragma once
/// \file Equilibria of all components in a subspace, what those of a fitted object are judged by.

#include <core/types.hpp>

#include <functional>

namespace supple {

/// States of a subspace, and how near to its end the search for each is.
struct ExactEquilibria {
  Matrix Q;          ///< d × T
  Vector residuals;  ///< T, ‖Δq‖ / ‖q‖ of the last step; NaN where forces were not finite
};

/// Searches for F̄(q) + k q = λ near the equilibria of a fitted object, for all loads at once: forces of all components
/// are cheap for many states together, their tangents are not. By the BFGS method from the inverses of the fitted
/// tangents; ends each search with a step below `tolerance` of the way from its start.
/// \param forces   F̄ of d × T states.  \param tangent  K̃(q) of the fitted object, d × d.
/// \param loads    Λ, d × T.           \param springs  k, d × d, or empty.
/// \param start    d × T, equilibria of the fitted object.
ExactEquilibria exact_equilibria(const std::function<Matrix(MatrixIn Q)>& forces,
                                 const std::function<Matrix(VectorIn q)>& tangent, const Matrix& loads,
                                 const Matrix& springs, const Matrix& start, double tolerance = 0.01,
                                 Index max_evaluations = 60);

}  // namespace supple
