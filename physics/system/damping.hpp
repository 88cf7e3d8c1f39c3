#pragma once
/// \file Rayleigh damping by its two coefficients.

namespace supple {

/// Linear Rayleigh damping D = α M + β K(0), with the stiffness at rest.
struct RayleighDamping {
  double alpha = 0;  ///< [1/s], damps slow motions
  double beta = 0;   ///< [s], damps fast ones
};

}  // namespace supple
