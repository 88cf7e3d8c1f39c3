#pragma once
/// \file Test suite of what every material promises, typed. A material joins with a case and one line:
///
///     struct MyTissue {
///       static Tissue<double> make();               // any parameters
///       static constexpr bool isotropic = false;    // unless it is isotropic
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MyTissue, MaterialConformance, MyTissue);
///
/// A case that has `from(const IsotropicModuli&)` instead of make(), as FromModuli<Tissue> has, is also held to linear
/// elasticity of these moduli at rest, and must refuse moduli that no material has.
///
/// The states of the suite are F = R (I + D) with rotations R and random D, |D_ij| ≤ 0.3, det F > 0; energy, stress
/// and tangent must be finite and smooth there.

#include <physics/material/explain_material.hpp>
#include <testing/agreement.hpp>
#include <testing/random_vectors.hpp>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>

namespace supple::test {

/// The case of a material with a static from(moduli).
template <template <typename> class Material>
struct FromModuli {
  static Material<double> from(const IsotropicModuli& moduli) { return Material<double>::from(moduli); }
};

/// The promises of a material, one by one: each true, or a sentence that says what is violated.
template <template <typename> class Material>
class MaterialPromises {
 public:
  static_assert(explain_material<Material>());
  using Mat3 = Matrix3<double>;

  explicit MaterialPromises(const Material<double>& material) : material_(material) {}

  /// F = R (I + D), det F > 0.05.
  static Mat3 state(std::uint64_t seed) {
    const Mat3 F = Mat3::Identity() + Mat3(random_matrix(3, 3, 0.3, seed + 1000));
    return F.determinant() > 0.05 ? Mat3(random_rotation(seed) * F) : state(seed + 100);
  }

  /// At F = R, a rotation.
  testing::AssertionResult rest_is_free_of_energy_and_stress(const Mat3& R) const {
    const double tolerance = rounding * scale(Mat3::Identity());
    return all_hold(
        agree("material: there is energy at rest", "energy(F)", material_.energy(R), 0, tolerance, where(R)),
        agree("material: there is stress at rest", entry_of("stress(F)"), stress(material_, R), Mat3::Zero(), tolerance,
              where(R)));
  }
  testing::AssertionResult energy_is_positive_away_from_rest(const Mat3& F) const {
    const double psi = material_.energy(F);
    if (psi > 0) return testing::AssertionSuccess();
    return testing::AssertionFailure() << text("material: rest is not a minimum of the energy: energy(F): expected > 0",
                                               where(F), ", found ", psi);
  }

  /// Central differences with step ε^⅓: truncation h² and rounding / h are both near 1e-10, times constants of the
  /// material.
  testing::AssertionResult stress_is_the_gradient_of_the_energy(const Mat3& F) const {
    Mat3 differences;
    for (int j = 0; j < 9; ++j)
      differences.data()[j] = (material_.energy(moved(F, j, h)) - material_.energy(moved(F, j, -h))) / (2 * h);
    return agree("material: stress is not the gradient of the energy", gradient, stress(material_, F), differences,
                 difference_tolerance * scale(F), " by differences of the energy" + where(F));
  }
  testing::AssertionResult tangent_is_the_derivative_of_the_stress(const Mat3& F) const {
    Matrix9<double> differences;
    for (int j = 0; j < 9; ++j)
      Eigen::Map<Mat3>(differences.col(j).data()) =
          (stress(material_, moved(F, j, h)) - stress(material_, moved(F, j, -h))) / (2 * h);
    return agree("material: tangent is not the derivative of the stress", derivative, tangent(material_, F),
                 differences, difference_tolerance * scale(F), " by differences of the stress" + where(F));
  }
  testing::AssertionResult tangent_is_symmetric(const Mat3& F) const {
    const Matrix9<double> C = tangent(material_, F);
    return agree("material: tangent is not symmetric", derivative, C, C.transpose(), rounding * scale(F),
                 " as its mirror image" + where(F));
  }

