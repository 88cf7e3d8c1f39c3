#pragma once
/// \file Rayleigh damping by its two coefficients.

#include <core/types.hpp>

namespace supple {

/// Linear Rayleigh damping D = α M + β K(0), with the stiffness at rest.
struct RayleighDamping {
  double alpha = 0;  ///< [1/s], damps slow motions
  double beta = 0;   ///< [s], damps fast ones

  bool acts() const { return alpha != 0 || beta != 0; }
};

/// D v of a system [N].
template <typename System>
Vector damping_force(const System& system, const RayleighDamping& damping, VectorIn v) {
  Vector result = damping.alpha * system.mass().cwiseProduct(v);
  if (damping.beta != 0) result += damping.beta * (system.rest_stiffness() * v);
  return result;
}

}  // namespace supple
