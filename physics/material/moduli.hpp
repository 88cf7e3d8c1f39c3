#pragma once
/// \file Young's modulus and Poisson's ratio, the two numbers of an isotropic material.

namespace supple {

/// Young's modulus [Pa] and Poisson's ratio: the linear behaviour at rest, common to all isotropic materials
/// here.
struct IsotropicModuli {
  double young = 1e5;
  double poisson = 0.4;

  double shear() const { return young / (2 * (1 + poisson)); }                           ///< μ [Pa]
  double lame() const { return young * poisson / ((1 + poisson) * (1 - 2 * poisson)); }  ///< λ [Pa]
  double bulk() const { return young / (3 * (1 - 2 * poisson)); }                        ///< κ [Pa]
  /// \throws std::invalid_argument unless young > 0 and −1 < poisson < ½.
  void check() const;
};

}  // namespace supple
