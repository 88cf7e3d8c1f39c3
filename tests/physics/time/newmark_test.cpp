#include <core/parallel.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/newmark.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/spring_network.hpp>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <numbers>
#include <optional>

namespace supple::test {
namespace {

using Oscillator = FullSystem<DuffingOscillators>;
using StvkSystem = FullSystem<TetElasticity<StVenantKirchhoff>>;
constexpr double tight = 1e-11;  // nonlinear residuals well below the errors that are measured
constexpr double pi = std::numbers::pi;

/// One node of mass m on ½ k |u|² + ¼ c |u|⁴.
Oscillator oscillator(double m, double k, double c = 0) {
  return {DuffingOscillators(1, k, c), Vector::Constant(1, m)};
}
SystemLoad<SparseMatrix> no_load(Index dim) {
  return {Vector::Zero(dim), {}};
}

/// A soft bar of 3 × 1 × 1 cubes clamped at x = 0.
template <template <typename> class Material = StVenantKirchhoff>
FullSystem<TetElasticity<Material>> bar(double young = 1e4) {
  const TetMesh mesh = perturbed(kuhn_box(3, 1, 1, 0.1), 0.008, 5);
  return {TetElasticity<Material>(mesh, Material<double>::from({.young = young, .poisson = 0.3})),
          lumped_mass(mesh, 1000.0), nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; })};
}
/// The free part swings up, faster towards the end: up to 1.5 m/s.
template <typename System>
State swinging(const System& system) {
  State state = State::at_rest(system.dim());
  for (Index f = 0; f < system.numbering().num_free(); ++f)
    state.v[3 * f + 1] = 0.15 * static_cast<double>(system.numbering().free_nodes()[f] % 4 + 1);
  return state;
}

template <typename System>
State run(const System& system, State state, const SystemLoad<SparseMatrix>& load, double duration, Index steps,
          StepOptions options = {}, NewmarkParameters parameters = {}) {
  Newmark newmark(system, duration / static_cast<double>(steps), options, parameters);
  newmark.balance(load, state);
  for (Index k = 0; k < steps; ++k) {
    const StepReport report = newmark.step(load, state);
    EXPECT_EQ(to_string(report.status), "converged") << "step " << k << ": " << report.residual;
    EXPECT_LE(report.residual, options.tolerance);
  }
  return state;
}

const std::array<NonlinearSolver, 4> every_solver{Newton{}, Bfgs{}, Broyden{}, WarpedBfgs{}};

/// log₂ of the ratio of errors between step sizes h, h/2 and h/4.
template <typename Run>
double order(const Run& at_steps, Index steps) {
  const Vector coarse = at_steps(steps), middle = at_steps(2 * steps), fine = at_steps(4 * steps);
  return std::log2((coarse - middle).norm() / (middle - fine).norm());
}

TEST(Newmark, AverageAccelerationIsOfSecondOrderOnANonlinearOscillator) {
  const Oscillator system = oscillator(2, 40, 9000);  // the cubic force is several times the linear one
  State start = State::at_rest(3);
  start.v << 0.7, -0.4, 0.2;
  for (const auto& [solver, beta] :
       {std::pair(NonlinearSolver(Newton{}), 0.25), std::pair(NonlinearSolver(Bfgs{}), 0.25),
        std::pair(NonlinearSolver(Broyden{}), 0.25), std::pair(NonlinearSolver(Newton{}), 1.0 / 6)}) {
    StepOptions options{.tolerance = tight};
    options.solver = solver;
    const NewmarkParameters parameters{.beta = beta};
    const auto at_end = [&](Index steps) { return run(system, start, no_load(3), 0.5, steps, options, parameters); };
    const auto positions = [&](Index steps) { return at_end(steps).u; };
    const auto velocities = [&](Index steps) { return at_end(steps).v; };
    EXPECT_NEAR(order(positions, 100), 2, 0.1);
    EXPECT_NEAR(order(velocities, 100), 2, 0.1);
  }
}

TEST(Newmark, IsOfSecondOrderOnABarWithDampingGravityAndASpring) {
  const StvkSystem system = bar();
  const SystemLoad<SparseMatrix> load =
      system.project({.gravity = {0, 0, -9.81}, .forces = {}, .springs = {{3, 30, {0.05, 0.1, 0}}}});
  StepOptions options{.tolerance = tight};
  options.damping = {.alpha = 0.5, .beta = 2e-3};
  const auto positions = [&](Index steps) { return run(system, swinging(system), load, 0.16, steps, options).u; };
  ASSERT_GT(positions(50).lpNorm<Eigen::Infinity>(), 0.05) << "the motion is to be nonlinear";
  EXPECT_NEAR(order(positions, 200), 2, 0.15);
}

