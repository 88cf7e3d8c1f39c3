#include <numerics/linear/symmetric_eigen.hpp>
#include <numerics/optimize/nlopt_minimizer.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/statics/static_solver.hpp>
#include <physics/system/full_system.hpp>
#include <testing/near.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace supple::test {
namespace {

using System = FullSystem<TetElasticity<StVenantKirchhoff>>;

/// A clamped bar that a spring at its free end pulls aside by a third of its length.
struct PulledBar {
  TetMesh mesh = perturbed(kuhn_box(4, 1, 1, 0.1), 0.005, 3);
  System system{TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.3})),
                lumped_mass(mesh, 1000.0), nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; })};
  Index end = nodes_where(mesh, [](const Point& x) { return x[0] > 0.35 && x[1] > 0.05 && x[2] > 0.05; })[0];

  SystemLoad<SparseMatrix> load(double aside) const {
    return system.project({.springs = {{end, 500.0, Point(0, aside, 0)}}});
  }
};

TEST(StaticSolver, MethodsAgreeOnAnEquilibrium) {
  const PulledBar bar;
  StaticSolver newton(bar.system, {.tolerance = 1e-9});
  Vector u = Vector::Zero(bar.system.dim());
  const SolveReport reference = newton.solve(bar.load(0.13), u);
  ASSERT_EQ(reference.status, Status::Converged);
  EXPECT_GT(u.lpNorm<Eigen::Infinity>(), 0.08) << "a large deformation";
  EXPECT_EQ(reference.tangents, reference.iterations);
  for (const Index refresh : {Index{0}, Index{12}}) {
    StaticSolver bfgs(bar.system, {.solver = LineSearchBfgs{.refresh_after = refresh}, .tolerance = 1e-9});
    Vector w = Vector::Zero(bar.system.dim());
    const SolveReport report = bfgs.solve(bar.load(0.13), w);
    EXPECT_EQ(report.status, Status::Converged) << to_string(report.status) << ", " << report.residual;
    EXPECT_TRUE(is_near(w, u, 1e-6 * u.norm()));
    EXPECT_EQ(report.tangents > 0, refresh > 0);
  }
}

/// A system that does not tell how its nodes have turned.
struct WithoutFrames : System {
  std::vector<BlockRotations> frames(MatrixIn) const = delete;
};

// A slender bar that bends far hardly strains: its Hessian is that at rest, turned.
TEST(StaticSolver, AHessianThatTurnsWithTheNodesSavesIterations) {
  const TetMesh mesh = kuhn_box(16, 1, 1, 0.1);
  const System system(
      TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.3})),
      lumped_mass(mesh, 1000.0), nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; }));
  const SystemLoad<SparseMatrix> load = system.project({.gravity = {0, -0.6, 0}});
  const auto solve = [&](const auto& some, const NonlinearSolver& method, Vector& u) {
    StaticSolver solver(some, {.solver = method, .tolerance = 1e-8});
    u = Vector::Zero(system.dim());
    return solver.solve(load, u);
  };
  Vector u, turned, unturned;
  ASSERT_EQ(solve(system, Newton{}, u).status, Status::Converged);
  ASSERT_GT(u.lpNorm<Eigen::Infinity>(), 0.5) << "a third of its length";
  const SolveReport warped = solve(system, LineSearchBfgs{}, turned);
  EXPECT_EQ(warped.status, Status::Converged);
  EXPECT_EQ(warped.tangents, 0);
  EXPECT_TRUE(is_near(turned, u, 1e-5 * u.norm()));
  EXPECT_LT(3 * warped.iterations, 2 * solve(WithoutFrames{system}, LineSearchBfgs{}, unturned).iterations);
}

TEST(StaticSolver, NewtonsMethodTakesOverWhereWarpedStepsDoNotSuffice) {
  const PulledBar bar;
  Vector expected = Vector::Zero(bar.system.dim()), u = expected;
  StaticSolver newton(bar.system, {.tolerance = 1e-9});
  const SolveReport alone = newton.solve(bar.load(0.13), expected);
  StaticSolver warped(bar.system, {.solver = WarpedBfgs{.max_iterations = 3}, .tolerance = 1e-9});
  const SolveReport report = warped.solve(bar.load(0.13), u);
  EXPECT_EQ(report.status, Status::Converged);
  EXPECT_EQ(report.tangents, alone.tangents);
  EXPECT_EQ(report.iterations, 3 + alone.iterations);
  EXPECT_TRUE(is_near(u, expected, 1e-6 * expected.norm()));
  // and the next solve begins at rest again
  StaticSolver patient(bar.system, {.solver = WarpedBfgs{}, .tolerance = 1e-9});
  u.setZero();
  EXPECT_EQ(patient.solve(bar.load(0.13), u).tangents, 0);
  EXPECT_TRUE(is_near(u, expected, 1e-6 * expected.norm()));
}

