#include <physics/materials.hpp>
#include <tests/support/near.hpp>
#include <tests/support/random_vectors.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;
constexpr IsotropicModuli moduli{.young = 2e5, .poisson = 0.35};
constexpr double rounding = 1e-12;  // relative to Young's modulus: formulas of a few hundred operations
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// det > 0: a rotation times I + a random matrix of norm < 1.
Mat3 random_gradient(std::uint64_t seed) {
  return random_rotation(seed) * (Mat3::Identity() + Mat3(random_matrix(3, 3, 0.3, seed + 1000)));
}
Vector vec(const Mat3& A) {
  return Eigen::Map<const Vector>(A.data(), 9);
}

template <typename Material>
class MaterialTest : public testing::Test {
 protected:
  const Material material = Material::from(moduli);
};
using Materials = testing::Types<StVenantKirchhoff<double>, MooneyRivlin<double>>;
TYPED_TEST_SUITE(MaterialTest, Materials);

TYPED_TEST(MaterialTest, RestAndRotationsAreFreeOfEnergyAndStress) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Mat3 R = seed == 0 ? Mat3(Mat3::Identity()) : random_rotation(seed);
    EXPECT_NEAR(this->material.energy(R), 0, rounding * moduli.young);
    EXPECT_TRUE(is_near(this->material.stress(R), Mat3::Zero(), rounding * moduli.young));
  }
}

TYPED_TEST(MaterialTest, RestTangentIsLinearElasticityOfTheStatedModuli) {
  Matrix9<double> C;
  for (int i = 0; i < 3; ++i)
    for (int J = 0; J < 3; ++J)
      for (int k = 0; k < 3; ++k)
        for (int L = 0; L < 3; ++L)
          C(i + 3 * J, k + 3 * L) = moduli.lame() * (i == J) * (k == L) +
                                    moduli.shear() * ((i == k) * (J == L) + (i == L) * (J == k));
  EXPECT_TRUE(is_near(this->material.tangent(Mat3::Identity()), C, rounding * moduli.young));
}

// Step ε^⅓: truncation h² and rounding / h are both near 1e-10, times constants of the material.
TYPED_TEST(MaterialTest, StressIsTheGradientOfTheEnergyAndTangentThatOfTheStress) {
  const double h = 1e-5;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Mat3 F = random_gradient(seed);
    ASSERT_GT(F.determinant(), 0.05);
    Mat3 stress;
    Matrix9<double> tangent;
    for (int j = 0; j < 9; ++j) {
      Mat3 plus = F, minus = F;
      plus.data()[j] += h;
      minus.data()[j] -= h;
      stress.data()[j] = (this->material.energy(plus) - this->material.energy(minus)) / (2 * h);
      tangent.col(j) = vec(this->material.stress(plus) - this->material.stress(minus)) / (2 * h);
    }
    const Matrix9<double> C = this->material.tangent(F);
    EXPECT_TRUE(is_near(this->material.stress(F), stress, 1e-7 * C.norm())) << "seed " << seed;
    EXPECT_TRUE(is_near(C, tangent, 1e-7 * C.norm())) << "seed " << seed;
    EXPECT_TRUE(is_near(C, C.transpose(), rounding * C.norm())) << "seed " << seed;
  }
}

TYPED_TEST(MaterialTest, IsObjectiveAndIsotropic) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Mat3 F = random_gradient(seed), R = random_rotation(seed + 50);
    const double psi = this->material.energy(F);
    const Mat3 P = this->material.stress(F);
    const double tolerance = rounding * this->material.tangent(F).norm();
    EXPECT_NEAR(this->material.energy(R * F), psi, tolerance);
    EXPECT_TRUE(is_near(this->material.stress(R * F), R * P, tolerance));
    EXPECT_NEAR(this->material.energy(F * R), psi, tolerance);
    EXPECT_TRUE(is_near(this->material.stress(F * R), P * R, tolerance));
    EXPECT_TRUE(is_near(P * F.transpose(), F * P.transpose(), tolerance));  // Cauchy's stress is symmetric
    EXPECT_GT(psi, 0);
  }
}

TYPED_TEST(MaterialTest, FromRefusesModuliThatNoMaterialHas) {
  for (const IsotropicModuli& bad :
       {IsotropicModuli{0, 0.3}, {-1, 0.3}, {nan, 0.3}, {infinity, 0.3}, {1e5, 0.5}, {1e5, -1}, {1e5, nan}}) {
    EXPECT_THROW(bad.check(), std::invalid_argument) << bad.young << ' ' << bad.poisson;
    EXPECT_THROW((void)TypeParam::from(bad), std::invalid_argument) << bad.young << ' ' << bad.poisson;
  }
  for (const IsotropicModuli& good : {IsotropicModuli{1e-3, 0.499}, {1e12, -0.9}, {1, 0}}) {
    EXPECT_NO_THROW(good.check());
    EXPECT_NO_THROW((void)TypeParam::from(good));
  }
}

TEST(IsotropicModuli, ConversionsAgree) {
  EXPECT_NEAR(moduli.bulk(), moduli.lame() + 2 * moduli.shear() / 3, 1e-15 * moduli.bulk());
  EXPECT_NEAR(moduli.young,
              moduli.shear() * (3 * moduli.lame() + 2 * moduli.shear()) / (moduli.lame() + moduli.shear()),
              1e-15 * moduli.young);
}

