#pragma once
/// \file Test suite of what every time integrator promises, typed. An integrator joins with a case and one line:
///
///     struct MyCase {
///       template <typename System>                   // h [s]; the nonlinear solver's tolerance
///       static MyMethod<System> make(const System& system, double h, double tolerance) {
///         return {system, h, {.tolerance = tolerance}};
///       }
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MyMethod, TimeIntegratorConformance, MyCase);

#include <physics/time/time_integrator.hpp>
#include <testing/near.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace supple::test {

/// Three unknowns, each with a spring whose force is k u + c u³, uncoupled: stiff, soft and amid.
struct Oscillators {
  using MatrixType = Matrix;
  Vector masses = (Vector(3) << 2, 0.5, 1).finished();  ///< [kg]
  Vector k = (Vector(3) << 80, 5, 30).finished();       ///< [N/m]
  double c = 0;                                         ///< [N/m³]
  bool breaks = false;                                  ///< forces are NaN
  Matrix K0 = k.asDiagonal();

  Index dim() const { return 3; }
  const Vector& mass() const { return masses; }
  double energy(VectorIn u) const { return 0.5 * u.dot(k.cwiseProduct(u)) + 0.25 * c * u.array().pow(4).sum(); }
  void force(VectorIn u, VectorOut f) const {
    f = k.cwiseProduct(u) + c * u.array().cube().matrix();
    if (breaks) f.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  void stiffness(VectorIn u, Matrix& K) const { K = (k + 3 * c * u.cwiseAbs2()).asDiagonal(); }
  const Matrix& rest_stiffness() const { return K0; }
  SystemLoad<Matrix> project(const Loads& loads) const { return {masses.cwiseProduct(loads.gravity), {}}; }
  SystemLoad<Matrix> no_load() const { return {Vector::Zero(3), {}}; }

  double period(Index i) const { return 2 * std::numbers::pi * std::sqrt(masses[i] / k[i]); }  ///< of small swings [s]
};
static_assert(DynamicalSystem<Oscillators>);

template <typename Case>
class TimeIntegratorConformance : public testing::Test {
 protected:
  static constexpr double tight = 1e-12;

  Oscillators system;

  using Integrator = decltype(Case::make(std::declval<const Oscillators&>(), 1.0, 1.0));
  using State = typename Integrator::State;
  static_assert(TimeIntegratorFor<Integrator, Oscillators>);
  static constexpr bool has_velocity = requires(State & state) { state.v; };

  static void kick(State& state) {
    state.u << 0.1, -0.3, 0.2;
    if constexpr (has_velocity) state.v << 0.7, 0.4, -0.5;
  }
  static Vector coordinates(const State& state) {
    if constexpr (has_velocity)
      return (Vector(6) << state.u, state.v).finished();
    else
      return state.u;
  }

