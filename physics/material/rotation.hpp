#pragma once
/// \file Rotation in a deformation gradient, and principal axes: for numbers and packs, without branches.

#include <core/pack.hpp>
#include <core/types.hpp>
#include <physics/material/materials.hpp>

#include <cmath>

namespace supple {

/// F = R S with R a rotation, also where det F < 0 (S then has one negative eigenvalue, the smallest in size).
template <typename Real>
struct Polar {
  Matrix3<Real> R;
  Real trace;  ///< tr S = max over rotations of tr(RᵀF)
};

/// The closest rotation, from the largest eigenvalue of Horn's symmetric 4 × 4 matrix: its quartic by Newton from
/// above, its eigenvector (a quaternion) as the largest column of the adjugate. Not unique, and then inaccurate, where the
/// two smallest signed singular values cancel (F squeezed to a line, or a reflected ball).
/// \see Horn 1987, "Closed-form solution of absolute orientation using unit quaternions"; Theobald 2005 for Newton.
template <typename Real>
Polar<Real> polar(const Matrix3<Real>& F) {
  using std::sqrt;
  using Matrix4 = Eigen::Matrix<Real, 4, 4>;
  const Real zero = Real(0), two = Real(2), norm2 = F.squaredNorm();
  Matrix4 H;
  H(0, 0) = F(0, 0) + F(1, 1) + F(2, 2);
  H(1, 1) = F(0, 0) - F(1, 1) - F(2, 2);
  H(2, 2) = F(1, 1) - F(0, 0) - F(2, 2);
  H(3, 3) = F(2, 2) - F(0, 0) - F(1, 1);
  H(0, 1) = H(1, 0) = F(2, 1) - F(1, 2);
  H(0, 2) = H(2, 0) = F(0, 2) - F(2, 0);
  H(0, 3) = H(3, 0) = F(1, 0) - F(0, 1);
  H(1, 2) = H(2, 1) = F(1, 0) + F(0, 1);
  H(1, 3) = H(3, 1) = F(2, 0) + F(0, 2);
  H(2, 3) = H(3, 2) = F(2, 1) + F(1, 2);

  // x⁴ − 2 ‖F‖² x² − 8 det F x + det H = 0, with det H = ‖F‖⁴ − 4 (s₁²s₂² + s₂²s₃² + s₃²s₁²) of the singular values
  const Real cofactors = cofactor(F).squaredNorm(), det = determinant(F);
  const Real c2 = Real(-2) * norm2, c1 = Real(-8) * det, c0 = norm2 * norm2 - Real(4) * cofactors;
  Real x = sqrt(Real(3) * norm2);
  const Real tiny = Real(1e-300);
  for (int k = 0; k < 12; ++k) {
    const Real x2 = x * x, value = (x2 + c2) * x2 + c1 * x + c0;
    const Real slope = (Real(4) * x2 + two * c2) * x + c1;
    x -= where_positive(slope - tiny, value / slope, zero);
  }

  // the adjugate of H − x is a multiple of q qᵀ; its largest diagonal entry has the most digits
  for (int i = 0; i < 4; ++i) H(i, i) -= x;
  const auto minor = [&](int row, int column) {
    const int r0 = row == 0 ? 1 : 0, r1 = row <= 1 ? 2 : 1, r2 = row <= 2 ? 3 : 2;
    const int k0 = column == 0 ? 1 : 0, k1 = column <= 1 ? 2 : 1, k2 = column <= 2 ? 3 : 2;
    const Real m = H(r0, k0) * (H(r1, k1) * H(r2, k2) - H(r1, k2) * H(r2, k1)) -
                   H(r0, k1) * (H(r1, k0) * H(r2, k2) - H(r1, k2) * H(r2, k0)) +
                   H(r0, k2) * (H(r1, k0) * H(r2, k1) - H(r1, k1) * H(r2, k0));
    return (row + column) % 2 == 0 ? m : -m;
  };
  Eigen::Matrix<Real, 4, 1> q;
  Real best = Real(-1);
  for (int column = 0; column < 4; ++column) {
    const Real diagonal = minor(column, column), size = where_positive(diagonal, diagonal, -diagonal);
    for (int row = 0; row < 4; ++row)
      q[row] = where_positive(size - best, minor(row, column), column == 0 ? zero : q[row]);
    best = where_positive(size - best, size, best);
  }
  const Real length2 = q.squaredNorm(), s = where_positive(length2, two / length2, zero);
  const Real w = q[0], a = q[1], b = q[2], c = q[3];
  Polar<Real> result;
  result.trace = x;
  result.R << Real(1) - s * (b * b + c * c), s * (a * b - w * c), s * (a * c + w * b),  //
      s * (a * b + w * c), Real(1) - s * (a * a + c * c), s * (b * c - w * a),          //
      s * (a * c - w * b), s * (b * c + w * a), Real(1) - s * (a * a + b * b);
  return result;
}

/// C = V diag(values) Vᵀ of a symmetric matrix.
template <typename Real>
struct PrincipalAxes {
  Vector3<Real> values;  ///< in no order
  Matrix3<Real> vectors;
};

/// By five sweeps of Jacobi's rotations, which converge quadratically: to rounding for any matrix.
/// \see Golub & Van Loan 2013, Sec. 8.5.
template <typename Real>
PrincipalAxes<Real> principal_axes(Matrix3<Real> C) {
  using std::abs, std::sqrt;
  Matrix3<Real> V;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) V(i, j) = Real(i == j ? 1 : 0);
  const Real zero = Real(0), one = Real(1);
  for (int sweep = 0; sweep < 5; ++sweep)
    for (const auto& [p, q] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)}) {
      // t = tan of the angle that makes C_pq vanish, the smaller of two: C_pq / (h + sign(h) √(h² + C_pq²))
      const Real half = Real(0.5) * (C(q, q) - C(p, p)), entry = C(p, q);
      const Real root = sqrt(half * half + entry * entry), size = abs(half) + root;
      const Real t = where_positive(size, where_positive(half, entry, -entry) / where_positive(size, size, one), zero);
      const Real cosine = one / sqrt(one + t * t), sine = t * cosine;
      const int r = 3 - p - q;
      C(p, p) -= t * entry;
      C(q, q) += t * entry;
      C(p, q) = C(q, p) = zero;
      const Real C_rp = cosine * C(r, p) - sine * C(r, q), C_rq = sine * C(r, p) + cosine * C(r, q);
      C(r, p) = C(p, r) = C_rp;
      C(r, q) = C(q, r) = C_rq;
      for (int i = 0; i < 3; ++i) {
        const Real V_p = cosine * V(i, p) - sine * V(i, q);
        V(i, q) = sine * V(i, p) + cosine * V(i, q);
        V(i, p) = V_p;
      }
    }
  return {{C(0, 0), C(1, 1), C(2, 2)}, V};
}

}  // namespace supple
