#pragma once
/// \file Rubber by principal stretches.

#include <physics/material/rotation.hpp>

#include <array>
#include <cmath>
#include <limits>

namespace supple {

/// Compressible Ogden solid of three terms: ψ = Σ_p μ_p/α_p (λ̄₁^α_p + λ̄₂^α_p + λ̄₃^α_p − 3) + κ/2 (J − 1)² with the
/// principal stretches λᵢ and λ̄ᵢ = J^(−1/3) λᵢ. At rest μ = ½ Σ μ_p α_p, bulk modulus κ. A term without μ_p does
/// not count, whatever its α_p ≠ 0. Undefined for J ≤ 0: the energy is +∞ there, and stress and tangent are NaN.
/// \see Ogden 1972; Simo & Taylor 1991 for the form with volume split off.
template <typename Real = double>
struct Ogden {
  Real mu1, alpha1, mu2, alpha2, mu3, alpha3;  ///< μ_p [Pa], α_p
  Real bulk;                                   ///< κ [Pa]
  static constexpr std::array parameter_names{"mu1", "alpha1", "mu2", "alpha2", "mu3", "alpha3", "bulk"};

  /// Ogden's exponents for rubber, 1.3, 5 and −2, with his proportions of μ_p, scaled to the shear modulus.
  /// \throws std::invalid_argument as m.check().
  static Ogden from(const IsotropicModuli& m) {
    m.check();
    const double scale = m.shear() / (0.5 * (6.3 * 1.3 + 0.012 * 5 + 0.1 * 2));
    return {6.3 * scale, 1.3, 0.012 * scale, 5, -0.1 * scale, -2, m.bulk()};
  }

  Real energy(const Matrix3<Real>& F) const {
    const Principal p(*this, F);
    Real psi = Real(0.5) * bulk * (p.J - Real(1)) * (p.J - Real(1));
    for (int k = 0; k < 3; ++k)  // of first order the three cancel
      for (int i = 0; i < 3; ++i)
        psi += p.mu[k] / p.alpha[k] * exp_beyond_linear(Real(p.alpha[k] * p.isochoric[i]), p.excess[k][i]);
    return where_positive(p.J, psi, Real(std::numeric_limits<double>::infinity()));
  }
  /// P = F S with S = Σ sᵢ Nᵢ Nᵢᵀ, sᵢ = τᵢ / λᵢ², τᵢ = λᵢ ∂ψ/∂λᵢ.
  Matrix3<Real> stress(const Matrix3<Real>& F) const {
    const Principal p(*this, F);
    const Vector3<Real> s = p.second_piola_kirchhoff();
    return F * (p.N * s.asDiagonal() * p.N.transpose());
  }
  /// δ_ik S_JL + F ∂S/∂E Fᵀ, the material tangent in principal axes.
  Matrix9<Real> tangent(const Matrix3<Real>& F) const {
    const Principal p(*this, F);
    const Vector3<Real> s = p.second_piola_kirchhoff();
    const Matrix3<Real> S = p.N * s.asDiagonal() * p.N.transpose(), D = p.stretching(s), G = p.shearing(s, D);
    const Matrix3<Real> f = F * p.N;  // F Nₐ, and with P by columns: dP = F dS + dF S
    Matrix9<Real> C;
    for (int L = 0; L < 3; ++L)
      for (int k = 0; k < 3; ++k)
        for (int J = 0; J < 3; ++J)
          for (int i = 0; i < 3; ++i) {
            Real c = Real(0);
            for (int a = 0; a < 3; ++a)
              for (int b = 0; b < 3; ++b) {
                c += f(i, a) * p.N(J, a) * D(a, b) * f(k, b) * p.N(L, b);
                if (a != b)
                  c += Real(0.5) * G(a, b) * f(i, a) * p.N(J, b) * (f(k, a) * p.N(L, b) + f(k, b) * p.N(L, a));
              }
            if (i == k) c += S(J, L);
            C(i + 3 * J, k + 3 * L) = c;
          }
    return C;
  }

