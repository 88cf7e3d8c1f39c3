#pragma once
/// \file Hyperelastic materials: energy densities ψ(F) of the deformation gradient F = I + ∇u.
///
/// A material is a class template over a scalar type Real (a number, a pack of numbers, a recorded number), an
/// aggregate of its parameters, with
///   energy(F) = ψ [J/m³], and, where they are worth writing by hand,
///   stress(F) = P = ∂ψ/∂F [Pa] (first Piola–Kirchhoff),
///   tangent(F) = ∂P/∂F [Pa], 9 × 9 over vec(F) by columns.
/// What is not there is derived, see material_response.hpp. docs/materials.md grows one from the energy alone.

#include <core/check.hpp>
#include <core/pack.hpp>
#include <core/types.hpp>
#include <physics/material/moduli.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <limits>

namespace supple {

/// What every material has.
template <typename Material, typename Real>
concept MaterialOver = requires(const Material& material, const Matrix3<Real>& F) {
  { material.energy(F) } -> std::convertible_to<Real>;
};

template <typename Real>
Real determinant(const Matrix3<Real>& F) {
  return F(0, 0) * (F(1, 1) * F(2, 2) - F(1, 2) * F(2, 1)) + F(0, 1) * (F(1, 2) * F(2, 0) - F(1, 0) * F(2, 2)) +
         F(0, 2) * (F(1, 0) * F(2, 1) - F(1, 1) * F(2, 0));
}

/// cof F = ∂ det F / ∂F = J F⁻ᵀ.
template <typename Real>
Matrix3<Real> cofactor(const Matrix3<Real>& F) {
  Matrix3<Real> cof;
  for (int i = 0; i < 3; ++i)
    for (int K = 0; K < 3; ++K) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, K1 = (K + 1) % 3, K2 = (K + 2) % 3;
      cof(i, K) = F(i1, K1) * F(i2, K2) - F(i1, K2) * F(i2, K1);
    }
  return cof;
}

/// The Green strain ½ (FᵀF − I).
template <typename Real>
Matrix3<Real> green_strain(const Matrix3<Real>& F) {
  Matrix3<Real> E = F.transpose() * F;
  for (int i = 0; i < 3; ++i) E(i, i) -= Real(1);
  return E * Real(0.5);
}

/// ½ (tr² E − tr E²).
template <typename Real>
Real second_invariant(const Matrix3<Real>& E) {
  return E(0, 0) * E(1, 1) - E(0, 1) * E(0, 1) + (E(1, 1) * E(2, 2) - E(1, 2) * E(1, 2)) +
         (E(2, 2) * E(0, 0) - E(0, 2) * E(0, 2));
}

/// ½ (I₁ − 3) − (J − 1), I₁ = tr FᵀF, of J = det F and the Green strain. Of second order in E, where it is near rest, and
/// with the digits that such a number can have: for J² = 1 + 2 tr E + 4 e₂ + 8 e₃ with the invariants of E it is
/// (tr E (J − 1) − 4 e₂ − 8 e₃) / (J + 1).
template <typename Real>
Real first_invariant_beyond_volume(const Matrix3<Real>& E, const Real& J) {
  const Real trace = E(0, 0) + E(1, 1) + E(2, 2), j = J - Real(1), one = Real(1);
  const Real second_order = trace * j - Real(4) * second_invariant(E) - Real(8) * determinant(E);
  return where_positive(J, second_order / where_positive(J, J + one, one), trace - j);
}

/// exp z − 1 − z, of second order: near zero its series, elsewhere from a given exp z − 1.
template <typename Real>
Real exp_beyond_linear(const Real& z, const Real& exp_minus_one) {
  Real series = Real(1);
  for (int k = 15; k > 2; --k) series = Real(1) + Real(1.0 / k) * z * series;
  return where_positive(Real(0.25) - z * z, Real(0.5) * z * z * series, exp_minus_one - z);
}

/// St. Venant–Kirchhoff: ψ = λ/2 (tr E)² + μ E:E with the Green strain E = ½ (FᵀF − I). Polynomial in F, so
/// defined for inverted elements, too, which it hardly resists.
template <typename Real = double>
struct StVenantKirchhoff {
  Real lambda, mu;  ///< Lamé's parameters [Pa]
  static constexpr std::array parameter_names{"lambda", "mu"};

