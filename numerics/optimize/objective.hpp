#pragma once
/// \file Objectives and equations as nonlinear solvers see them, limits and reports of a solve.

#include <core/report.hpp>
#include <numerics/linear/block_rotations.hpp>

#include <concepts>

namespace supple {

/// φ(u) with gradient g and Hessian H. A stationary point is where ‖g‖ is small against `scale(u)`, the size
/// of the forces that have to cancel there; residuals below are ‖g‖ / scale.
template <typename O>
concept SmoothObjective = requires(O& objective, VectorIn u, VectorOut g, typename O::MatrixType& H) {
  { objective.value(u) } -> std::convertible_to<double>;
  objective.gradient(u, g);
  objective.hessian(u, H);
  { objective.scale(u) } -> std::convertible_to<double>;         // valid for the u of the last call of gradient
  { objective.metric() } -> std::convertible_to<const Vector&>;  // positive diagonal that makes H definite when added
};

/// Whether φ means something; false where g is no gradient, as a load without a potential makes it, and an objective says
/// so by `has_value()`. Newton then judges steps by ‖g‖.
template <SmoothObjective O>
bool has_value(const O& objective) {
  if constexpr (requires { objective.has_value(); })
    return objective.has_value();
  else
    return true;
}

/// How the unknowns at u have turned since rest, in blocks of three, which an objective may tell by `frames(u)`: its Hessian
/// is then near R H(0) Rᵀ. Nothing has turned where it does not.
template <SmoothObjective O>
BlockRotations frames_of(const O& objective, VectorIn u) {
  if constexpr (requires { objective.frames(u); })
    return objective.frames(u);
  else
    return {};
}

/// r(u) = 0 with the Jacobian J = ∂r/∂u, for forces that need not have a potential; `scale` as above.
template <typename E>
concept SmoothEquation = requires(E& equation, VectorIn u, VectorOut r, typename E::MatrixType& J) {
  equation.residual(u, r);
  equation.jacobian(u, J);
  { equation.scale(u) } -> std::convertible_to<double>;  // valid for the u of the last call of residual
};

/// The Hessian at rest: H(0), unless an objective tells by `rest_hessian(H)` that rest is something else.
template <SmoothObjective O>
void rest_hessian(O& objective, typename O::MatrixType& H) {
  if constexpr (requires { objective.rest_hessian(H); })
    objective.rest_hessian(H);
  else
    objective.hessian(Vector::Zero(objective.metric().size()), H);
}

/// When a solve ends.
struct SolveLimits {
  double tolerance = 1e-6;    ///< relative residual ‖g‖ / scale to reach
  Index max_iterations = 50;  ///< raise for extreme load steps; the report says when it was not enough
};

/// What a solve took. Not converging is reported here and the best iterate kept; the caller decides.
struct SolveReport : Report {
  Index tangents = 0;  ///< Hessians (Jacobians) computed and factorised
};

/// ‖g‖ / scale, 0 where ‖g‖ is.
inline double relative_residual(double norm, double scale) {
  return norm == 0 ? 0 : norm / scale;
}

}  // namespace supple
