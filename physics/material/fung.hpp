#pragma once
/// \file Soft tissue that stiffens exponentially, with fibres (Fung).

#include <physics/material/materials.hpp>

#include <array>
#include <cmath>
#include <limits>

namespace supple {

/// Fung's exponential solid, transversely isotropic about fibres of direction a:
///   ψ = c/2 (exp Q − 1) + κ/2 (J − 1)²,
///   Q = b_f E_ff² + b_t (E_ss² + E_nn² + 2 E_sn²) + 2 b_fs (E_fs² + E_fn²),
/// with the Green strain E in axes f = a, s, n. With all b equal to b it is isotropic at rest, μ = c b / 2 and
/// λ = κ. Defined for inverted elements, too; beyond Q ≈ 700 the energy is +∞.
/// \see Guccione, McCulloch, Waldman 1991, Eqs. 1 and 2; the volumetric term is a penalty.
template <typename Real = double>
struct Fung {
  Real c;                           ///< [Pa]
  Real b_fibre, b_across, b_shear;  ///< b_f, b_t, b_fs
  Real bulk;                        ///< κ [Pa]
  Real fibre_x, fibre_y, fibre_z;   ///< a, a unit vector at rest
  static constexpr std::array parameter_names{"c",    "b_fibre", "b_across", "b_shear",
                                              "bulk", "fibre_x", "fibre_y",  "fibre_z"};

  /// Isotropic at rest with these moduli, but for fibres `fibre_ratio` times as stiff against lengthening.
  /// \param stiffening  b: at a strain ε the stress has grown by exp(b ε²).
  /// \throws std::invalid_argument as m.check(), for stiffening or fibre_ratio ≤ 0, and a direction without length.
  static Fung from(const IsotropicModuli& m, double stiffening = 10, double fibre_ratio = 2,
                   const Point& fibre = Point::UnitX()) {
    m.check();
    require(stiffening > 0 && fibre_ratio > 0, "stiffening and fibre_ratio must be positive");
    require(fibre.norm() > 0, "the direction of the fibres is zero");
    const Point a = fibre.normalized();
    return {2 * m.shear() / stiffening, stiffening * fibre_ratio, stiffening, stiffening, m.lame(), a[0], a[1], a[2]};
  }

  Real energy(const Matrix3<Real>& F) const {
    using std::exp;
    const Matrix3<Real> E = green_strain(F);
    const Vector3<Real> a(fibre_x, fibre_y, fibre_z), Ea = E * a;
    const Real E_ff = a[0] * Ea[0] + a[1] * Ea[1] + a[2] * Ea[2], along = E_ff * E_ff;
    const Real shear = Ea[0] * Ea[0] + Ea[1] * Ea[1] + Ea[2] * Ea[2] - along;  // E_fs² + E_fn²
    const Real Q = b_fibre * along + b_across * (E.squaredNorm() - along - Real(2) * shear) + Real(2) * b_shear * shear;
    const Real volume = determinant(F) - Real(1);
    return Real(0.5) * c * (Q + exp_beyond_linear(Q, Real(exp(Q) - Real(1)))) + Real(0.5) * bulk * volume * volume;
  }
};

}  // namespace supple
