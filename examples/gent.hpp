#pragma once
// A material from its energy alone: Gent's rubber, whose chains lock when they are stretched to the limit.

#include <physics/material/materials.hpp>

#include <limits>

template <typename Real>
struct Gent {
  Real mu, limit, bulk;  // shear modulus [Pa], largest I₁ − 3, bulk modulus [Pa]
  static constexpr std::array parameter_names{"mu", "limit", "bulk"};

  static Gent from(const supple::IsotropicModuli& m) {
    m.check();
    return {m.shear(), 20, m.bulk()};
  }

  Real energy(const supple::Matrix3<Real>& F) const {
    using std::log, std::pow, supple::where_positive;
    const Real J = supple::determinant(F), stretch = F.squaredNorm() * pow(J, -2.0 / 3) - Real(3);
    const Real left = Real(1) - stretch / limit;
    const Real psi = Real(-0.5) * mu * limit * log(left) + Real(0.5) * bulk * (J - Real(1)) * (J - Real(1));
    return where_positive(J, where_positive(left, psi, forbidden), forbidden);
  }

 private:
  static constexpr double forbidden = std::numeric_limits<double>::infinity();
};
