#pragma once
/// \file Second derivative of the internal force at rest.

#include <physics/system/rest_state.hpp>

#include <vector>

namespace supple {

/// H(a, b) = ∂²/∂s∂t f(s a + t b) at rest: bilinear, symmetric; H(a, b) · c is symmetric in all three. From
/// forces alone, so for any force model: H(a, b) = ½ (H(a + b, a + b) − H(a, a) − H(b, b)), and H(x, x) is
/// the limit of [f(h x) + f(−h x)] / h², extrapolated from two steps h and h / 2 (Richardson).
///
/// The step makes `size(h x)` 1/128: what the first difference leaves out is then some 1e-9 of H, and what
/// rounding of strains near 1 adds some 1e-10, times the ratio of the largest to typical gradients of x. For
/// St. Venant–Kirchhoff, where f is cubic, nothing is left out. If both steps differ by more than 1 %, or a
/// force is not finite, the step is shortened. \see docs/notation.md
class ForceCurvature {
 public:
  /// \param object  must outlive this; its rest state is an equilibrium.
  explicit ForceCurvature(const RestState& object);

  /// Largest difference of the displacements of two nodes of a component relative to their distance at rest,
  /// or largest displacement relative to the object's diameter if that is more: about the largest ‖∇x‖.
  double size(VectorIn x) const;

  /// H(x, x) [N] for x over the free unknowns. \throws SolverError if no step gives forces that agree.
  Vector operator()(VectorIn x) const;
  /// H(x, x) of each column, two at a time: eight states go through the forces together.
  Matrix squares(MatrixIn X) const;
  /// H(a, b), for a and b of about equal size; errors are relative to the larger of H(a, a) and H(b, b).
  Vector operator()(VectorIn a, VectorIn b) const;

 private:
  struct Pair {
    Index a, b;  // free numbers; −1: fixed
    double inverse_distance;
  };

  void few_squares(MatrixIn X, MatrixOut H) const;

  const RestState& object_;
  std::vector<Pair> pairs_;
  double inverse_diameter_ = 0;
};

}  // namespace supple