TEST(StaticSolver, StartsFromTheLastEquilibriumAsLoadsMove) {
  const PulledBar bar;
  StaticSolver bfgs(bar.system, {.solver = LineSearchBfgs{}});
  Vector u = Vector::Zero(bar.system.dim());
  const Index far = bfgs.solve(bar.load(0.1), u).iterations, near = bfgs.solve(bar.load(0.101), u).iterations;
  EXPECT_LT(near, far);
  EXPECT_EQ(bfgs.solve(bar.load(0.101), u).iterations, 0);
  // springs that change make it prepare anew
  const SystemLoad<SparseMatrix> stiffer = bar.system.project({.springs = {{bar.end, 5000.0, Point(0, 0.1, 0)}}});
  EXPECT_EQ(bfgs.solve(stiffer, u).status, Status::Converged);
  Vector f(u.size());
  bar.system.force(u, f);
  const Vector balance = f + stiffer.stiffness * u - stiffer.force;
  EXPECT_LT(balance.norm(), 1e-6 * stiffer.force.norm() * 1.01);
}

// The scale of residuals is that of what the object bears, however stiff the springs that hold it.
TEST(StaticSolver, MeasuresResidualsAgainstTheForcesOfTheObject) {
  const PulledBar bar;
  for (const double stiffness : {5.0, 5e4, 5e8}) {
    const SystemLoad<SparseMatrix> load = bar.system.project({.springs = {{bar.end, stiffness, Point(0, 0.1, 0)}}});
    StaticSolver solver(bar.system);
    Vector u = Vector::Zero(bar.system.dim()), f = u;
    const SolveReport report = solver.solve(load, u);
    EXPECT_EQ(report.status, Status::Converged) << stiffness;
    bar.system.force(u, f);
    Vector balance = f;
    load.add_net_pull(u, balance);
    const double rounding = 1e-14 * stiffness * u.norm();
    EXPECT_LT(balance.norm(), 1e-6 * f.norm() * 1.01 + rounding) << stiffness;
    EXPECT_NEAR(report.residual * f.norm(), balance.norm(), 0.01 * balance.norm() + rounding) << stiffness;
  }
}

TEST(StaticSolver, LeavesAnUnloadedBodyWhereItIs) {
  const PulledBar bar;
  for (const NonlinearSolver& method : {NonlinearSolver(Newton{}), NonlinearSolver(LineSearchBfgs{})}) {
    StaticSolver solver(bar.system, {.solver = method});
    Vector u = Vector::Zero(bar.system.dim());
    EXPECT_EQ(solver.solve({Vector::Zero(u.size()), {}}, u).iterations, 0);
    EXPECT_TRUE(u.isZero(0));
  }
}

TEST(StaticSolver, EscapesAnUnstableEquilibrium) {
  // squeezed straight, the bar is an equilibrium by symmetry only; the minimum is buckled
  const PulledBar bar;
  Loads squeeze;
  for (const Index v : nodes_where(bar.mesh, [](const Point& x) { return x[0] > 0.35; }))
    squeeze.forces.push_back({v, Point(-40, 0.01, 0)});
  const SystemLoad<SparseMatrix> load = bar.system.project(squeeze);
  StaticSolver newton(bar.system);
  Vector u = Vector::Zero(bar.system.dim());
  ASSERT_EQ(newton.solve(load, u).status, Status::Converged);
  EXPECT_GT(symmetric_eigenvalues(bar.system.stiffness(u))[0], 0);
}

/// One unknown in a well cosh u − 1, whose tangent can be made to fail away from rest.
struct FailingWell {
  using MatrixType = Matrix;
  static constexpr bool symmetric_tangent = true;
  Vector ones = Vector::Ones(1);
  Matrix K0 = Matrix::Identity(1, 1);
  bool fails = false;

  Index dim() const { return 1; }
  const Vector& mass() const { return ones; }
  double energy(VectorIn u) const { return std::cosh(u[0]) - 1; }
  void force(VectorIn u, VectorOut f) const { f[0] = std::sinh(u[0]); }
  void stiffness(VectorIn u, Matrix& K) const {
    K = Matrix::Constant(1, 1, fails && u[0] != 0 ? std::nan("") : std::cosh(u[0]));
  }
  const Matrix& rest_stiffness() const { return K0; }
  SystemLoad<Matrix> project(const Loads&) const { return {Vector::Zero(1), {}}; }
};

TEST(StaticSolver, GoesOnAfterATangentThatFailed) {
  FailingWell well;
  StaticSolver solver(well, {.solver = LineSearchBfgs{.refresh_after = 1}});
  const SystemLoad<Matrix> load{Vector::Constant(1, 50.0), {}};
  Vector u = Vector::Zero(1);
  well.fails = true;
  EXPECT_NE(solver.solve(load, u).status, Status::Converged);
  well.fails = false;
  u.setZero();
  EXPECT_EQ(solver.solve(load, u).status, Status::Converged);
  EXPECT_NEAR(u[0], std::asinh(50.0), 1e-5);
}