TEST(Newmark, GammaAboveOneHalfIsOfFirstOrder) {
  const Oscillator system = oscillator(2, 40, 9000);
  State start = State::at_rest(3);
  start.v << 0.7, -0.4, 0.2;
  StepOptions options{.tolerance = tight};
  const NewmarkParameters parameters{.beta = 0.3025, .gamma = 0.6};
  const auto positions = [&](Index steps) { return run(system, start, no_load(3), 0.5, steps, options, parameters).u; };
  EXPECT_NEAR(order(positions, 400), 1, 0.1);
}

TEST(Newmark, FollowsTheClosedFormOfAHarmonicOscillatorAndKeepsItsEnergy) {
  const double m = 3, omega = 7, amplitude = 0.2;
  const Oscillator system = oscillator(m, m * omega * omega);
  State state = State::at_rest(3);
  state.u[1] = amplitude;
  const double h = 2 * pi / omega / 40;
  Newmark newmark(system, h, {.tolerance = tight});
  newmark.balance(no_load(3), state);
  const double energy = newmark.energy(state);
  EXPECT_NEAR(energy, 0.5 * m * omega * omega * amplitude * amplitude, 1e-12);
  // average acceleration turns by 2 atan(ωh/2) a step, exactly, at constant energy
  const double angle = 2 * std::atan(omega * h / 2);
  for (int k = 1; k <= 400; ++k) {
    ASSERT_EQ(newmark.step(no_load(3), state).status, Status::Converged);
    EXPECT_NEAR(newmark.energy(state), energy, 1e-9 * energy);
    EXPECT_TRUE(is_near(state.u, amplitude * std::cos(k * angle) * Point::UnitY(), 1e-9 * amplitude));
  }
  EXPECT_NEAR(state.time, 400 * h, 1e-12);
  EXPECT_GT(std::abs(400 * (angle - omega * h)), 0.1) << "the discrete frequency differs from ω, visibly";
}

TEST(Newmark, NumericalDampingTakesEnergyAwayAndGammaOneHalfDoesNot) {
  const StvkSystem system = bar();
  const auto energy_after = [&](double gamma, double amplitude) {
    StepOptions options{.tolerance = 1e-9};
    const NewmarkParameters parameters{.beta = (gamma + 0.5) * (gamma + 0.5) / 4, .gamma = gamma};
    State start = swinging(system);
    start.v *= amplitude;
    const Newmark newmark(system, 1.0, options);
    const double before = newmark.energy(start);
    return newmark.energy(run(system, start, no_load(system.dim()), 0.3, 100, options, parameters)) / before;
  };
  EXPECT_NEAR(energy_after(0.5, 1e-4), 1, 1e-4);  // nearly linear: conserved, up to strains
  EXPECT_LT(energy_after(0.7, 1e-4), 0.99);
  EXPECT_NEAR(energy_after(0.5, 1), 1, 0.05);  // large motions: bounded drift only
}

TEST(Newmark, DampedVibrationDecaysAsRayleighSays) {
  const StvkSystem system = bar();
  const Matrix M = system.mass().asDiagonal();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> modes(Matrix(system.rest_stiffness()), M);
  for (const Index k : {0, 2}) {
    const double omega = std::sqrt(modes.eigenvalues()[k]);
    const Vector phi = modes.eigenvectors().col(k);  // φᵀ M φ = 1
    for (const RayleighDamping damping :
         {RayleighDamping{0.1 * omega, 0}, {0, 0.1 / omega}, {0.2 * omega, 0.3 / omega}}) {
      const double delta = (damping.alpha + damping.beta * omega * omega) / 2;
      const double omega_d = std::sqrt(omega * omega - delta * delta);
      const double amplitude = 1e-5, duration = 2.75 * 2 * pi / omega;  // linear regime
      const auto q = [&](double t) {
        return amplitude * std::exp(-delta * t) * (std::cos(omega_d * t) + delta / omega_d * std::sin(omega_d * t));
      };
      State start = State::at_rest(system.dim());
      start.u = amplitude * phi;
      StepOptions options{.tolerance = 1e-7};
      options.damping = damping;
      const auto error = [&](Index steps) {
        const State end = run(system, start, no_load(system.dim()), duration, steps, options);
        const Vector in_modes = modes.eigenvectors().transpose() * M * end.u;
        Vector others = in_modes;
        others[k] = 0;
        EXPECT_LT(others.norm(), 1e-3 * amplitude) << "it stays in its mode";
        return in_modes[k] - q(duration);
      };
      const double coarse = error(150), fine = error(300);
      EXPECT_LT(std::abs(fine), 0.01 * amplitude) << "mode " << k;
      EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << "mode " << k;
    }
  }
}