  template <typename Load>
  State run(State state, const SystemLoad<Matrix>& start, const Load& load, double duration, Index steps) const {
    auto integrator = Case::make(system, duration / static_cast<double>(steps), tight);
    integrator.balance(start, state);
    for (Index k = 0; k < steps; ++k) {
      const StepReport report = integrator.step(load, state);
      EXPECT_NE(report.status, Status::NotFinite) << "step " << k;
      EXPECT_LE(report.residual, 1e-9) << "step " << k;
    }
    return state;
  }
};
TYPED_TEST_SUITE_P(TimeIntegratorConformance);

TYPED_TEST_P(TimeIntegratorConformance, ErrorsFallWithItsOrder) {
  this->system.c = 400;
  typename TestFixture::State start = TypeParam::make(this->system, 1.0, 1.0).at_rest();
  this->kick(start);
  // a load that changes over time counts, too
  const auto load = [&](double t) { return SystemLoad<Matrix>{this->system.masses * (3 * std::sin(4 * t)), {}}; };
  const auto at_end = [&](Index steps) { return this->coordinates(this->run(start, load(0), load, 0.5, steps)); };
  const Vector coarse = at_end(400), middle = at_end(800), fine = at_end(1600);
  const double order = std::log2((coarse - middle).norm() / (middle - fine).norm());
  EXPECT_NEAR(order, TypeParam::make(this->system, 1.0, 1.0).order(), 0.15);
}

TYPED_TEST_P(TimeIntegratorConformance, ABodyAtRestInEquilibriumStays) {
  this->system.c = 400;
  auto integrator = TypeParam::make(this->system, 0.3 * this->system.period(0), 1e-12);
  typename TestFixture::State state = integrator.at_rest();
  state.u << 0.2, -0.1, 0.05;
  SystemLoad<Matrix> load = this->system.no_load();
  this->system.force(state.u, load.force);
  const Vector u = state.u;
  integrator.balance(load, state);
  for (int step = 0; step < 50; ++step) {
    const StepReport report = integrator.step(load, state);
    ASSERT_EQ(report.status, Status::Converged);
  }
  EXPECT_TRUE(is_near(state.u, u, 1e-10));
  if constexpr (TestFixture::has_velocity) {
    EXPECT_TRUE(is_near(state.v, Vector::Zero(3), 1e-9));
  }
}

// ½ vᵀMv + ½ uᵀKu of springs, from steps of a tenth of the fastest period up to three periods; ½ uᵀMu where there are
// no velocities.
TYPED_TEST_P(TimeIntegratorConformance, TheEnergyOfALinearOscillatorBehavesAsItSays) {
  const auto energy = [&](const typename TestFixture::State& state) {
    if constexpr (TestFixture::has_velocity)
      return 0.5 * state.v.dot(this->system.masses.cwiseProduct(state.v)) + this->system.energy(state.u);
    else
      return 0.5 * state.u.dot(this->system.masses.cwiseProduct(state.u));
  };
  const SystemLoad<Matrix> load = this->system.no_load();
  for (const double share : {0.1, 1.0, 3.0}) {
    auto integrator = TypeParam::make(this->system, share * this->system.period(0), this->tight);
    typename TestFixture::State state = integrator.at_rest();
    this->kick(state);
    integrator.balance(load, state);
    const double start = energy(state);
    double before = start;
    for (int step = 0; step < 300; ++step) {
      ASSERT_NE(integrator.step(load, state).status, Status::NotFinite);
      const double now = energy(state);
      switch (integrator.energy_behaviour()) {
        case EnergyBehaviour::Conserved:
          ASSERT_NEAR(now, start, 1e-8 * start) << "step " << step << " of " << share << " periods";
          break;
        case EnergyBehaviour::Falls:
          ASSERT_LE(now, before + 1e-10 * start) << "step " << step << " of " << share << " periods";
          break;
        case EnergyBehaviour::Bounded:
        case EnergyBehaviour::BoundedForShortSteps:
          if (share <= 0.1) {
            ASSERT_LE(now, 1.1 * start) << "step " << step;
          }
          break;
      }
      before = now;
      if (now < 1e-30 * start) break;  // what is left would soon underflow
    }
    if (integrator.energy_behaviour() == EnergyBehaviour::BoundedForShortSteps) break;
    EXPECT_LE(before, start * (1 + 1e-8)) << "after 300 steps of " << share << " periods";
  }
}

TYPED_TEST_P(TimeIntegratorConformance, AStepThatIsNotFiniteLeavesTheState) {
  auto integrator = TypeParam::make(this->system, 0.01, 1e-6);
  const SystemLoad<Matrix> load = this->system.no_load();
  typename TestFixture::State state = integrator.at_rest();
  this->kick(state);
  integrator.balance(load, state);
  ASSERT_EQ(integrator.step(load, state).status, Status::Converged);
  const typename TestFixture::State good = state;
  this->system.breaks = true;
  EXPECT_EQ(integrator.step(load, state).status, Status::NotFinite);
  EXPECT_TRUE(is_same(this->coordinates(state), this->coordinates(good)));
  EXPECT_EQ(state.time, good.time);
  this->system.breaks = false;  // and it can go on
  EXPECT_EQ(integrator.step(load, state).status, Status::Converged);
}

TYPED_TEST_P(TimeIntegratorConformance, TimeGoesOnByTheStepAndLoadsMayChangeInIt) {
  const double h = 0.0625;
  auto one = TypeParam::make(this->system, h, 1e-9), other = TypeParam::make(this->system, h, 1e-9);
  EXPECT_EQ(one.step_size(), h);
  EXPECT_EQ(one.at_rest().time, 0);
  EXPECT_TRUE(one.at_rest().u.isZero(0));
  const SystemLoad<Matrix> load = this->system.project({.gravity = {1, -2, 3}});
  typename TestFixture::State a = one.at_rest(), b = a;
  one.balance(load, a);
  other.balance(load, b);
  double asked = -1;
  for (int step = 1; step <= 8; ++step) {
    ASSERT_EQ(one.step(load, a).status, Status::Converged);
    ASSERT_EQ(other.step([&](double t) { return asked = t, load; }, b).status, Status::Converged);
    EXPECT_EQ(a.time, step * h);
    EXPECT_GE(asked, (step - 1) * h);
    EXPECT_LE(asked, step * h);
  }
  EXPECT_TRUE(is_same(this->coordinates(a), this->coordinates(b)));
}

TYPED_TEST_P(TimeIntegratorConformance, MistakesOfTheCallerThrow) {
  for (const double h : {0.0, -0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW((void)TypeParam::make(this->system, h, 1e-6), std::invalid_argument) << h;
  EXPECT_THROW((void)TypeParam::make(this->system, 0.1, 0.0), std::invalid_argument);
  auto integrator = TypeParam::make(this->system, 0.1, 1e-6);
  typename TestFixture::State state = integrator.at_rest();
  EXPECT_THROW((void)integrator.step(SystemLoad<Matrix>{Vector::Zero(4), {}}, state), std::invalid_argument);
  state.u.resize(2);
  EXPECT_THROW(integrator.balance(this->system.no_load(), state), std::invalid_argument);
  EXPECT_THROW((void)integrator.step(this->system.no_load(), state), std::invalid_argument);
}

REGISTER_TYPED_TEST_SUITE_P(TimeIntegratorConformance, ErrorsFallWithItsOrder, ABodyAtRestInEquilibriumStays,
                            TheEnergyOfALinearOscillatorBehavesAsItSays, AStepThatIsNotFiniteLeavesTheState,
                            TimeGoesOnByTheStepAndLoadsMayChangeInIt, MistakesOfTheCallerThrow);

}  // namespace supple::test
