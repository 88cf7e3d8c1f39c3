#pragma once
/// \file Products and lengths of 3-vectors over a number or a pack: building blocks of element formulas.

#include <core/pack.hpp>
#include <core/types.hpp>

#include <algorithm>
#include <cmath>

namespace supple::detail {

template <typename Real>
Vector3<Real> cross(const Vector3<Real>& a, const Vector3<Real>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
template <typename Real>
Real dot(const Vector3<Real>& a, const Vector3<Real>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <typename Real>
Real norm(const Vector3<Real>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
template <typename Real>
Real at_least(double bound, const Real& x) {
  using std::max;
  return max(x, Real(bound));
}

/// A straight piece between two nodes as it is now. Its square is compared with that at rest through the
/// displacements, which keeps the digits of small ones: |e|² − |ē|² = Δ · (2 e − Δ) with Δ = e − ē. A piece
/// that has collapsed to a point has no direction: unit and inverse are zero then, so that it pulls nowhere.
template <typename Real>
struct Segment {
  Vector3<Real> now, change;  ///< e, Δ [m]
  Vector3<Real> unit;         ///< e / |e|
  Real length, inverse;       ///< |e| [m], 1 / |e| [1/m]

  Segment(const Real* rest, const Real* from, const Real* to) {
    for (int i = 0; i < 3; ++i) {
      change[i] = to[i] - from[i];
      now[i] = rest[i] + change[i];
    }
    length = norm(now);
    inverse = where_positive(length, Real(1) / length, Real(0));
    unit = now * inverse;
  }

  /// |e| − |ē| [m].
  Real stretch(const Real& rest_length) const {
    return dot(change, Vector3<Real>(now + (now - change))) / (length + rest_length);
  }
  /// Entry (i, j) of the tangent of ½ k (|e| − |ē|)² by e: k (t tᵀ + (1 − |ē| / |e|) (I − t tᵀ)).
  Real spring_tangent(const Real& k, const Real& rest_length, int i, int j) const {
    const Real across = stretch(rest_length) * inverse;
    const Real along = (Real(1) - across) * unit[i] * unit[j];
    return k * (i == j ? along + across : along);
  }
};

}  // namespace supple::detail