TEST(Newmark, SpringsPullToTheClosedFormEquilibrium) {
  // two springs at a node that is held by k₀: u = Σ k u* / (k₀ + Σ k)
  const Oscillator system = oscillator(1, 50);
  Loads loads{
      .gravity = {0, -9.81, 0}, .forces = {{0, {1, 0, 0}}}, .springs = {{0, 30, {0.2, 0, 0}}, {0, 20, {0, 0, 0.4}}}};
  StepOptions options;
  options.damping.alpha = 2 * std::sqrt(100.0);  // critical, with all springs
  for (const NonlinearSolver& solver : every_solver) {
    options.solver = solver;
    options.tolerance = 1e-10;
    const State end = run(system, State::at_rest(3), system.project(loads), 5, 200, options);
    EXPECT_TRUE(is_near(end.u, Point(1 + 6, -9.81, 8) / 100, 1e-8));
    EXPECT_TRUE(is_near(end.v, Point::Zero(), 1e-7));
  }
}

TEST(Newmark, SpringsThatComeAndGoAreFollowed) {
  const Oscillator system = oscillator(1, 50);
  StepOptions options{.tolerance = 1e-10};
  options.damping.alpha = 15;
  options.solver = Bfgs{};
  Newmark newmark(system, 0.05, options);
  State state = State::at_rest(3);
  for (const double k : {0.0, 150.0, 400.0, 0.0, 30.0}) {
    Loads loads;
    if (k > 0) loads.springs = {{0, k, {0.3, 0, 0}}};
    const SystemLoad<SparseMatrix> load = system.project(loads);
    for (int i = 0; i < 200; ++i) {
      const StepReport report = newmark.step(load, state);
      ASSERT_EQ(report.status, Status::Converged);
      EXPECT_LE(report.iterations, 2) << "linear: the Jacobian at rest, with the springs, is exact";
    }
    EXPECT_TRUE(is_near(state.u, Point(0.3 * k / (50 + k), 0, 0), 1e-7)) << k;
  }
}

TEST(Newmark, BalanceSolvesTheEquationOfMotion) {
  const StvkSystem system = bar();
  StepOptions options;
  options.damping = {.alpha = 0.4, .beta = 3e-3};
  const Newmark newmark(system, 0.01, options);
  State state = State::at_rest(system.dim());
  state.u = random_vector(system.dim(), 0.01, 1);
  state.v = random_vector(system.dim(), 0.5, 2);
  const SystemLoad<SparseMatrix> load =
      system.project({.gravity = {0, 0, -9.81}, .forces = {{3, {0, 5, 0}}}, .springs = {{7, 300, {0.1, 0, 0}}}});
  newmark.balance(load, state);
  const Vector f = system.force(state.u) + load.stiffness * state.u;
  const Vector damping = 0.4 * system.mass().cwiseProduct(state.v) + 3e-3 * (system.rest_stiffness() * state.v);
  EXPECT_TRUE(is_near(system.mass().cwiseProduct(state.a), load.force - f - damping, 1e-12 * f.norm()));
}