  /// \throws std::invalid_argument as m.check().
  static StVenantKirchhoff from(const IsotropicModuli& m) {
    m.check();
    return {m.lame(), m.shear()};
  }

  Real energy(const Matrix3<Real>& F) const {
    const Matrix3<Real> E = green_strain(F);
    const Real tr = E.trace();
    return Real(0.5) * lambda * tr * tr + mu * E.squaredNorm();
  }
  Matrix3<Real> stress(const Matrix3<Real>& F) const { return F * second_piola_kirchhoff(F); }
  Matrix9<Real> tangent(const Matrix3<Real>& F) const {
    const Matrix3<Real> S = second_piola_kirchhoff(F);
    const Matrix3<Real> B = F * F.transpose();
    Matrix9<Real> C;
    for (int L = 0; L < 3; ++L)
      for (int k = 0; k < 3; ++k)
        for (int J = 0; J < 3; ++J)
          for (int i = 0; i < 3; ++i) {
            Real c = lambda * F(i, J) * F(k, L) + mu * F(i, L) * F(k, J);
            if (i == k) c += S(J, L);
            if (J == L) c += mu * B(i, k);
            C(i + 3 * J, k + 3 * L) = c;
          }
    return C;
  }

 private:
  Matrix3<Real> second_piola_kirchhoff(const Matrix3<Real>& F) const {
    const Matrix3<Real> E = green_strain(F);
    const Real pressure = lambda * E.trace();
    Matrix3<Real> S = E * (Real(2) * mu);
    for (int i = 0; i < 3; ++i) S(i, i) += pressure;
    return S;
  }
};

/// Compressible Mooney–Rivlin: ψ = c₁₀ (J^(−2/3) I₁ − 3) + c₀₁ (J^(−4/3) I₂ − 3) + κ/2 (J − 1)², with I₁ = tr
/// C, I₂ = ½ (I₁² − tr C²), C = FᵀF, J = det F. At rest it is linear elasticity with μ = 2 (c₁₀ + c₀₁) and
/// bulk modulus κ. Undefined for J ≤ 0: the energy is +∞ there, and stress and tangent are NaN.
template <typename Real = double>
struct MooneyRivlin {
  Real c10, c01;  ///< [Pa]
  Real bulk;      ///< κ [Pa]
  static constexpr std::array parameter_names{"c10", "c01", "bulk"};

  /// The constants that agree with `m` at rest; share = c₀₁ / (c₁₀ + c₀₁) in [0, 1].
  /// \throws std::invalid_argument as m.check(), and for another share.
  static MooneyRivlin from(const IsotropicModuli& m, double share = 0.25) {
    m.check();
    require(share >= 0 && share <= 1, "share of c01 is " + std::to_string(share) + ", expected 0 to 1");
    return {m.shear() / 2 * (1 - share), m.shear() / 2 * share, m.bulk()};
  }

  Real energy(const Matrix3<Real>& F) const {
    const Real J = determinant(F), one = Real(1), three = Real(3);
    const Matrix3<Real> C = F.transpose() * F;
    const Real I1 = C.trace();
    const Real I2 = Real(0.5) * (I1 * I1 - C.squaredNorm());
    const Real s = reciprocal_cbrt(J), s2 = s * s;
    // both of second order: near rest without the first, r = J^(1/3)
    const Matrix3<Real> E = green_strain(F);
    const Real r = J * s2, beyond = (r - one) * (r - one), two = Real(2);
    const Real near = Real(0.05) - E.squaredNorm(), shear = two * first_invariant_beyond_volume(E, J);
    const Real first = where_positive(near, s2 * (shear + beyond * (two * r + one)), s2 * I1 - three);
    const Real second = where_positive(
        near, s2 * s2 * (two * shear + Real(4) * second_invariant(E) - beyond * ((three * r + two) * r + one)),
        s2 * s2 * I2 - three);
    const Real psi = c10 * first + c01 * second + Real(0.5) * bulk * (J - one) * (J - one);
    return where_positive(J, psi, Real(std::numeric_limits<double>::infinity()));
  }

  Matrix3<Real> stress(const Matrix3<Real>& F) const {
    const Kinematics k(F);
    const Partials p = partials(k);
    return k.dI1 * p.I1 + k.dI2 * p.I2 + k.dJ * p.J;
  }

