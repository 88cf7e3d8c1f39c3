#include <core/check.hpp>
#include <physics/material/shell_material.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace supple {

ShellMaterial ShellMaterial::from(const IsotropicModuli& moduli, double thickness) {
  moduli.check();
  require(std::isfinite(thickness) && thickness > 0,
          "the thickness of the shell is " + std::to_string(thickness) + " m, expected > 0");
  const double E = moduli.young, nu = moduli.poisson, h = thickness;
  const double D = E * h * h * h / (12 * (1 - nu * nu));
  const double nu_m = std::max(nu, 1.0 / 3.0);
  return {.bending = D / 6,
          .stretch = 4 * E * h / (1 + nu_m),
          .area = E * h * std::max(3 * nu_m - 1, 0.0) / (2 * (1 - nu_m * nu_m))};  // no −0 by rounding
}

void ShellMaterial::check() const {
  require(std::isfinite(bending) && bending >= 0,
          "the bending coefficient of a shell is " + std::to_string(bending) + " J, expected >= 0");
  require(std::isfinite(stretch) && stretch > 0,
          "the stretch coefficient of a shell is " + std::to_string(stretch) + " N/m, expected > 0");
  require(std::isfinite(area) && area >= 0,
          "the area coefficient of a shell is " + std::to_string(area) + " N/m, expected >= 0");
}

}  // namespace supple