TEST(Newmark, TheReportedResidualIsThatOfTheEquationOfMotion) {
  const StvkSystem system = bar();
  const SystemLoad<SparseMatrix> load =
      system.project({.gravity = {0, 0, -9.81}, .forces = {}, .springs = {{3, 500, {0.05, 0.1, 0}}}});
  for (const NonlinearSolver& solver : every_solver)
    for (const RayleighDamping damping : {RayleighDamping{}, {50, 0.1}}) {
      StepOptions options{.tolerance = 1e-5};
      options.solver = solver;
      options.damping = damping;
      const double h = 0.02;
      Newmark newmark(system, h, options);
      State state = swinging(system);
      newmark.balance(load, state);
      for (int k = 0; k < 8; ++k) {
        const State before = state;
        const StepReport report = newmark.step(load, state);
        EXPECT_EQ(report.status, Status::Converged);
        const Vector inertia = system.mass().cwiseProduct(state.a),
                     damp = damping.alpha * system.mass().cwiseProduct(state.v) +
                            damping.beta * (system.rest_stiffness() * state.v),
                     f = system.force(state.u), dead = system.project({.gravity = {0, 0, -9.81}}).force,
                     pull = load.stiffness * state.u - (load.force - dead);
        const double scale = std::max({inertia.norm(), damp.norm(), f.norm(), pull.norm(), dead.norm()});
        const double residual = (inertia + damp + f + pull - dead).norm() / scale;
        EXPECT_LE(residual, options.tolerance * (1 + 1e-6));
        EXPECT_NEAR(residual, report.residual, 1e-3 * report.residual + 1e-11);  // rounding of c_m M (u − ũ)
        // Newmark's formulas (β = ¼, γ = ½)
        EXPECT_TRUE(is_near(state.u, before.u + h * before.v + h * h / 4 * (before.a + state.a), 1e-14));
        EXPECT_TRUE(is_near(state.v, before.v + h / 2 * (before.a + state.a), 1e-13));
        EXPECT_NEAR(state.time, before.time + h, 1e-15);
      }
    }
}

TEST(Newmark, SolversTakeTheSameTrajectory) {
  const StvkSystem system = bar();
  const SystemLoad<SparseMatrix> load = system.project({.gravity = {0, 0, -9.81}, .forces = {}, .springs = {}});
  StepOptions options{.tolerance = 1e-9};
  const State newton = run(system, swinging(system), load, 0.2, 20, options);
  for (const NonlinearSolver& solver :
       {NonlinearSolver(Bfgs{}), NonlinearSolver(Broyden{}), NonlinearSolver(WarpedBfgs{})}) {
    options.solver = solver;
    const State other = run(system, swinging(system), load, 0.2, 20, options);
    EXPECT_TRUE(is_near(other.u, newton.u, 1e-6));
    EXPECT_TRUE(is_near(other.v, newton.v, 1e-4));
  }
}

TEST(Newmark, BfgsLearnsFromStepToStep) {
  const StvkSystem system = bar();
  const SystemLoad<SparseMatrix> load = system.project({.gravity = {0, 0, -9.81}, .forces = {}, .springs = {}});
  const auto iterations = [&](bool forgetful) {
    StepOptions options{.tolerance = 1e-9};
    options.solver = Bfgs{};
    State state = swinging(system);
    std::optional<Newmark<StvkSystem>> newmark;
    Index sum = 0;
    for (int k = 0; k < 20; ++k) {
      if (!newmark || forgetful) newmark.emplace(system, 0.01, options);
      newmark->balance(load, state);
      const StepReport report = newmark->step(load, state);
      EXPECT_EQ(report.status, Status::Converged);
      sum += report.iterations;
    }
    return sum;
  };
  EXPECT_LT(iterations(false), 0.9 * static_cast<double>(iterations(true)));
}

// The first iterates leave far; there residuals relative to the forces are all about 1 and say nothing.
TEST(Newmark, AllSolversSurviveASpringThatPullsASingleNodeHard) {
  const TetMesh mesh = perturbed(kuhn_box(6, 2, 2, 0.1), 0.008, 7);
  const StvkSystem system(
      TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e6, .poisson = 0.4})),
      lumped_mass(mesh, 1000.0), nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; }));
  const SystemLoad<SparseMatrix> load = system.project(
      {.gravity = {0, 0, -9.81}, .forces = {}, .springs = {{mesh.num_nodes() - 1, 1000, {0.05, 0.1, 0}}}});
  StepOptions options{.tolerance = 1e-8};
  const State newton = run(system, State::at_rest(system.dim()), load, 0.4, 8, options);
  for (const NonlinearSolver& solver : {NonlinearSolver(Bfgs{}), NonlinearSolver(Broyden{})}) {
    options.solver = solver;
    const State other = run(system, State::at_rest(system.dim()), load, 0.4, 8, options);
    EXPECT_TRUE(is_near(other.u, newton.u, 1e-5));
  }
}