  /// ψ(R F) = ψ(F) and P(R F) = R P(F): an observer who turns sees the same.
  testing::AssertionResult is_objective(const Mat3& F, const Mat3& R) const {
    return unchanged("material: is not objective (changes when the object is turned)", "R F", R * F, F,
                     R * stress(material_, F));
  }
  /// ψ(F R) = ψ(F) and P(F R) = P(F) R: no direction of the undeformed material is special.
  testing::AssertionResult is_isotropic(const Mat3& F, const Mat3& R) const {
    return unchanged("material: is not isotropic (changes when the undeformed object is turned)", "F R", F * R, F,
                     stress(material_, F) * R);
  }

  /// C = λ δ_iJ δ_kL + μ (δ_ik δ_JL + δ_iL δ_kJ) at rest.
  testing::AssertionResult is_linear_elasticity_at_rest(const IsotropicModuli& m) const {
    Matrix9<double> C;
    for (int i = 0; i < 3; ++i)
      for (int J = 0; J < 3; ++J)
        for (int k = 0; k < 3; ++k)
          for (int L = 0; L < 3; ++L)
            C(i + 3 * J, k + 3 * L) =
                m.lame() * (i == J) * (k == L) + m.shear() * ((i == k) * (J == L) + (i == L) * (J == k));
    return agree("material: is not linear elasticity of its moduli at rest", derivative,
                 tangent(material_, Mat3::Identity()), C, rounding * C.norm(),
                 text(" for Young's modulus ", m.young, " and Poisson's ratio ", m.poisson));
  }

  /// Formulas over packs, a state in each lane, are those over numbers.
  testing::AssertionResult packs_equal_numbers() const {
    std::array<Pack, num_material_parameters<Material>> parameters;
    std::ranges::copy(parameters_of(material_), parameters.begin());
    const auto packed = material_of<Material>(parameters);
    Matrix3<Pack> F;
    for (int lane = 0; lane < Pack::size; ++lane)
      for (int j = 0; j < 9; ++j) F.data()[j].set(lane, state(lane + 1).data()[j]);
    const Pack psi = packed.energy(F);
    const Matrix3<Pack> P = stress(packed, F);
    const Matrix9<Pack> C = tangent(packed, F);
    for (int lane = 0; lane < Pack::size; ++lane) {
      Mat3 P_lane;
      Matrix9<double> C_lane;
      for (int j = 0; j < 9; ++j) P_lane.data()[j] = P.data()[j][lane];
      for (int j = 0; j < 81; ++j) C_lane.data()[j] = C.data()[j][lane];
      const Mat3 F_lane = state(lane + 1);
      const auto verdict = equal_responses(text("material: lane ", lane, " of a pack differs from the same numbers"),
                                           F_lane, psi[lane], P_lane, C_lane, 10 * rounding);
      if (!verdict) return verdict;
    }
    return testing::AssertionSuccess();
  }

  /// A stress written by hand is that which differentiation of the energy gives, to rounding; a tangent that of the
  /// stress.
  testing::AssertionResult formulas_by_hand_equal_those_derived(const Mat3& F) const {
    const double tolerance = derivation_tolerance * scale(F);
    if constexpr (HasStress<Material<double>, double>) {
      const typename Derived::template FromEnergy<double> derived{parameters_of(material_)};
      const auto verdict = agree("material: stress by hand is not that derived from the energy", gradient,
                                 material_.stress(F), stress(derived, F), tolerance, where(F));
      if (!verdict) return verdict;
    }
    if constexpr (HasTangent<Material<double>, double> && HasStress<Material<double>, double>) {
      const typename Derived::template FromStress<double> derived{parameters_of(material_)};
      return agree("material: tangent by hand is not that derived from the stress", derivative, material_.tangent(F),
                   tangent(derived, F), tolerance, where(F));
    }
    return testing::AssertionSuccess();
  }

 private:
  /// The material with less written by hand.
  struct Derived {
    template <typename Real>
    struct FromEnergy {
      std::array<Real, num_material_parameters<Material>> parameters;
      Real energy(const Matrix3<Real>& F) const { return material_of<Material, Real>(parameters).energy(F); }
    };
    template <typename Real>
    struct FromStress {
      std::array<Real, num_material_parameters<Material>> parameters;
      Real energy(const Matrix3<Real>& F) const { return material_of<Material, Real>(parameters).energy(F); }
      Matrix3<Real> stress(const Matrix3<Real>& F) const { return material_of<Material, Real>(parameters).stress(F); }
    };
  };

