#include <physics/heat/surface_heat_loss.hpp>
#include <physics/model/composite_model.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/heat.hpp>

#include <gtest/gtest.h>

#include <functional>

namespace supple::test {
namespace {

constexpr FirstOrderMethod all_methods[] = {FirstOrderMethod::BackwardEuler, FirstOrderMethod::Trapezoidal,
                                            FirstOrderMethod::Bdf2};

/// m u̇ + k u + c u² = q in one unknown.
struct Logistic {
  using MatrixType = Matrix;
  static constexpr bool symmetric_tangent = false;
  double k, c;
  Vector m = Vector::Constant(1, 2.0);
  Matrix K0 = Matrix::Constant(1, 1, k);

  Index dim() const { return 1; }
  const Vector& mass() const { return m; }
  void force(VectorIn u, VectorOut f) const { f[0] = k * u[0] + c * u[0] * u[0]; }
  void stiffness(VectorIn u, Matrix& K) const { K = Matrix::Constant(1, 1, k + 2 * c * u[0]); }
  const Matrix& rest_stiffness() const { return K0; }
};
static_assert(SemidiscreteSystem<Logistic>);

/// u after n steps of h under q(t), from u₀.
double integrate(const Logistic& system, FirstOrderMethod method, double u0, double h, Index n,
                 const std::function<double(double)>& q) {
  FirstOrderIntegrator integrator(system, h, {.method = method, .tolerance = 1e-13});
  FirstOrderState state{Vector::Constant(1, u0), Vector::Zero(1)};
  const auto load = [&](double time) { return SystemLoad<Matrix>{Vector::Constant(1, q(time)), {}}; };
  integrator.balance(load(0), state);
  for (Index i = 0; i < n; ++i) {
    const Report report = integrator.step(load(state.time + h), state);
    EXPECT_EQ(report.status, Status::Converged) << "step " << i << ": " << report.residual;
  }
  EXPECT_NEAR(state.time, h * static_cast<double>(n), 1e-12);
  return state.u[0];
}

// Without load u = k / ((k / u₀ + c) e^{k t / m} − c).
TEST(FirstOrderIntegrator, MethodsHaveTheirOrdersOnTheLogisticEquation) {
  const Logistic system{.k = 3, .c = 2};
  const double exact = 3 / ((3 / 1.5 + 2) * std::exp(3 * 0.5 / 2) - 2);
  for (const FirstOrderMethod method : all_methods) {
    const auto error = [&](Index n) {
      return std::abs(integrate(system, method, 1.5, 0.5 / static_cast<double>(n), n, [](double) { return 0.0; }) -
                      exact);
    };
    const double expected = method == FirstOrderMethod::BackwardEuler ? 1 : 2;
    EXPECT_NEAR(std::log2(error(64) / error(128)), expected, 0.1);
    EXPECT_NEAR(std::log2(error(128) / error(256)), expected, 0.05);
  }
}

// u = cos t solves it for this load, whatever k: loads have to be taken at the right times.
TEST(FirstOrderIntegrator, MethodsHaveTheirOrdersUnderALoadThatVaries) {
  const Logistic system{.k = 1, .c = 0.5};
  const auto load = [](double t) { return -2 * std::sin(t) + std::cos(t) + 0.5 * std::cos(t) * std::cos(t); };
  for (const FirstOrderMethod method : all_methods) {
    const auto error = [&](Index n) {
      return std::abs(integrate(system, method, 1, 2 / static_cast<double>(n), n, load) - std::cos(2.0));
    };
    const double expected = method == FirstOrderMethod::BackwardEuler ? 1 : 2;
    EXPECT_NEAR(std::log2(error(128) / error(256)), expected, 0.1);
  }
}

// A step of 1 s where what is off the slow solution decays in a microsecond. Started off by one, Bdf2 and backward
// Euler are back at once; the trapezoidal rule swings with a factor of nearly −1 a step.
TEST(FirstOrderIntegrator, WhatIsMuchFasterThanAStepDecaysButForTheTrapezoidalRule) {
  const Logistic system{.k = 2e6, .c = 0};
  const auto off = [&](FirstOrderMethod method, Index n) {
    return integrate(system, method, 2, 1, n, [](double) { return 2e6; }) - 1;
  };
  EXPECT_LT(std::abs(off(FirstOrderMethod::BackwardEuler, 1)), 2e-6);
  EXPECT_LT(std::abs(off(FirstOrderMethod::BackwardEuler, 2)), 1e-11);
  EXPECT_LT(std::abs(off(FirstOrderMethod::Bdf2, 3)), 1e-11);
  EXPECT_NEAR(off(FirstOrderMethod::Trapezoidal, 1), -1, 1e-5);
  EXPECT_NEAR(off(FirstOrderMethod::Trapezoidal, 2), 1, 1e-5);
}

// The coefficients follow the steps: u = t² is in the space of Bdf2, whatever the steps, if the first step is given.
TEST(FirstOrderIntegrator, Bdf2IsExactForParabolasWithStepsThatChange) {
  const Logistic system{.k = 0.7, .c = 0};
  FirstOrderState state{Vector::Constant(1, 1.0), Vector::Constant(1, 2.0), 1, Vector::Zero(1), 0};
  for (const double h : {0.5, 2.0, 0.1}) {
    const double t = state.time + h;
    FirstOrderIntegrator integrator(system, h, {.tolerance = 1e-14});
    const SystemLoad<Matrix> load{Vector::Constant(1, 4 * t + 0.7 * t * t), {}};
    ASSERT_EQ(integrator.step(load, state).status, Status::Converged);
    EXPECT_NEAR(state.u[0], t * t, 1e-12 * t * t);
    EXPECT_NEAR(state.u_dot[0], 2 * t, 1e-11 * t);
  }
}

// In a body that loses nothing Σ C θ is the heat put in, to the tolerance of a step, however nonlinear.
TEST(FirstOrderIntegrator, InsulatedBodiesKeepTheirHeat) {
  const HeatedBar bar(false);
  const Vector source = bar.end_flow(2000);
  for (const FirstOrderMethod method : all_methods) {
    const Matrix theta = heat_up(
        *bar.system, 100, 12, {.method = method, .tolerance = 1e-12}, [&](double) { return source; },
        [](VectorIn u) -> Vector { return u; });
    for (Index k = 0; k < theta.cols(); ++k) {
      const double heat = 100 * 2000 * static_cast<double>(k + 1);
      EXPECT_NEAR(bar.system->mass().dot(theta.col(k)), heat, 1e-8 * heat) << "step " << k;
    }
    EXPECT_GT(theta.col(11).maxCoeff() - theta.col(11).minCoeff(), 40) << "the conductivity is to vary";
  }
}

// The time to come to rest is that of conduction, L² ρ c / k: about 20 000 s.
TEST(FirstOrderIntegrator, EndsInTheSteadyState) {
  const HeatedBar bar;
  const auto load = bar.system->project(bar.end_flow(300));
  Vector steady = Vector::Zero(bar.system->dim());
  ASSERT_EQ(solve_steady(*bar.system, load, steady, {.tolerance = 1e-12}).status, Status::Converged);
  FirstOrderIntegrator integrator(*bar.system, 5000, {.tolerance = 1e-11});
  FirstOrderState state = FirstOrderState::at_rest(bar.system->dim());
  for (int k = 0; k < 100; ++k) ASSERT_EQ(integrator.step(load, state).status, Status::Converged);
  EXPECT_TRUE(is_near(state.u, steady, 1e-6 * steady.maxCoeff()));
}

// Conduction and loss at the surface as one model: temperatures fall everywhere and stay above those around.
TEST(FirstOrderIntegrator, SurfacesCoolToTheirSurroundings) {
  const HeatedBar bar(false);
  const auto faces = boundary_faces(bar.mesh);
  const CompositeModel model(bar.system->model(),
                             SurfaceHeatLoss(bar.mesh.nodes, faces, {.film = 20, .emissivity = 0.9}));
  static_assert(!has_symmetric_tangent<decltype(model)>() && has_symmetric_tangent<SurfaceHeatLoss>());
  const FullSystem<std::remove_const_t<decltype(model)>> system(model, bar.system->nodal_mass());
  FirstOrderIntegrator integrator(system, 200, {.tolerance = 1e-10});
  FirstOrderState state{Vector::Constant(system.dim(), 500), Vector::Zero(system.dim())};
  const auto nothing = system.project(Vector::Zero(system.dim()));
  double before = 500;
  for (int k = 0; k < 200; ++k) {
    ASSERT_EQ(integrator.step(nothing, state).status, Status::Converged);
    ASSERT_LT(state.u.maxCoeff(), before);
    ASSERT_GT(state.u.minCoeff(), 0);
    before = state.u.maxCoeff();
  }
  EXPECT_LT(before, 50);
}

TEST(FirstOrderIntegrator, SystemsWithAPotentialAreSolvedAsSymmetricOnes) {
  const TetMesh mesh = kuhn_box(2, 1, 1, 0.1);
  const FullSystem<SurfaceHeatLoss> system(SurfaceHeatLoss(mesh.nodes, boundary_faces(mesh), {.emissivity = 1}),
                                           Vector::Constant(mesh.num_nodes(), 50));
  static_assert(std::same_as<TangentSolver<FullSystem<SurfaceHeatLoss>>, SpdSolver<SparseMatrix>>);
  static_assert(std::same_as<TangentSolver<FullSystem<Conduction>>, LuSolver<SparseMatrix>>);
  FirstOrderIntegrator integrator(system, 1, {.tolerance = 1e-12});
  FirstOrderState state{Vector::Constant(system.dim(), 300), Vector::Zero(system.dim())};
  const double energy = system.energy(state.u);
  for (int k = 0; k < 10; ++k)
    ASSERT_EQ(integrator.step(system.project(Vector::Zero(system.dim())), state).status, Status::Converged);
  EXPECT_LT(system.energy(state.u), energy);
}

TEST(FirstOrderIntegrator, NumberOfThreadsDoesNotChangeABit) {
  const HeatedBar bar;
  const int before = num_threads();
  const auto run = [&](int threads) {
    set_num_threads(threads);
    return heat_up(
        *bar.system, 300, 5, {}, [&](double) { return bar.end_flow(2000); },
        [&](VectorIn u) { return bar.system->expand(u); });
  };
  const Matrix one = run(1), two = run(2);
  set_num_threads(before);
  EXPECT_TRUE(is_same(two, one));
}

TEST(FirstOrderIntegrator, RefusesWhatDoesNotFit) {
  const Logistic system{.k = 1, .c = 0};
  EXPECT_THROW(FirstOrderIntegrator(system, 0), std::invalid_argument);
  EXPECT_THROW(FirstOrderIntegrator(system, -1), std::invalid_argument);
  EXPECT_THROW(FirstOrderIntegrator(system, 1, {.tolerance = 0}), std::invalid_argument);
  FirstOrderIntegrator integrator(system, 1);
  FirstOrderState state = FirstOrderState::at_rest(1), two = FirstOrderState::at_rest(2);
  const SystemLoad<Matrix> load{Vector::Zero(1), {}}, wrong{Vector::Zero(2), {}};
  EXPECT_THROW((void)integrator.step(wrong, state), std::invalid_argument);
  EXPECT_THROW((void)integrator.step(load, two), std::invalid_argument);
  state.u_before = Vector::Zero(1);  // at time 0, as this one
  EXPECT_THROW((void)integrator.step(load, state), std::invalid_argument);
}

TEST(FirstOrderIntegrator, LeavesAStateThatIsNotFiniteAlone) {
  const Logistic system{.k = 1, .c = 0};
  FirstOrderIntegrator integrator(system, 1);
  FirstOrderState state{Vector::Constant(1, std::numeric_limits<double>::quiet_NaN()), Vector::Zero(1)};
  EXPECT_EQ(integrator.step({Vector::Zero(1), {}}, state).status, Status::NotFinite);
  EXPECT_EQ(state.time, 0);
}

}  // namespace
}  // namespace supple::test