TEST(Newmark, AFreeBodyFallsAndTumblesAsARigidOneWould) {
  const TetMesh mesh = kuhn_box(2, 1, 1, 0.1);
  const FullSystem<TetElasticity<MooneyRivlin>> system(
      TetElasticity<MooneyRivlin>(mesh, MooneyRivlin<double>::from({.young = 1e6, .poisson = 0.3})),
      lumped_mass(mesh, 1000.0));
  const Point gravity(0, -9.81, 0), velocity(1, 2, 0), spin(0, 0, 5);
  const double mass = system.nodal_mass().sum();
  const Point center = mesh.nodes.transpose() * system.nodal_mass() / mass;
  State state = State::at_rest(system.dim());
  for (Index v = 0; v < mesh.num_nodes(); ++v)
    state.v.segment<3>(3 * v) = velocity + spin.cross(Point(mesh.nodes.row(v).transpose() - center));
  const auto momentum = [&](const State& s) {
    Point p = Point::Zero();
    for (Index v = 0; v < mesh.num_nodes(); ++v) p += system.nodal_mass()[v] * s.v.segment<3>(3 * v);
    return p;
  };
  const double duration = 0.5;
  state = run(system, state, system.project({.gravity = gravity, .forces = {}, .springs = {}}), duration, 250,
              {.tolerance = 1e-9});
  EXPECT_TRUE(is_near(momentum(state), Point{mass * (velocity + duration * gravity)}, 1e-7 * mass));
  Point moved = Point::Zero();
  for (Index v = 0; v < mesh.num_nodes(); ++v) moved += system.nodal_mass()[v] / mass * state.u.segment<3>(3 * v);
  EXPECT_TRUE(is_near(moved, Point{velocity * duration + 0.5 * gravity * duration * duration}, 1e-7));
}

TEST(Newmark, ABodyAtRestAnywhereIsConverged) {
  const TetMesh mesh = perturbed(kuhn_box(2, 1, 1, 0.1), 0.008, 6);
  const StvkSystem system(
      TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e6, .poisson = 0.3})),
      lumped_mass(mesh, 1000.0));
  for (const NonlinearSolver& solver : every_solver) {
    StepOptions options;
    options.solver = solver;
    Newmark newmark(system, 0.01, options);
    State state = State::at_rest(system.dim());
    EXPECT_EQ(newmark.step(no_load(system.dim()), state).iterations, 0);
    // turned and moved: forces are nothing but rounding, and must not be solved for
    state = State::at_rest(system.dim());
    state.u = affine_displacement(mesh.nodes, random_rotation(4), {1, 2, 3});
    const Vector before = state.u;
    for (int k = 0; k < 5; ++k) {
      const StepReport report = newmark.step(no_load(system.dim()), state);
      EXPECT_EQ(report.status, Status::Converged) << to_string(report.status) << ", " << report.residual;
    }
    EXPECT_TRUE(is_near(state.u, before, 1e-9));
  }
}

TEST(Newmark, NumberOfThreadsDoesNotChangeABit) {
  const TetMesh mesh = perturbed(kuhn_box(8, 4, 4, 0.1), 0.008, 7);  // 768 tets: two chunks of packs
  const StvkSystem system(
      TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.4})),
      lumped_mass(mesh, 1000.0), nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; }));
  const SystemLoad<SparseMatrix> load = system.project(
      {.gravity = {0, 0, -9.81}, .forces = {}, .springs = {{mesh.num_nodes() - 1, 500, {0.05, 0.1, 0}}}});
  const int before = num_threads();
  for (const NonlinearSolver& solver : every_solver) {
    std::vector<State> ends;
    for (const int threads : {1, 2}) {
      set_num_threads(threads);
      StepOptions options;
      options.solver = solver;
      options.damping = {.alpha = 0.1, .beta = 1e-3};
      ends.push_back(run(system, State::at_rest(system.dim()), load, 0.2, 4, options));
    }
    EXPECT_TRUE(is_same(ends[0].u, ends[1].u));
    EXPECT_TRUE(is_same(ends[0].v, ends[1].v));
    EXPECT_TRUE(is_same(ends[0].a, ends[1].a));
  }
  set_num_threads(before);
}

