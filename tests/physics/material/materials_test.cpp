#include <physics/material/corotational.hpp>
#include <physics/material/fung.hpp>
#include <physics/material/material_response.hpp>
#include <physics/material/neo_hookean.hpp>
#include <physics/material/ogden.hpp>
#include <testing/material_conformance.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/rounding.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;
constexpr IsotropicModuli moduli{.young = 2e5, .poisson = 0.35};
constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// det > 0: a rotation times I + a random matrix of norm < 1.
Mat3 random_gradient(std::uint64_t seed) {
  return random_rotation(seed) * (Mat3::Identity() + Mat3(random_matrix(3, 3, 0.3, seed + 1000)));
}

/// St. Venant–Kirchhoff of which only the energy is known.
template <typename Real>
struct EnergyAlone {
  Real lambda, mu;
  static EnergyAlone from(const IsotropicModuli& m) {
    m.check();
    return {m.lame(), m.shear()};
  }
  Real energy(const Matrix3<Real>& F) const { return StVenantKirchhoff<Real>{lambda, mu}.energy(F); }
};
/// Mooney–Rivlin without its tangent.
template <typename Real>
struct StressAlone {
  Real c10, c01, bulk;
  static StressAlone from(const IsotropicModuli& m) {
    const auto [c10, c01, bulk] = MooneyRivlin<double>::from(m);
    return {c10, c01, bulk};
  }
  MooneyRivlin<Real> whole() const { return {c10, c01, bulk}; }
  Real energy(const Matrix3<Real>& F) const { return whole().energy(F); }
  Matrix3<Real> stress(const Matrix3<Real>& F) const { return whole().stress(F); }
};

struct IsotropicFung {
  static Fung<double> from(const IsotropicModuli& m) { return Fung<double>::from(m, 10, 1); }
};
struct FungWithFibres {
  static Fung<double> make() { return Fung<double>::from(moduli, 10, 4, {1, 2, -2}); }
  static constexpr bool isotropic = false;
};
using Materials = testing::Types<FromModuli<StVenantKirchhoff>, FromModuli<MooneyRivlin>, FromModuli<NeoHookean>,
                                 FromModuli<StableNeoHookean>, FromModuli<Corotational>, FromModuli<Ogden>,
                                 IsotropicFung, FungWithFibres, FromModuli<EnergyAlone>, FromModuli<StressAlone>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Every, MaterialConformance, Materials);

template <typename Case>
class SmallStrains : public testing::Test {};
using OwnLaws =
    testing::Types<FromModuli<StVenantKirchhoff>, FromModuli<MooneyRivlin>, FromModuli<NeoHookean>,
                   FromModuli<StableNeoHookean>, FromModuli<Corotational>, FromModuli<Ogden>, IsotropicFung>;
TYPED_TEST_SUITE(SmallStrains, OwnLaws);

// There is λ/2 (tr ε)² + μ ε:ε; F = R (I + ε) knows a strain to ε / |ε| only, and no law may lose more than that.
TYPED_TEST(SmallStrains, LeaveTheEnergyItsDigits) {
  for (const double poisson : {0.0, 0.35, 0.49}) {
    const IsotropicModuli m{.young = 2e5, .poisson = poisson};
    const auto material = TypeParam::from(m);
    for (const double size : {1e-3, 1e-5, 1e-7, 1e-9})
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Mat3 D = random_matrix(3, 3, size, seed), strain = 0.5 * (D + D.transpose());
        const Mat3 R = seed % 2 == 0 ? Mat3(random_rotation(seed)) : Mat3(Mat3::Identity());
        const double tr = strain.trace(), linear = 0.5 * m.lame() * tr * tr + m.shear() * strain.squaredNorm();
        // terms of third order fall out of the mean
        const double mean =
            0.5 * (material.energy(R * (Mat3::Identity() + strain)) + material.energy(R * (Mat3::Identity() - strain)));
        const double digits = 30 * std::numeric_limits<double>::epsilon() / size, fourth_order = 100 * size * size;
        const double incompressible =
            m.young / (3 * (1 - 2 * poisson)) / m.shear();  // of rounding, which changes volume
        EXPECT_NEAR(mean, linear, (digits * (1 + incompressible) + fourth_order) * linear) << poisson << ", " << size;
      }
  }
}