 private:
  /// The state in principal axes.
  struct Principal {
    Real J, bulk;
    std::array<Real, 3> mu, alpha;
    Vector3<Real> squares;                // λᵢ²
    Matrix3<Real> N;                      // Nᵢ by columns
    Vector3<Real> isochoric;              // ln λ̄ᵢ
    std::array<Vector3<Real>, 3> excess;  // λ̄ᵢ^α_p − 1 for each p

    Principal(const Ogden& material, const Matrix3<Real>& F)
        : bulk(material.bulk),
          mu{material.mu1, material.mu2, material.mu3},
          alpha{material.alpha1, material.alpha2, material.alpha3} {
      using std::exp, std::log;
      const Real undefined = Real(std::numeric_limits<double>::quiet_NaN());
      J = determinant(F);
      const PrincipalAxes<Real> axes = principal_axes(Matrix3<Real>(F.transpose() * F));
      squares = axes.values;
      N = axes.vectors;
      Vector3<Real> logs;  // ln λᵢ
      for (int i = 0; i < 3; ++i) logs[i] = Real(0.5) * log(where_positive(J, squares[i], undefined));
      const Real mean = (logs[0] + logs[1] + logs[2]) / Real(3);
      for (int i = 0; i < 3; ++i) isochoric[i] = logs[i] - mean;
      for (int p = 0; p < 3; ++p)
        for (int i = 0; i < 3; ++i) excess[p][i] = exp(alpha[p] * isochoric[i]) - Real(1);
    }

    /// τᵢ: Σ_p μ_p (λ̄ᵢ^α_p − mean) + κ J (J − 1).
    Vector3<Real> kirchhoff() const {
      Vector3<Real> tau = Vector3<Real>::Constant(bulk * J * (J - Real(1)));
      for (int p = 0; p < 3; ++p) {
        const Real mean = excess[p].sum() / Real(3);
        for (int i = 0; i < 3; ++i) tau[i] += mu[p] * (excess[p][i] - mean);
      }
      return tau;
    }
    Vector3<Real> second_piola_kirchhoff() const { return kirchhoff().cwiseQuotient(squares); }

    /// ∂sₐ / ∂E_bb = (∂τₐ/∂ln λ_b − 2 δ_ab τₐ) / (λₐ² λ_b²).
    Matrix3<Real> stretching(const Vector3<Real>& s) const {
      Matrix3<Real> D;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          Real d = bulk * J * (Real(2) * J - Real(1));
          for (int p = 0; p < 3; ++p) {
            const Real mean = excess[p].sum() / Real(3);
            const auto power = [&](int i) { return excess[p][i] + Real(1); };
            // ∂/∂ln λ_b of λ̄ₐ^α − mean: α ((δ_ab − ⅓) λ̄ₐ^α − (λ̄_b^α − mean of powers) / 3)
            Real part = -(power(a) + excess[p][b] - mean) / Real(3);
            if (a == b) part += power(a);
            d += mu[p] * alpha[p] * part;
          }
          if (a == b) d -= Real(2) * s[a] * squares[a];
          D(a, b) = d / (squares[a] * squares[b]);
        }
      return D;
    }
    /// 2 (sₐ − s_b) / (λₐ² − λ_b²), and its limit D_aa − D_ab where two stretches meet.
    Matrix3<Real> shearing(const Vector3<Real>& s, const Matrix3<Real>& D) const {
      using std::abs;
      Matrix3<Real> G;
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
          const Real gap = squares[a] - squares[b];
          const Real apart = abs(gap) - Real(1e-5) * (squares[a] + squares[b]);
          const Real limit = Real(0.5) * (D(a, a) + D(b, b) - D(a, b) - D(b, a));
          G(a, b) = where_positive(apart, Real(2) * (s[a] - s[b]) / where_positive(apart, gap, Real(1)), limit);
        }
      return G;
    }
  };
};

}  // namespace supple
