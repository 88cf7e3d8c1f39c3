#pragma once
/// \file Coefficients of a thin shell against bending and stretching.

#include <physics/material/moduli.hpp>

namespace supple {

/// The coefficients of a discrete shell: bending of hinges, stretching of edges, change of area of triangles.
struct ShellMaterial {
  double bending = 0;  ///< k_B [J], ≥ 0
  double stretch = 0;  ///< k_L [N/m], > 0
  double area = 0;     ///< k_A [N/m], ≥ 0

  /// A shell of thickness h [m] of a material with Young's modulus E and Poisson's ratio ν:
  ///   k_B = D/6,  D = E h³ / (12 (1 − ν²)),    k_L = 4 E h / (1 + ν_m),  k_A = E h (3 ν_m − 1) / (2 (1 −
  ///   ν_m²)).
  /// On meshes of equilateral triangles, small stretches are then those of plane stress with E h and
  /// ν_m = max(ν, ⅓): edges alone make an in-plane Poisson's ratio of ⅓, and less is not to be had with
  /// k_A ≥ 0. A flat sheet bent to a cylinder has the energy of the plate with E and ν, ½ D κ² an area; for
  /// other curvatures hinges behave like a plate with Poisson's ratio −⅓. \see docs/notation.md.
  /// \throws std::invalid_argument as moduli.check(), and unless h > 0.
  static ShellMaterial from(const IsotropicModuli& moduli, double thickness);

  /// \throws std::invalid_argument unless the coefficients are finite and have the signs stated above.
  void check() const;
};

}  // namespace supple