  Matrix9<Real> tangent(const Matrix3<Real>& F) const {
    const Kinematics kin(F);
    const Partials p = partials(kin);
    const Matrix3<Real> C = F.transpose() * F, B = F * F.transpose();
    const Real two = Real(2);
    Matrix9<Real> result;
    for (int L = 0; L < 3; ++L)
      for (int k = 0; k < 3; ++k)
        for (int J = 0; J < 3; ++J)
          for (int i = 0; i < 3; ++i) {
            // Σ ψ_ab (∂a/∂F ⊗ ∂b/∂F); ψ is linear in I₁ and I₂, so only the pairs with J are there
            Real c = p.JJ * kin.dJ(i, J) * kin.dJ(k, L) +
                     p.I1J * (kin.dI1(i, J) * kin.dJ(k, L) + kin.dJ(i, J) * kin.dI1(k, L)) +
                     p.I2J * (kin.dI2(i, J) * kin.dJ(k, L) + kin.dJ(i, J) * kin.dI2(k, L));
            // + ψ_I₁ ∂²I₁ + ψ_I₂ ∂²I₂
            c += two * p.I2 * (two * F(i, J) * F(k, L) - F(i, L) * F(k, J));
            if (i == k) c -= two * p.I2 * C(J, L);
            if (J == L) c -= two * p.I2 * B(i, k);
            if (i == k && J == L) c += two * (p.I1 + p.I2 * kin.I1);
            result(i + 3 * J, k + 3 * L) = c;
          }
    // + ψ_J ∂²J: ∂(cof F)_iJ / ∂F_kL = ε_ikb ε_JLD F_bD
    for (int i = 0; i < 3; ++i)
      for (int J = 0; J < 3; ++J) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, J1 = (J + 1) % 3, J2 = (J + 2) % 3;
        result(i + 3 * J, i1 + 3 * J1) += p.J * F(i2, J2);
        result(i + 3 * J, i2 + 3 * J2) += p.J * F(i1, J1);
        result(i + 3 * J, i1 + 3 * J2) -= p.J * F(i2, J1);
        result(i + 3 * J, i2 + 3 * J1) -= p.J * F(i1, J2);
      }
    return result;
  }

 private:
  /// J^(−1/3); NaN for J ≤ 0.
  static Real reciprocal_cbrt(const Real& J) {
    using std::cbrt;
    return where_positive(J, Real(1) / cbrt(J), Real(std::numeric_limits<double>::quiet_NaN()));
  }

  /// Invariants and their derivatives by F.
  struct Kinematics {
    Real J, I1, I2;
    Matrix3<Real> dJ, dI1, dI2;

    explicit Kinematics(const Matrix3<Real>& F) {
      dJ = cofactor(F);
      J = F(0, 0) * dJ(0, 0) + F(0, 1) * dJ(0, 1) + F(0, 2) * dJ(0, 2);
      const Matrix3<Real> C = F.transpose() * F;
      I1 = C.trace();
      I2 = Real(0.5) * (I1 * I1 - C.squaredNorm());
      dI1 = F * Real(2);
      dI2 = (F * I1 - F * C) * Real(2);
    }
  };
  /// Partial derivatives of ψ(I₁, I₂, J).
  struct Partials {
    Real I1, I2, J, I1J, I2J, JJ;
  };
  Partials partials(const Kinematics& k) const {
    const Real s = reciprocal_cbrt(k.J), s2 = s * s, s4 = s2 * s2, inverse = Real(1) / k.J;
    const Real third = Real(1.0 / 3.0), a = c10 * s2, b = c01 * s4;
    Partials p;
    p.I1 = a;
    p.I2 = b;
    p.I1J = Real(-2) * third * a * inverse;
    p.I2J = Real(-4) * third * b * inverse;
    p.J = p.I1J * k.I1 + p.I2J * k.I2 + bulk * (k.J - Real(1));
    p.JJ = (Real(10.0 / 9.0) * a * k.I1 + Real(28.0 / 9.0) * b * k.I2) * inverse * inverse + bulk;
    return p;
  }
};

static_assert(MaterialOver<StVenantKirchhoff<double>, double> && MaterialOver<StVenantKirchhoff<Pack>, Pack>);
static_assert(MaterialOver<MooneyRivlin<double>, double> && MaterialOver<MooneyRivlin<Pack>, Pack>);

}  // namespace supple