  static constexpr double h = 1e-5;
  static constexpr double difference_tolerance = 1e-7;
  static constexpr double rounding = 1e-12;             // formulas of a few hundred operations
  static constexpr double derivation_tolerance = 1e-9;  // derivatives may cancel more

  /// The size of stresses and tangents at F [Pa].
  double scale(const Mat3& F) const { return tangent(material_, F).norm(); }

  static Mat3 moved(Mat3 F, int j, double by) {
    F.data()[j] += by;
    return F;
  }
  static std::string where(const Mat3& F) {
    return text(" at F = ", F.format(Eigen::IOFormat(6, Eigen::DontAlignCols, " ", "; ", "", "", "[", "]")));
  }
  static auto entry_of(const std::string& matrix) {
    return [matrix](Index i, Index J) { return text(matrix, "(", i, ",", J, ")"); };
  }
  static std::string gradient(Index i, Index J) { return text("∂ψ/∂F(", i, ",", J, ") = stress(F)(", i, ",", J, ")"); }
  static std::string derivative(Index row, Index column) {
    return text("tangent(F)(", row, ",", column, ") = ∂P(", row % 3, ",", row / 3, ")/∂F(", column % 3, ",", column / 3,
                ")");
  }

  testing::AssertionResult unchanged(const char* claim, const char* turned, const Mat3& F_turned, const Mat3& F,
                                     const Mat3& P_turned) const {
    const double tolerance = rounding * scale(F);
    return all_hold(agree(claim, text("energy(", turned, ")"), material_.energy(F_turned), material_.energy(F),
                          tolerance, where(F)),
                    agree(claim, entry_of(text("stress(", turned, ")")), stress(material_, F_turned), P_turned,
                          tolerance, where(F)));
  }

  testing::AssertionResult equal_responses(const std::string& claim, const Mat3& F, double psi, const Mat3& P,
                                           const Matrix9<double>& C, double relative) const {
    const double tolerance = relative * scale(F);
    return all_hold(agree(claim, "energy(F)", material_.energy(F), psi, tolerance, where(F)),
                    agree(claim, entry_of("stress(F)"), stress(material_, F), P, tolerance, where(F)),
                    agree(claim, derivative, tangent(material_, F), C, tolerance, where(F)));
  }

  Material<double> material_;
};
template <template <typename> class Material>
MaterialPromises(const Material<double>&) -> MaterialPromises<Material>;

/// Whether `from` throws std::invalid_argument for moduli that no material has, and only for those.
template <typename From>
testing::AssertionResult refuses_impossible_moduli(const From& from) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  const auto refused = [&](const IsotropicModuli& m) {
    try {
      (void)from(m);
    } catch (const std::invalid_argument&) {
      return true;
    }
    return false;
  };
  for (const IsotropicModuli& bad :
       {IsotropicModuli{0, 0.3}, {-1, 0.3}, {nan, 0.3}, {infinity, 0.3}, {1e5, 0.5}, {1e5, -1}, {1e5, nan}})
    if (!refused(bad))
      return testing::AssertionFailure() << text("material: from(young = ", bad.young, ", poisson = ", bad.poisson,
                                                 "): expected std::invalid_argument, found a material");
  for (const IsotropicModuli& good : {IsotropicModuli{1e-3, 0.499}, {1e12, -0.9}, {1, 0}})
    if (refused(good))
      return testing::AssertionFailure() << text("material: from(young = ", good.young, ", poisson = ", good.poisson,
                                                 "): expected a material, found std::invalid_argument");
  return testing::AssertionSuccess();
}

template <typename Case>
class MaterialConformance : public testing::Test {
 protected:
  static constexpr IsotropicModuli moduli{.young = 2e5, .poisson = 0.35};
  static constexpr bool has_moduli = requires { Case::from(moduli); };

