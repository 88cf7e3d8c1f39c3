#pragma once
/// \file How far a displacement is from a subspace.

#include <core/types.hpp>

#include <cmath>

namespace supple::test {

/// Part of u (3n) outside the span of an M-orthonormal basis, relative to u, in the mass norm.
template <typename Basis, typename System>
double outside(const Basis& basis, const System& system, const Vector& u) {
  const auto weighted = [&](Vector v) {
    for (Index i = 0; i < v.size(); ++i) v[i] *= system.nodal_mass()[i / 3];
    return v;
  };
  if (u.isZero(0)) return 0;  // in every span
  Vector rest = u;
  for (int pass = 0; pass < 2; ++pass) rest -= basis.reconstruct(basis.project(weighted(rest)));
  return std::sqrt(rest.dot(weighted(rest)) / u.dot(weighted(u)));
}

/// The farthest column of U.
template <typename Basis, typename System>
double outside(const Basis& basis, const System& system, const Matrix& U) {
  double farthest = 0;
  for (Index j = 0; j < U.cols(); ++j) farthest = std::max(farthest, outside(basis, system, Vector(U.col(j))));
  return farthest;
}

}  // namespace supple::test
