#pragma once
/// \file Forces averaged over the straight way between two states, whose work is the difference of their energies.

#include <physics/system/dynamical_system.hpp>

#include <array>
#include <numbers>

namespace supple {

/// Gauss's two points on the way from u_0 to u_1, as shares of it; each weighs a half. They integrate cubic polynomials
/// exactly.
inline constexpr std::array<double, 2> gauss_points{0.5 - 0.5 * std::numbers::inv_sqrt3,
                                                    0.5 + 0.5 * std::numbers::inv_sqrt3};

/// f̄ = ½ Σ_g f(u_0 + τ_g Δ) with Δ = u_1 − u_0 [N]. Its work f̄ · Δ is E(u_1) − E(u_0), exactly where E is a polynomial of
/// degree four along the way, as St. Venant–Kirchhoff's energy is; else but for O(‖Δ‖⁵).
template <DynamicalSystem System>
void mean_force(const System& system, VectorIn u_0, VectorIn u_1, VectorOut f) {
  if constexpr (requires { system.mean_force(u_0, u_1, f); }) {
    system.mean_force(u_0, u_1, f);
  } else {
    Vector second(f.size());
    system.force(u_0 + gauss_points[0] * (u_1 - u_0), f);
    system.force(u_0 + gauss_points[1] * (u_1 - u_0), second);
    f = 0.5 * (f + second);
  }
}

/// ∂f̄/∂u_1 = ½ Σ_g τ_g K(u_0 + τ_g Δ) [N/m].
template <DynamicalSystem System>
void mean_stiffness(const System& system, VectorIn u_0, VectorIn u_1, typename System::MatrixType& K) {
  if constexpr (requires { system.mean_stiffness(u_0, u_1, K); }) {
    system.mean_stiffness(u_0, u_1, K);
  } else {
    typename System::MatrixType second;
    system.stiffness(u_0 + gauss_points[0] * (u_1 - u_0), K);
    system.stiffness(u_0 + gauss_points[1] * (u_1 - u_0), second);
    K *= 0.5 * gauss_points[0];
    K += 0.5 * gauss_points[1] * second;
  }
}

/// f̄ of terms that are evaluated together, such as a TermPack: from u on, along du.
template <typename Terms, typename Field>
Field mean_force_of(const Terms& terms, const Field& u, const Field& du) {
  using Real = typename Field::Scalar;
  Field f = terms.force(u + Real(gauss_points[0]) * du);
  f += terms.force(u + Real(gauss_points[1]) * du);
  return Real(0.5) * f;
}
/// Their ∂f̄/∂u_1.
template <typename Terms, typename Field>
auto mean_stiffness_of(const Terms& terms, const Field& u, const Field& du) {
  using Real = typename Field::Scalar;
  LocalMatrix<Field::RowsAtCompileTime, Real> K =
      Real(0.5 * gauss_points[0]) * terms.stiffness(u + Real(gauss_points[0]) * du);
  K += Real(0.5 * gauss_points[1]) * terms.stiffness(u + Real(gauss_points[1]) * du);
  return K;
}

/// ½ Σ_g E(u_0 + τ_g Δ) / τ_g [J], whose derivative in u_1 is f̄.
template <DynamicalSystem System>
double mean_force_potential(const System& system, VectorIn u_0, VectorIn u_1) {
  double sum = 0;
  for (const double tau : gauss_points) sum += 0.5 / tau * system.energy(u_0 + tau * (u_1 - u_0));
  return sum;
}

}  // namespace supple