  static auto make() {
    if constexpr (has_moduli)
      return Case::from(moduli);
    else
      return Case::make();
  }
  static constexpr bool is_isotropic() {
    if constexpr (requires { Case::isotropic; })
      return Case::isotropic;
    else
      return true;
  }
  /// Body over states F and rotations R.
  template <typename Body>
  static void for_states(const Body& body) {
    using Promises = decltype(MaterialPromises(make()));
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
      body(Promises::state(seed), random_rotation(seed + 50));
      if (testing::Test::HasFailure()) return;
    }
  }

  const decltype(MaterialPromises(make())) material{make()};
};
TYPED_TEST_SUITE_P(MaterialConformance);

TYPED_TEST_P(MaterialConformance, RestAndRotationsAreFreeOfEnergyAndStress) {
  EXPECT_TRUE(this->material.rest_is_free_of_energy_and_stress(Matrix3<double>::Identity()));
  this->for_states([&](const auto& F, const auto& R) {
    EXPECT_TRUE(this->material.rest_is_free_of_energy_and_stress(R));
    EXPECT_TRUE(this->material.energy_is_positive_away_from_rest(F));
  });
}

TYPED_TEST_P(MaterialConformance, StressIsTheGradientOfTheEnergy) {
  this->for_states(
      [&](const auto& F, const auto&) { EXPECT_TRUE(this->material.stress_is_the_gradient_of_the_energy(F)); });
}

TYPED_TEST_P(MaterialConformance, TangentIsTheDerivativeOfTheStressAndSymmetric) {
  this->for_states([&](const auto& F, const auto&) {
    EXPECT_TRUE(this->material.tangent_is_the_derivative_of_the_stress(F));
    EXPECT_TRUE(this->material.tangent_is_symmetric(F));
  });
}

TYPED_TEST_P(MaterialConformance, IsObjective) {
  this->for_states([&](const auto& F, const auto& R) { EXPECT_TRUE(this->material.is_objective(F, R)); });
}

TYPED_TEST_P(MaterialConformance, IsIsotropicUnlessItSaysOtherwise) {
  if (!this->is_isotropic()) GTEST_SKIP() << "not isotropic";
  this->for_states([&](const auto& F, const auto& R) { EXPECT_TRUE(this->material.is_isotropic(F, R)); });
}

TYPED_TEST_P(MaterialConformance, IsLinearElasticityOfItsModuliAtRest) {
  if constexpr (TestFixture::has_moduli) {
    for (const IsotropicModuli& m : {this->moduli, IsotropicModuli{2e5, 0.4999}, IsotropicModuli{3, 0}})
      EXPECT_TRUE(MaterialPromises(TypeParam::from(m)).is_linear_elasticity_at_rest(m));
  } else {
    GTEST_SKIP() << "states no moduli";
  }
}

TYPED_TEST_P(MaterialConformance, RefusesModuliThatNoMaterialHas) {
  if constexpr (TestFixture::has_moduli)
    EXPECT_TRUE(refuses_impossible_moduli([](const IsotropicModuli& m) { return TypeParam::from(m); }));
  else
    GTEST_SKIP() << "states no moduli";
}

TYPED_TEST_P(MaterialConformance, PacksEqualNumbers) {
  EXPECT_TRUE(this->material.packs_equal_numbers());
}

TYPED_TEST_P(MaterialConformance, FormulasByHandEqualThoseDerived) {
  this->for_states(
      [&](const auto& F, const auto&) { EXPECT_TRUE(this->material.formulas_by_hand_equal_those_derived(F)); });
}

REGISTER_TYPED_TEST_SUITE_P(MaterialConformance, RestAndRotationsAreFreeOfEnergyAndStress,
                            StressIsTheGradientOfTheEnergy, TangentIsTheDerivativeOfTheStressAndSymmetric, IsObjective,
                            IsIsotropicUnlessItSaysOtherwise, IsLinearElasticityOfItsModuliAtRest,
                            RefusesModuliThatNoMaterialHas, PacksEqualNumbers, FormulasByHandEqualThoseDerived);

}  // namespace supple::test
