#include <physics/system/any_system.hpp>
#include <physics/time/average_vector_field.hpp>
#include <physics/time/backward_difference.hpp>
#include <physics/time/first_order.hpp>
#include <physics/time/generalized_alpha.hpp>
#include <physics/time/integrator_library.hpp>
#include <physics/time/newmark.hpp>
#include <testing/time_integrator_conformance.hpp>

#include <gmock/gmock.h>

namespace supple::test {

struct AverageAcceleration {
  template <typename System>
  static Newmark<System> make(const System& system, double h, double tolerance) {
    return {system, h, {.tolerance = tolerance}};
  }
};
struct DampedNewmark {
  template <typename System>
  static Newmark<System> make(const System& system, double h, double tolerance) {
    return {system, h, {.tolerance = tolerance}, {.beta = 0.3025, .gamma = 0.6}};
  }
};
struct LinearAcceleration {
  template <typename System>
  static Newmark<System> make(const System& system, double h, double tolerance) {
    return {system, h, {.tolerance = tolerance}, {.beta = 1.0 / 6, .gamma = 0.5}};
  }
};
/// An integrator without options.
template <template <typename> class Integrator>
struct Plain {
  template <typename System>
  static Integrator<System> make(const System& system, double h, double tolerance) {
    return {system, h, {.tolerance = tolerance}};
  }
};
template <int hundredths>
struct GeneralizedAlphaOf {
  template <typename System>
  static GeneralizedAlpha<System> make(const System& system, double h, double tolerance) {
    return {system, h, {.tolerance = tolerance}, {.rho_infinity = hundredths / 100.0}};
  }
};
template <FirstOrderMethod method>
struct FirstOrder {
  template <typename System>
  static FirstOrderIntegrator<System> make(const System& system, double h, double tolerance) {
    return {system, h, {.method = method, .tolerance = tolerance}};
  }
};
using Integrators =
    testing::Types<AverageAcceleration, DampedNewmark, LinearAcceleration, Plain<AverageVectorField>, Plain<TrBdf2>,
                   Plain<Bdf2>, Plain<BackwardEuler>, GeneralizedAlphaOf<0>, GeneralizedAlphaOf<50>,
                   GeneralizedAlphaOf<80>, GeneralizedAlphaOf<100>, FirstOrder<FirstOrderMethod::BackwardEuler>,
                   FirstOrder<FirstOrderMethod::Trapezoidal>, FirstOrder<FirstOrderMethod::Bdf2>>;
INSTANTIATE_TYPED_TEST_SUITE_P(OfOurs, TimeIntegratorConformance, Integrators);

namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

SystemLoad<Matrix> no_load() {
  return {Vector::Zero(3), {}};
}

// At infinite frequency all three roots of a step are −ρ∞ (Chung & Hulbert 1993), so that n steps leave n² ρ∞ⁿ.
TEST(GeneralizedAlpha, LeavesOfFastMotionsWhatRhoInfinitySays) {
  Oscillators system;
  system.k.setConstant(1e4);
  system.K0 = system.k.asDiagonal();
  const double h = 1e4 * system.period(0);
  for (const double rho : {0.3, 0.6, 0.9}) {
    GeneralizedAlpha integrator(system, h, {.tolerance = 1e-13}, {.rho_infinity = rho});
    State state = integrator.at_rest();
    state.u << 0.1, -0.3, 0.2;
    integrator.balance(no_load(), state);
    const auto after = [&](int steps) {
      for (int k = 0; k < steps; ++k) EXPECT_NE(integrator.step(no_load(), state).status, Status::NotFinite);
      return state.u.norm();
    };
    const int n = 12;
    const double first = after(n), second = after(n);
    EXPECT_NEAR(std::pow(second / first / 4, 1.0 / n), rho, 0.05 * rho) << rho;
  }
}

// One unknown: the amplitude after a period, against the closed form of the damped oscillator.
TEST(GeneralizedAlpha, FollowsADampedOscillator) {
  Oscillators system;
  const Vector omega = system.k.cwiseQuotient(system.masses).cwiseSqrt();
  const RayleighDamping damping{.alpha = 0.8, .beta = 0.004};
  const double duration = 1.5;
  const Index steps = 3000;
  GeneralizedAlpha integrator(system, duration / static_cast<double>(steps), {.damping = damping, .tolerance = 1e-12},
                              {.rho_infinity = 0.7});
  State state = integrator.at_rest();
  state.u << 0.1, -0.3, 0.2;
  integrator.balance(no_load(), state);
  const Vector start = state.u;
  for (Index k = 0; k < steps; ++k) ASSERT_NE(integrator.step(no_load(), state).status, Status::NotFinite);
  for (Index i = 0; i < 3; ++i) {
    const double delta = (damping.alpha + damping.beta * omega[i] * omega[i]) / 2;
    const double swing = std::sqrt(omega[i] * omega[i] - delta * delta);
    const double expected = start[i] * std::exp(-delta * duration) *
                            (std::cos(swing * duration) + delta / swing * std::sin(swing * duration));
    EXPECT_NEAR(state.u[i], expected, 2e-5 * std::abs(start[i])) << i;
  }
}

TEST(GeneralizedAlpha, RefusesASpectralRadiusThatIsNone) {
  const Oscillators system;
  for (const double rho : {-0.1, 1.1, std::nan("")})
    EXPECT_THROW(GeneralizedAlpha(system, 0.1, {}, {.rho_infinity = rho}), std::invalid_argument) << rho;
}

/// The oscillators, with displacements of one node.
struct OneNode : Oscillators {
  Index num_nodes() const { return 1; }
  Vector expand(VectorIn u) const { return u; }
  Point displacement(VectorIn u, Index) const { return u; }
};

TEST(IntegratorLibrary, MakesTheIntegratorsOfTheirTypes) {
  const auto own = std::make_shared<const OneNode>();
  const AnySystem<Matrix> system(own);
  const StepOptions options{.solver = Bfgs{}, .tolerance = 1e-10};
  const auto expect_same = [&](auto direct, const char* choice) {
    auto by_name = make_integrator(Choice::parse(choice), system, 0.05, options);
    State a = direct.at_rest(), b = by_name.at_rest();
    a.v << 0.7, 0.4, -0.5;
    b.v = a.v;
    direct.balance(no_load(), a);
    by_name.balance(no_load(), b);
    for (int k = 0; k < 20; ++k) {
      ASSERT_EQ(direct.step(no_load(), a).status, Status::Converged);
      ASSERT_EQ(by_name.step(no_load(), b).status, Status::Converged);
    }
    EXPECT_TRUE(is_same(b.u, a.u)) << choice;
    EXPECT_EQ(by_name.order(), direct.order());
  };
  expect_same(Newmark(*own, 0.05, options), "newmark");
  expect_same(Newmark(*own, 0.05, options, {.beta = 0.3025, .gamma = 0.6}), "newmark:beta=0.3025:gamma=0.6");
  expect_same(GeneralizedAlpha(*own, 0.05, options, {.rho_infinity = 0.5}), "generalized-alpha:rho_infinity=0.5");
  expect_same(AverageVectorField(*own, 0.05, options), "average-vector-field");
  expect_same(TrBdf2(*own, 0.05, options), "tr-bdf2");
  expect_same(Bdf2(*own, 0.05, options), "bdf2");
  expect_same(BackwardEuler(*own, 0.05, options), "backward-euler");
}

TEST(IntegratorLibrary, NamesWhatItDoesNotKnow) {
  const AnySystem<Matrix> system(std::make_shared<const OneNode>());
  const auto make = [&](const char* choice) { (void)make_integrator(Choice::parse(choice), system, 0.1, {}); };
  EXPECT_THAT([&] { make("leapfrog"); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("leapfrog"),
                        HasSubstr("average-vector-field, newmark, generalized-alpha, tr-bdf2, bdf2, backward-euler"))));
  EXPECT_THAT([&] { make("newmark:rho=1"); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("'rho'"), HasSubstr("beta, gamma"))));
  EXPECT_THAT([&] { make("generalized-alpha:rho_infinity=half"); },
              ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("rho_infinity"), HasSubstr("'half'"))));
  EXPECT_THAT([&] { make("generalized-alpha:rho_infinity=2"); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("0 to 1")));
}

}  // namespace
}  // namespace supple::test