TEST(Newmark, NotFiniteInputEndsTheStepAndLeavesTheState) {
  const StvkSystem system = bar();
  for (const NonlinearSolver& solver : every_solver) {
    StepOptions options;
    options.solver = solver;
    Newmark newmark(system, 0.01, options);
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      SystemLoad<SparseMatrix> load = no_load(system.dim());
      State state = swinging(system), before = state;
      load.force[2] = bad;
      EXPECT_EQ(newmark.step(load, state).status, Status::NotFinite);
      EXPECT_TRUE(is_same(state.u, before.u) && is_same(state.v, before.v) && is_same(state.a, before.a));
      EXPECT_EQ(state.time, 0);

      state.u[1] = bad;
      before = state;
      EXPECT_EQ(newmark.step(no_load(system.dim()), state).status, Status::NotFinite);
      EXPECT_EQ((state.u.array() == before.u.array()).count(), system.dim() - std::isnan(bad));
      EXPECT_TRUE(is_same(state.v, before.v) && is_same(state.a, before.a));
      EXPECT_EQ(state.time, 0);
    }
    // and the integrator goes on as if nothing had happened
    State state = swinging(system);
    EXPECT_EQ(newmark.step(no_load(system.dim()), state).status, Status::Converged);
  }
}

TEST(Newmark, APredictorThatInvertsTetsIsNotTheEnd) {
  // Mooney–Rivlin is undefined where u + h v turns a tet inside out; the state itself is good
  const auto system = bar<MooneyRivlin>();
  State start = State::at_rest(system.dim());
  for (Index f = 0; f < system.numbering().num_free(); ++f)
    start.v[3 * f] = -6.0 * static_cast<double>(system.numbering().free_nodes()[f] % 4);
  ASSERT_FALSE(system.force(0.02 * start.v).allFinite()) << "the test needs a predictor that is undefined";
  for (const NonlinearSolver& solver : every_solver) {
    StepOptions options;
    options.solver = solver;
    Newmark newmark(system, 0.02, options);
    State state = start;
    const StepReport report = newmark.step(no_load(system.dim()), state);
    EXPECT_EQ(report.status, Status::Converged) << to_string(report.status) << ", " << report.residual;
    EXPECT_TRUE(std::isfinite(system.energy(state.u)));
    EXPECT_EQ(state.time, 0.02);
  }
}

TEST(Newmark, ReportsWhenIterationsDoNotSuffice) {
  const StvkSystem system = bar();
  const SystemLoad<SparseMatrix> load = system.project({.gravity = {0, 0, -500}, .forces = {}, .springs = {}});
  for (const NonlinearSolver& solver : every_solver) {
    StepOptions options{.tolerance = 1e-12, .max_iterations = 1};
    options.solver = solver;
    Newmark newmark(system, 0.1, options);
    State state = State::at_rest(system.dim());
    const StepReport report = newmark.step(load, state);
    EXPECT_EQ(report.status, Status::MaxIterations);
    EXPECT_EQ(report.iterations, 1);
    EXPECT_GT(report.residual, 1e-12);
    EXPECT_TRUE(state.u.allFinite() && state.v.allFinite());
  }
}

TEST(Newmark, MistakesOfTheCallerThrow) {
  const Oscillator system = oscillator(1, 1);
  for (const double h : {0.0, -0.1, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_THROW(Newmark(system, h), std::invalid_argument) << h;
  EXPECT_THROW(Newmark(system, 0.1, {}, {.beta = 0}), std::invalid_argument);

  EXPECT_THROW(Newmark(system, 0.1, {.tolerance = 0}), std::invalid_argument);

  Newmark newmark(system, 0.1);
  State state = State::at_rest(3);
  EXPECT_THROW((void)newmark.step(no_load(4), state), std::invalid_argument);
  SystemLoad<SparseMatrix> wrong_stiffness{Vector::Zero(3), SparseMatrix(4, 4)};
  EXPECT_THROW((void)newmark.step(wrong_stiffness, state), std::invalid_argument);
  EXPECT_THROW(newmark.balance(no_load(2), state), std::invalid_argument);
  for (Vector State::*member : {&State::u, &State::v, &State::a}) {
    State wrong = state;
    wrong.*member = Vector::Zero(6);
    EXPECT_THROW((void)newmark.step(no_load(3), wrong), std::invalid_argument);
  }
  State wrong = state;
  wrong.v.resize(0);
  EXPECT_THROW(newmark.balance(no_load(3), wrong), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