TEST(StaticSolver, RefusesWhatMakesNoSense) {
  const PulledBar bar;
  EXPECT_THROW(StaticSolver(bar.system, {.tolerance = 0}), std::invalid_argument);
  StaticSolver solver(bar.system);
  Vector u = Vector::Zero(5);
  EXPECT_THROW((void)solver.solve(bar.load(0.1), u), std::invalid_argument);
  StaticSolver nlopt(bar.system, {.solver = Nlopt{}});
  Vector w = Vector::Zero(bar.system.dim());
  EXPECT_THROW((void)nlopt.solve(bar.load(0.1), w), std::invalid_argument);
  w.setConstant(std::nan(""));
  EXPECT_EQ(solver.solve(bar.load(0.1), w).status, Status::NotFinite);
}

/// f and its gradient in closed form.
TEST(Bfgs, MinimisesRosenbrocksFunction) {
  struct Rosenbrock {
    using MatrixType = Matrix;
    Vector ones = Vector::Ones(2);
    double value(VectorIn x) const { return std::pow(1 - x[0], 2) + 100 * std::pow(x[1] - x[0] * x[0], 2); }
    void gradient(VectorIn x, VectorOut g) const {
      const double r = x[1] - x[0] * x[0];
      g[0] = -2 * (1 - x[0]) - 400 * x[0] * r;
      g[1] = 200 * r;
    }
    void hessian(VectorIn x, Matrix& H) const {
      H.resize(2, 2);
      H << 2 - 400 * (x[1] - 3 * x[0] * x[0]), -400 * x[0], -400 * x[0], 200;
    }
    double scale(VectorIn) const { return 1; }
    const Vector& metric() const { return ones; }
  } objective;
  SpdSolver<Matrix> solver;
  ASSERT_TRUE(solver.factorize(Matrix::Identity(2, 2)));
  Vector x(2);
  x << -1.2, 1;
  const SolveReport report = LineSearchBfgs{}(objective, solver, x, {.tolerance = 1e-10, .max_iterations = 200});
  EXPECT_EQ(report.status, Status::Converged);
  EXPECT_TRUE(is_near(x, Vector::Ones(2), 1e-8));
  EXPECT_LT(report.iterations, 60);  // some 35 in the literature

  for (const NloptMethod method :
       {NloptMethod::Lbfgs, NloptMethod::VariableMetric, NloptMethod::TruncatedNewton, NloptMethod::Slsqp}) {
    x << -1.2, 1;
    const Report nlopt = minimize_by_nlopt(
        [&](VectorIn at, VectorOut g) {
          objective.gradient(at, g);
          return objective.value(at);
        },
        [](VectorIn, VectorIn g) { return g.norm(); }, x, {.method = method, .tolerance = 1e-6});
    EXPECT_EQ(nlopt.status, Status::Converged) << static_cast<int>(method);
    EXPECT_TRUE(is_near(x, Vector::Ones(2), 1e-4));
  }
}

// NLopt's own methods end where a gradient is small in the units it is given in.
TEST(Nlopt, MindsNoUnits) {
  const Matrix A = Vector::LinSpaced(6, 1, 30).asDiagonal();
  const Vector b = Vector::LinSpaced(6, 1, 2), solution = A.diagonal().cwiseInverse().cwiseProduct(b);
  for (const double joules : {1e-24, 1.0, 1e24})
    for (const double metres : {1e-9, 1.0, 1e9}) {
      Vector x = Vector::Zero(6);
      const Report report = minimize_by_nlopt(
          [&](VectorIn u, VectorOut g) {
            const Vector y = u / metres;
            g = joules / metres * (A * y - b);
            return joules * (0.5 * y.dot(A * y) - b.dot(y));
          },
          [&](VectorIn, VectorIn g) { return g.norm() * metres / joules; }, x, {.tolerance = 1e-7},
          std::sqrt(joules) / metres * Matrix(Matrix::Identity(6, 6)));
      EXPECT_EQ(report.status, Status::Converged) << joules << " J, " << metres << " m: " << report.residual;
      EXPECT_TRUE(is_near(x / metres, solution, 1e-6)) << joules << " J, " << metres << " m";
    }
}

TEST(Bfgs, FindsAQuadraticsMinimumInAsManyStepsAsItHasUnknowns) {
  struct Quadratic {
    using MatrixType = Matrix;
    Matrix A;
    Vector b, ones;
    double value(VectorIn x) const { return 0.5 * x.dot(A * x) - b.dot(x); }
    void gradient(VectorIn x, VectorOut g) const { g = A * x - b; }
    void hessian(VectorIn, Matrix& H) const { H = A; }
    double scale(VectorIn) const { return b.norm(); }
    const Vector& metric() const { return ones; }
  } objective{Vector::LinSpaced(8, 1, 9).asDiagonal(), Vector::Ones(8), Vector::Ones(8)};
  SpdSolver<Matrix> exact, identity;
  ASSERT_TRUE(exact.factorize(objective.A) && identity.factorize(Matrix::Identity(8, 8)));
  Vector x = Vector::Zero(8), y = x;
  EXPECT_EQ(LineSearchBfgs{}(objective, exact, x, {.tolerance = 1e-12}).iterations, 1);
  EXPECT_LT(LineSearchBfgs{}(objective, identity, y, {.tolerance = 1e-10}).iterations, 25);
  EXPECT_TRUE(is_near(y, x, 1e-8));
}

}  // namespace
}  // namespace supple::test
