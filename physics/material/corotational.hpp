#pragma once
/// \file Linear elasticity in the frame of each element's own rotation.

#include <physics/material/rotation.hpp>

#include <array>

namespace supple {

/// Corotational: ψ = μ ‖F − R‖² + λ/2 (tr(RᵀF) − 3)² with F = R S the polar decomposition into a rotation. Lamé's
/// parameters at rest. Inverted elements are pushed back; stress jumps where R does (see polar()). It hardly resists
/// large changes of volume.
/// \see Müller & Gross 2004; Stomakhin et al. 2012, "Energetically Consistent Invertible Elasticity".
template <typename Real = double>
struct Corotational {
  Real lambda, mu;  ///< [Pa]
  static constexpr std::array parameter_names{"lambda", "mu"};

  /// \throws std::invalid_argument as m.check().
  static Corotational from(const IsotropicModuli& m) {
    m.check();
    return {m.lame(), m.shear()};
  }

  Real energy(const Matrix3<Real>& F) const {
    const Polar<Real> p = polar(F);
    const Real stretch = p.trace - Real(3);
    return mu * Matrix3<Real>(F - p.R).squaredNorm() + Real(0.5) * lambda * stretch * stretch;
  }
  Matrix3<Real> stress(const Matrix3<Real>& F) const {
    const Polar<Real> p = polar(F);
    return (F - p.R) * (Real(2) * mu) + p.R * (lambda * (p.trace - Real(3)));
  }
  /// With dR = R [ω]× and (tr S − S) ω the axial vector of RᵀdF − dFᵀR.
  Matrix9<Real> tangent(const Matrix3<Real>& F) const {
    const Polar<Real> p = polar(F);
    Matrix3<Real> A = -(p.R.transpose() * F);
    for (int i = 0; i < 3; ++i) A(i, i) += p.trace;
    const Real det = determinant(A), size = A.squaredNorm();
    const Real regular = det * det - Real(1e-24) * size * size * size;  // else the rotation is not unique, and stays
    const Matrix3<Real> inverse = cofactor(A).transpose() * where_positive(regular, Real(1) / det, Real(0));
    // column (k, L): dF = e_k e_Lᵀ, RᵀdF = r e_Lᵀ with r the k-th row of R; its axial vector is e_L × r
    const Real spin = lambda * (p.trace - Real(3)) - Real(2) * mu;
    Matrix9<Real> C;
    for (int L = 0; L < 3; ++L)
      for (int k = 0; k < 3; ++k) {
        const int L1 = (L + 1) % 3, L2 = (L + 2) % 3;
        Vector3<Real> axial;
        axial[L] = Real(0);
        axial[L1] = -p.R(k, L2);
        axial[L2] = p.R(k, L1);
        const Vector3<Real> omega = inverse * axial;
        for (int J = 0; J < 3; ++J) {
          const int J1 = (J + 1) % 3, J2 = (J + 2) % 3;  // [ω]× e_J = ω × e_J
          for (int i = 0; i < 3; ++i) {
            Real c = spin * (p.R(i, J1) * omega[J2] - p.R(i, J2) * omega[J1]) + lambda * p.R(i, J) * p.R(k, L);
            if (i == k && J == L) c += Real(2) * mu;
            C(i + 3 * J, k + 3 * L) = c;
          }
        }
      }
    return C;
  }
};

}  // namespace supple
