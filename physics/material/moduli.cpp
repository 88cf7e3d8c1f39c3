#include <core/check.hpp>
#include <physics/material/moduli.hpp>

#include <cmath>
#include <string>

namespace supple {

void IsotropicModuli::check() const {
  require(std::isfinite(young) && young > 0, "Young's modulus is " + std::to_string(young) + " Pa, expected > 0");
  require(poisson > -1 && poisson < 0.5, "Poisson's ratio is " + std::to_string(poisson) +
                                             ", expected between -1 and 0.5 (0.5, incompressible, excluded)");
}

}  // namespace supple