TEST(StVenantKirchhoffMaterial, FollowsTheClosedFormsOfStretchAndDilation) {
  const double lambda = moduli.lame(), mu = moduli.shear();
  const StVenantKirchhoff<double> material{lambda, mu};
  for (const double s : {0.3, 0.9, 1.0, 1.7, -0.5}) {  // inverted, too
    const double E = (s * s - 1) / 2;
    const Mat3 uniaxial = Point(s, 1, 1).asDiagonal(), dilation = s * Mat3::Identity();
    EXPECT_NEAR(material.energy(uniaxial), (lambda / 2 + mu) * E * E, rounding * moduli.young);
    EXPECT_TRUE(is_near(material.stress(uniaxial),
                        Point(s * (lambda + 2 * mu) * E, lambda * E, lambda * E).asDiagonal().toDenseMatrix(),
                        rounding * moduli.young));
    EXPECT_NEAR(material.energy(dilation), (4.5 * lambda + 3 * mu) * E * E, rounding * moduli.young);
    EXPECT_TRUE(is_near(material.stress(dilation), s * (3 * lambda + 2 * mu) * E * Mat3::Identity(),
                        rounding * moduli.young));
  }
}

TEST(MooneyRivlinMaterial, FollowsTheClosedFormsOfDilationStretchAndShear) {
  const MooneyRivlin<double> material{.c10 = 3e4, .c01 = 1e4, .bulk = 5e5};
  const double tolerance = rounding * material.bulk;
  for (const double s : {0.7, 0.95, 1.0, 1.3}) {
    const double J = s * s * s;  // a dilation has no isochoric part
    const Mat3 dilation = s * Mat3::Identity();
    EXPECT_NEAR(material.energy(dilation), material.bulk / 2 * (J - 1) * (J - 1), tolerance);
    EXPECT_TRUE(is_near(material.stress(dilation), material.bulk * (J - 1) * s * s * Mat3::Identity(),
                        10 * tolerance));

    // uniaxial at J = 1: Mooney's σ₁ − σ₂ = 2 (s² − 1/s) (c₁₀ + c₀₁/s)
    const Mat3 uniaxial = Point(s, 1 / std::sqrt(s), 1 / std::sqrt(s)).asDiagonal();
    const Mat3 sigma = material.stress(uniaxial) * uniaxial.transpose();
    EXPECT_NEAR(material.energy(uniaxial),
                material.c10 * (s * s + 2 / s - 3) + material.c01 * (2 * s + 1 / (s * s) - 3), tolerance);
    EXPECT_NEAR(sigma(0, 0) - sigma(1, 1), 2 * (s * s - 1 / s) * (material.c10 + material.c01 / s),
                10 * tolerance);

    const double gamma = 3 * (s - 1);  // simple shear: τ = 2 (c₁₀ + c₀₁) γ, linear
    Mat3 shear = Mat3::Identity();
    shear(0, 1) = gamma;
    const Mat3 tau = material.stress(shear) * shear.transpose();
    EXPECT_NEAR(tau(0, 1), 2 * (material.c10 + material.c01) * gamma, 10 * tolerance);
  }
}

TEST(MooneyRivlinMaterial, IsUndefinedForInvertedAndFlatElements) {
  const auto material = MooneyRivlin<double>::from(moduli);
  for (const double s : {0.0, -1e-3, -1.0}) {
    const Mat3 F = Point(s, 1, 1.2).asDiagonal();
    EXPECT_EQ(material.energy(F), infinity) << s;
    EXPECT_FALSE(material.stress(F).allFinite()) << s;
    EXPECT_FALSE(material.tangent(F).allFinite()) << s;
  }
  EXPECT_GT(material.energy(Point(1e-4, 1, 1).asDiagonal().toDenseMatrix()), 40 * moduli.young)
      << "a barrier, though a weak one, on the way there";

  // in a pack only the lane that is inverted
  const auto packed = MooneyRivlin<Pack>{material.c10, material.c01, material.bulk};
  Matrix3<Pack> F = Mat3(Mat3::Identity()).cast<Pack>();
  F(0, 0).set(3, -1);
  const Pack psi = packed.energy(F);
  const Matrix3<Pack> P = packed.stress(F);
  for (int lane = 0; lane < Pack::size; ++lane) {
    EXPECT_EQ(std::isinf(psi[lane]), lane == 3);
    EXPECT_EQ(std::isnan(P(0, 0)[lane]), lane == 3);
  }
}

TEST(MooneyRivlinMaterial, ShareSplitsTheShearModulus) {
  for (const double share : {0.0, 0.25, 1.0}) {
    const auto material = MooneyRivlin<double>::from(moduli, share);
    EXPECT_NEAR(2 * (material.c10 + material.c01), moduli.shear(), 1e-15 * moduli.shear());
    EXPECT_NEAR(material.c01, share * moduli.shear() / 2, 1e-15 * moduli.shear());
    EXPECT_EQ(material.bulk, moduli.bulk());
  }
  for (const double share : {-0.1, 1.1, nan})
    EXPECT_THROW((void)MooneyRivlin<double>::from(moduli, share), std::invalid_argument) << share;
}

}  // namespace
}  // namespace supple::test
