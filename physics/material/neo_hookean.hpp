#pragma once
/// \file Neo-Hookean solids: the classical one, and one that survives inversion.

#include <physics/material/materials.hpp>

#include <array>
#include <limits>

namespace supple {

/// Compressible neo-Hookean: ψ = μ/2 (I₁ − 3) − μ ln J + λ/2 (ln J)², I₁ = tr FᵀF, J = det F. Lamé's parameters at
/// rest. Undefined for J ≤ 0: the energy is +∞ there, and stress and tangent are NaN.
/// \see Bonet & Wood 2008, "Nonlinear Continuum Mechanics for Finite Element Analysis", Eq. 6.27.
template <typename Real = double>
struct NeoHookean {
  Real lambda, mu;  ///< [Pa]
  static constexpr std::array parameter_names{"lambda", "mu"};

  /// \throws std::invalid_argument as m.check().
  static NeoHookean from(const IsotropicModuli& m) {
    m.check();
    return {m.lame(), m.shear()};
  }

  Real energy(const Matrix3<Real>& F) const {
    using std::log;
    const Real J = determinant(F), log_J = log(J);
    const Real psi = mu * (first_invariant_beyond_volume(green_strain(F), J) + (J - Real(1) - log_J)) +
                     Real(0.5) * lambda * log_J * log_J;
    return where_positive(J, psi, Real(std::numeric_limits<double>::infinity()));
  }
  Matrix3<Real> stress(const Matrix3<Real>& F) const {
    using std::log;
    const Real J = determinant(F);
    const Real pressure = where_positive(J, (lambda * log(J) - mu) / J, Real(std::numeric_limits<double>::quiet_NaN()));
    return F * mu + cofactor(F) * pressure;
  }
};

/// Stable neo-Hookean: ψ = μ′/2 (I₁ − 3) + λ′/2 (J − α)² − μ′/2 ln((I₁ + 1) / 4) − λ′/2 (1 − α)², α = 1 + ¾ μ′/λ′, with
/// μ′ = 4/3 μ and λ′ = λ + 5/6 μ of Lamé's parameters λ, μ at rest. Defined and smooth everywhere, and an
/// inverted element is pushed back; the constants make ψ(I) = 0.
/// \see Smith, de Goes, Kim 2018, "Stable Neo-Hookean Flesh Simulation", Eq. 14 and Sec. 3.4.
template <typename Real = double>
struct StableNeoHookean {
  Real lambda, mu;  ///< λ′, μ′ [Pa]
  static constexpr std::array parameter_names{"lambda", "mu"};

  /// \throws std::invalid_argument as m.check().
  static StableNeoHookean from(const IsotropicModuli& m) {
    m.check();
    return {m.lame() + 5.0 / 6 * m.shear(), 4.0 / 3 * m.shear()};  // both positive, for any ν
  }

  Real energy(const Matrix3<Real>& F) const {
    using std::log;
    const Matrix3<Real> E = green_strain(F);
    const Real J = determinant(F), j = J - Real(1), w = Real(1) + Real(0.5) * E.trace();  // ¼ (I₁ + 1)
    return mu * (Real(0.75) * first_invariant_beyond_volume(E, J) + Real(0.5) * (w - Real(1) - log(w))) +
           Real(0.5) * lambda * j * j;
  }
  Matrix3<Real> stress(const Matrix3<Real>& F) const {
    const Real I1 = F.squaredNorm(), one = Real(1);
    return F * (mu * (one - one / (I1 + one))) + cofactor(F) * (lambda * (determinant(F) - alpha()));
  }

 private:
  Real alpha() const { return Real(1) + Real(0.75) * mu / lambda; }
};

}  // namespace supple