// Where laws go over to their other form nothing jumps: differences are the integrals of the stress (Simpson's rule).
TYPED_TEST(SmallStrains, GoOverToLargeOnesWithoutAJump) {
  const auto material = TypeParam::from(moduli);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Mat3 D = random_matrix(3, 3, 1, seed);
    const auto at = [&](double t) { return Mat3(Mat3::Identity() + t * D); };
    const auto slope = [&](double t) { return stress(material, at(t)).cwiseProduct(D).sum(); };
    for (double t = 0.02; t < 0.3; t *= 1.005) {
      const double h = 0.005 * t, rise = material.energy(at(t + h)) - material.energy(at(t));
      const double integral = h / 6 * (slope(t) + 4 * slope(t + h / 2) + slope(t + h));
      EXPECT_NEAR(rise, integral, 1e-8 * std::abs(integral) + 1e-14 * moduli.young) << t << ", " << seed;
    }
  }
}

TEST(IsotropicModuli, ConversionsAgree) {
  EXPECT_NEAR(moduli.bulk(), moduli.lame() + 2 * moduli.shear() / 3, 1e-15 * moduli.bulk());
  EXPECT_NEAR(moduli.young,
              moduli.shear() * (3 * moduli.lame() + 2 * moduli.shear()) / (moduli.lame() + moduli.shear()),
              1e-15 * moduli.young);
}

TEST(IsotropicModuli, AreRefusedWhereNoMaterialHasThem) {
  EXPECT_TRUE(refuses_impossible_moduli([](const IsotropicModuli& m) { m.check(); }));
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
    EXPECT_TRUE(
        is_near(material.stress(dilation), s * (3 * lambda + 2 * mu) * E * Mat3::Identity(), rounding * moduli.young));
  }
}

TEST(MooneyRivlinMaterial, FollowsTheClosedFormsOfDilationStretchAndShear) {
  const MooneyRivlin<double> material{.c10 = 3e4, .c01 = 1e4, .bulk = 5e5};
  const double tolerance = rounding * material.bulk;
  for (const double s : {0.7, 0.95, 1.0, 1.3}) {
    const double J = s * s * s;  // a dilation has no isochoric part
    const Mat3 dilation = s * Mat3::Identity();
    EXPECT_NEAR(material.energy(dilation), material.bulk / 2 * (J - 1) * (J - 1), tolerance);
    EXPECT_TRUE(is_near(material.stress(dilation), material.bulk * (J - 1) * s * s * Mat3::Identity(), 10 * tolerance));

    // uniaxial at J = 1: Mooney's σ₁ − σ₂ = 2 (s² − 1/s) (c₁₀ + c₀₁/s)
    const Mat3 uniaxial = Point(s, 1 / std::sqrt(s), 1 / std::sqrt(s)).asDiagonal();
    const Mat3 sigma = material.stress(uniaxial) * uniaxial.transpose();
    EXPECT_NEAR(material.energy(uniaxial),
                material.c10 * (s * s + 2 / s - 3) + material.c01 * (2 * s + 1 / (s * s) - 3), tolerance);
    EXPECT_NEAR(sigma(0, 0) - sigma(1, 1), 2 * (s * s - 1 / s) * (material.c10 + material.c01 / s), 10 * tolerance);

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

TEST(DerivedFormulas, EqualThoseWrittenByHand) {
  const auto by_hand = StVenantKirchhoff<double>::from(moduli);
  const auto derived = EnergyAlone<double>::from(moduli);
  for (const Mat3& F : {random_gradient(3), Mat3(-random_gradient(4)), Mat3(Mat3::Identity())}) {
    const double tolerance = rounding * by_hand.tangent(F).norm();
    EXPECT_TRUE(is_near(stress(derived, F), by_hand.stress(F), tolerance));
    EXPECT_TRUE(is_near(tangent(derived, F), by_hand.tangent(F), tolerance));
  }
}

TEST(NeoHookeanMaterial, FollowsTheClosedFormsOfDilationAndShear) {
  const NeoHookean<double> material{.lambda = moduli.lame(), .mu = moduli.shear()};
  for (const double s : {0.6, 1.0, 1.5}) {
    const double log_J = 3 * std::log(s);
    const Mat3 dilation = s * Mat3::Identity();
    EXPECT_NEAR(material.energy(dilation),
                material.mu * (1.5 * (s * s - 1) - log_J) + 0.5 * material.lambda * log_J * log_J,
                rounding * moduli.young);
    Mat3 shear = Mat3::Identity();  // of which the stress is linear, and no pressure needed
    shear(0, 1) = s;
    EXPECT_NEAR((material.stress(shear) * shear.transpose())(0, 1), material.mu * s, rounding * moduli.young);
  }
  const Mat3 inverted = Point(-0.1, 1, 1).asDiagonal();
  EXPECT_EQ(material.energy(inverted), infinity);
  EXPECT_FALSE(material.stress(inverted).allFinite());
  EXPECT_FALSE(tangent(material, inverted).allFinite());
}

TEST(OgdenMaterial, OfExponentsTwoAndMinusTwoIsMooneyRivlin) {
  const MooneyRivlin<double> mooney{.c10 = 3e4, .c01 = 1e4, .bulk = 5e5};
  const Ogden<double> ogden{2 * mooney.c10, 2, -2 * mooney.c01, -2, 0, 1, mooney.bulk};
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    Mat3 F = random_gradient(seed);
    if (seed == 1) F = Point(1.3, 1.3, 0.8).asDiagonal();               // two equal stretches
    if (seed == 2) F = Point(1.3, 1.3 * (1 + 1e-6), 0.8).asDiagonal();  // nearly
    if (seed == 3) F = Point(1.3, 1.3 * (1 + 3e-5), 1.3).asDiagonal();
    const double tolerance = 1e-9 * mooney.tangent(F).norm();  // differences of close stretches lose digits
    EXPECT_NEAR(ogden.energy(F), mooney.energy(F), rounding * mooney.bulk) << seed;
    EXPECT_TRUE(is_near(ogden.stress(F), mooney.stress(F), tolerance)) << seed;
    EXPECT_TRUE(is_near(ogden.tangent(F), mooney.tangent(F), tolerance)) << seed;
  }
  const Mat3 inverted = Point(-0.1, 1, 1).asDiagonal();
  EXPECT_EQ(ogden.energy(inverted), infinity);
  EXPECT_FALSE(ogden.stress(inverted).allFinite());
}

TEST(FungMaterial, StiffensExponentiallyAndMoreAlongItsFibres) {
  const Point fibre = Point(1, 2, -2) / 3;
  const auto material = Fung<double>::from(moduli, 10, 4, fibre);
  const auto stretched_along = [](const Point& axis, double s) {
    return Mat3(Mat3::Identity() + (s - 1) * axis * axis.transpose());
  };
  const double s = 1.3, E = (s * s - 1) / 2;
  const Point across = Point(2, -2, -1) / 3, between = (fibre + across).normalized();
  const auto volume = 0.5 * material.bulk * (s - 1) * (s - 1);
  EXPECT_NEAR(material.energy(stretched_along(fibre, s)), material.c / 2 * (std::exp(40 * E * E) - 1) + volume,
              rounding * moduli.young * std::exp(40 * E * E));
  EXPECT_NEAR(material.energy(stretched_along(across, s)), material.c / 2 * (std::exp(10 * E * E) - 1) + volume,
              rounding * moduli.young * std::exp(10 * E * E));
  // E/2 along each and in shear between the two: Q = (b_f + b_t + 2 b_fs) E²/4
  EXPECT_NEAR(material.energy(stretched_along(between, s)),
              material.c / 2 * (std::exp((40 + 10 + 20) * E * E / 4) - 1) + volume,
              rounding * moduli.young * std::exp(20 * E * E));
  EXPECT_THROW((void)Fung<double>::from(moduli, 10, 4, Point::Zero()), std::invalid_argument);
  EXPECT_THROW((void)Fung<double>::from(moduli, 0), std::invalid_argument);
}

/// ψ(diag(s, 1, 1)) falls all the way from inverted to rest.
template <typename Material>
bool pushes_back(const Material& material) {
  for (double s = -0.9; s < 0.99; s += 0.05)
    if (!(stress(material, Point(s, 1, 1).asDiagonal().toDenseMatrix())(0, 0) < 0)) return false;
  return true;
}

/// First Piola–Kirchhoff stress [Pa] along a bar pulled to a stretch, its sides free.
template <typename Material>
double tension(const Material& material, double stretch) {
  const auto state = [&](double side) -> Mat3 { return Point(stretch, side, side).asDiagonal(); };
  double thin = 0.5, thick = 1.5;  // the stress on the sides grows with their stretch
  while (thick - thin > 1e-15) {
    const double side = 0.5 * (thin + thick);
    (stress(material, state(side))(1, 1) < 0 ? thin : thick) = side;
  }
  return stress(material, state(thin))(0, 0);
}

TEST(NearIncompressibility, TensionTendsToTheIncompressibleClosedForm) {
  constexpr double mu = 1e5, stretch = 1.4;
  const auto I1 = [](double x) { return x * x + 2 / x; };
  const auto pull = [](double x) { return x - 1 / (x * x); };  // P = 2 ∂ψ/∂I₁ (λ − λ⁻²) of laws in I₁ alone
  const auto follows = [&](const std::string& law, const auto& material, const auto& closed) {
    double before = 0;
    for (const double nu : {0.49, 0.499, 0.4999}) {
      const auto some = material(IsotropicModuli{.young = 2 * mu * (1 + nu), .poisson = nu});
      const double error = std::abs(tension(some, stretch) / closed(some) - 1);
      EXPECT_LT(error, 3 * (0.5 - nu)) << law << " at ν = " << nu;
      if (before > 0) {
        EXPECT_NEAR(before / error, 10, 1.5) << law << " at ν = " << nu << ": error of first order in ½ − ν";
      }
      before = error;
    }
  };
  follows(
      "neo-hookean", [](auto m) { return NeoHookean<double>::from(m); },
      [&](const auto&) { return mu * pull(stretch); });
  follows(
      "stable-neo-hookean", [](auto m) { return StableNeoHookean<double>::from(m); },
      [&](const auto& some) { return some.mu * (1 - 1 / (I1(stretch) + 1)) * pull(stretch); });
  follows(
      "mooney-rivlin", [](auto m) { return MooneyRivlin<double>::from(m); },
      [&](const auto& some) { return 2 * (some.c10 + some.c01 / stretch) * pull(stretch); });
  follows(
      "ogden", [](auto m) { return Ogden<double>::from(m); },
      [&](const auto& o) {
        const auto term = [&](double mu_p, double alpha) {
          return mu_p * (std::pow(stretch, alpha - 1) - std::pow(stretch, -alpha / 2 - 1));
        };
        return term(o.mu1, o.alpha1) + term(o.mu2, o.alpha2) + term(o.mu3, o.alpha3);
      });
}

TEST(InvertedElements, ArePushedBackByTheLawsMadeForThem) {
  EXPECT_TRUE(pushes_back(StableNeoHookean<double>::from(moduli)));
  EXPECT_TRUE(pushes_back(Corotational<double>::from(moduli)));
  EXPECT_FALSE(pushes_back(StVenantKirchhoff<double>::from(moduli)));  // as its docstring warns
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
