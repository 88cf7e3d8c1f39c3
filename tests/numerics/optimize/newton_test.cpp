#include <numerics/optimize/newton.hpp>
#include <numerics/optimize/quasi_newton.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/statics/equilibrium.hpp>
#include <physics/system/full_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

/// φ given by lambdas over a few unknowns.
template <typename Value, typename Gradient, typename Hessian>
struct DenseObjective {
  using MatrixType = Matrix;
  Value phi;
  Gradient g;
  Hessian H;
  Vector ones;

  DenseObjective(Index dim, Value value_, Gradient gradient_, Hessian hessian_)
      : phi(value_), g(gradient_), H(hessian_), ones(Vector::Ones(dim)) {}
  double value(VectorIn u) const { return phi(u); }
  void gradient(VectorIn u, VectorOut out) const { out = g(u); }
  void hessian(VectorIn u, Matrix& out) const { out = H(u); }
  double scale(VectorIn) const { return 1; }
  const Vector& metric() const { return ones; }
};

/// A bar of 4 × 1 × 1 cubes, clamped at x = 0, that bends under its weight by about half its length.
template <template <typename> class Material>
struct Cantilever {
  using System = FullSystem<TetElasticity<Material>>;
  TetMesh mesh = perturbed(kuhn_box(4, 1, 1, 0.1), 0.005, 3);
  System system{TetElasticity<Material>(mesh, Material<double>::from({.young = 3e4, .poisson = 0.3})),
                lumped_mass(mesh, 1000.0), nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; })};
  Equilibrium<System> problem{system, system.project({.gravity = {0, -9.81, 0}})};
};

template <typename Fixture>
class StaticTest : public testing::Test {
 protected:
  Fixture cantilever;
};
using Cantilevers = testing::Types<Cantilever<StVenantKirchhoff>, Cantilever<MooneyRivlin>>;
TYPED_TEST_SUITE(StaticTest, Cantilevers);

TYPED_TEST(StaticTest, NewtonFindsTheEquilibriumUnderGravityQuadratically) {
  const auto& system = this->cantilever.system;
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(system.dim());
  const Report report = Newton{}(this->cantilever.problem, solver, u, {.tolerance = 1e-10, .max_iterations = 30});
  ASSERT_EQ(report.status, Status::Converged) << report.residual;
  EXPECT_LE(report.residual, 1e-10);
  EXPECT_GT(u.template lpNorm<Eigen::Infinity>(), 0.05) << "a large deformation";
  const Vector weight = system.project({.gravity = {0, -9.81, 0}, .forces = {}, .springs = {}}).force;
  EXPECT_TRUE(is_near(system.force(u), weight, 1e-10 * weight.norm()));
  // the reaction at the clamp carries the weight of the free part
  Vector reaction(3 * system.num_nodes());
  system.full_force(system.expand(u), reaction);
  double vertical = 0, expected = 0;
  for (const Index v : system.numbering().fixed_nodes()) vertical += reaction[3 * v + 1];
  for (const Index v : system.numbering().free_nodes()) expected += 9.81 * system.nodal_mass()[v];
  EXPECT_NEAR(vertical, expected, 1e-8 * expected);

  // near the solution the next error is at most a constant (of this bar: 25 / m) times the square of this one
  std::vector<double> errors;
  Vector w = 0.98 * u;
  for (int k = 0; k < 8; ++k) {
    errors.push_back((w - u).norm());
    (void)Newton{}(this->cantilever.problem, solver, w, {.tolerance = 0, .max_iterations = 1});
  }
  SCOPED_TRACE(testing::PrintToString(errors));
  int quadratic = 0;
  for (std::size_t k = 0; k + 1 < errors.size() && errors[k + 1] > 1e-10; ++k, ++quadratic)
    EXPECT_LT(errors[k + 1], 100 * errors[k] * errors[k]);
  EXPECT_GE(quadratic, 3);
  EXPECT_LT(errors.back(), 1e-10);
}

/// test(memory) for each kind of memory, empty.
template <typename Test>
void with_every_memory(const Test& test) {
  {
    SCOPED_TRACE("BFGS");
    test(BfgsMemory());
  }
  SCOPED_TRACE("Broyden");
  test(BroydenMemory());
}

TYPED_TEST(StaticTest, QuasiNewtonAgreesWithNewton) {
  // a fifth of the weight: under all of it the bar has several equilibria
  const auto& system = this->cantilever.system;
  Equilibrium<typename TypeParam::System> problem(system, system.project({.gravity = {0, -2, 0}}));
  SpdSolver<SparseMatrix> newton, solver;
  Vector u = Vector::Zero(system.dim());
  (void)Newton{}(problem, newton, u, {.tolerance = 1e-11, .max_iterations = 40});
  with_every_memory([&](auto memory) {
    ASSERT_TRUE(solver.factorize(system.rest_stiffness()));
    Vector w = Vector::Zero(system.dim());
    const SolveReport report =
        quasi_newton_solve(problem, solver, memory, w, {.tolerance = 1e-10, .max_iterations = 300});
    EXPECT_EQ(report.status, Status::Converged) << to_string(report.status) << ", " << report.residual;
    EXPECT_TRUE(is_near(w, u, 1e-7));  // residual 1e-10 times the condition of the stiffness
  });
}

TYPED_TEST(StaticTest, QuasiNewtonKeepsTheJacobianWhereItHelps) {
  // a hundredth of the weight: nearly linear, so the Jacobian at rest does
  const auto& system = this->cantilever.system;
  Equilibrium<typename TypeParam::System> light(system, system.project({.gravity = {0, -0.01, 0}}));
  SpdSolver<SparseMatrix> solver;
  ASSERT_TRUE(solver.factorize(system.rest_stiffness()));
  with_every_memory([&](auto memory) {
    Vector u = Vector::Zero(system.dim());
    const SolveReport report = quasi_newton_solve(light, solver, memory, u, {.tolerance = 1e-10});
    EXPECT_EQ(report.status, Status::Converged);
    EXPECT_EQ(report.tangents, 0);
    EXPECT_LE(report.iterations, 12);
    const Vector start = u;
    memory.clear();
    EXPECT_EQ(quasi_newton_solve(light, solver, memory, u, {.tolerance = 1e-10}).iterations, 0) << "already there";
    EXPECT_TRUE(is_same(u, start));
  });
}

TYPED_TEST(StaticTest, ASecondSolveUsesWhatTheFirstHasLearnt) {
  const auto& system = this->cantilever.system;
  Equilibrium<typename TypeParam::System> problem(system, system.project({.gravity = {0, -0.1, 0}}));
  SpdSolver<SparseMatrix> solver;
  ASSERT_TRUE(solver.factorize(system.rest_stiffness()));
  BfgsMemory memory;
  const auto iterations = [&] {
    Vector u = Vector::Zero(system.dim());
    const auto report =
        quasi_newton_solve(problem, solver, memory, u, {.tolerance = 1e-10, .max_iterations = 60}, 1000);
    EXPECT_EQ(report.status, Status::Converged);
    EXPECT_EQ(report.tangents, 0);
    return report.iterations;
  };
  const Index first = iterations();
  EXPECT_LT(iterations(), first);
}

TEST(QuasiNewton, IsExactForALinearProblemWithItsJacobian) {
  const Matrix A = (Matrix(2, 2) << 4, 1, 1, 3).finished();
  const Vector b = Vector::Ones(2);
  DenseObjective objective(
      2, [&](VectorIn u) { return 0.5 * u.dot(A * u) - b.dot(u); }, [&](VectorIn u) { return Vector(A * u - b); },
      [&](VectorIn) { return A; });
  SpdSolver<Matrix> solver;
  with_every_memory([&](auto memory) {
    ASSERT_TRUE(solver.factorize(A));
    Vector u = Vector::Zero(2);
    const SolveReport exact = quasi_newton_solve(objective, solver, memory, u, {.tolerance = 1e-14});
    EXPECT_EQ(exact.status, Status::Converged);
    EXPECT_EQ(exact.iterations, 1);
    // from another matrix Broyden's method ends after at most 2 d steps (Gay 1979)
    ASSERT_TRUE(solver.factorize(5 * Matrix::Identity(2, 2)));
    u.setZero();
    memory.clear();
    const SolveReport other =
        quasi_newton_solve(objective, solver, memory, u, {.tolerance = 1e-12, .max_iterations = 20}, 100);
    EXPECT_EQ(other.status, Status::Converged);
    EXPECT_EQ(other.tangents, 0);
    EXPECT_LE(other.iterations, (std::is_same_v<decltype(memory), BroydenMemory> ? 5 : 10));
    EXPECT_TRUE(is_near(A * u, b, 1e-11));
  });
}

/// The matrix that a memory stands for, beside H₀ = 2 I.
Matrix inverse_of(const BfgsMemory& memory, Index d) {
  SpdSolver<Matrix> solver;
  EXPECT_TRUE(solver.factorize(0.5 * Matrix::Identity(d, d)));
  Matrix inverse(d, d);
  for (Index j = 0; j < d; ++j) inverse.col(j) = memory.inverse_times(solver, Vector::Unit(d, j));
  return inverse;
}

TEST(BfgsMemory, IsSymmetricPositiveDefiniteAndMeetsTheLastSecant) {
  const Index d = 6;
  BfgsMemory memory;
  for (int k = 0; k < 12; ++k) {
    const Vector s = random_vector(d, 1, k);
    const Vector y = s.cwiseProduct(Vector::LinSpaced(d, 1, 9)) + random_vector(d, 0.01, 100 + k);
    memory.add(s, y);
    const Matrix inverse = inverse_of(memory, d);
    EXPECT_TRUE(is_near(inverse * y, s, 1e-12));
    EXPECT_TRUE(is_near(inverse, inverse.transpose(), 1e-12));
    EXPECT_TRUE(SpdSolver<Matrix>().factorize(inverse));
  }
  EXPECT_EQ(memory.size(), 12);
}

TEST(BfgsMemory, ForgetsTheOldestAndLeavesOutWhatIsNotConvex) {
  const Index d = 5;
  BfgsMemory limited(3), last;
  for (int k = 0; k < 7; ++k) {
    const Vector s = random_vector(d, 1, k);
    limited.add(s, 3 * s);
    limited.add(s, -s);
    limited.add(s, Vector::Zero(d));
    limited.add(s, s * std::numeric_limits<double>::quiet_NaN());
    if (k >= 4) last.add(s, 3 * s);
  }
  EXPECT_EQ(limited.size(), 3);
  EXPECT_TRUE(is_same(inverse_of(limited, d), inverse_of(last, d)));
  limited.clear();
  EXPECT_EQ(limited.size(), 0);
  EXPECT_THROW(BfgsMemory(0), std::invalid_argument);
  EXPECT_TRUE(is_near(inverse_of(limited, d), 2 * Matrix::Identity(d, d), 1e-15));
}

TEST(Newton, LeavesAMaximumAndASaddleForAMinimum) {
  // double well: the tangent is negative around 0
  DenseObjective well(
      1, [](VectorIn u) { return std::pow(u[0] * u[0] - 1, 2) / 4; },
      [](VectorIn u) { return Vector::Constant(1, u[0] * (u[0] * u[0] - 1)); },
      [](VectorIn u) { return Matrix::Constant(1, 1, 3 * u[0] * u[0] - 1); });
  SpdSolver<Matrix> solver;
  for (const double start : {0.1, -0.3, 0.5}) {
    Vector u = Vector::Constant(1, start);
    const Report report = Newton{}(well, solver, u, {.tolerance = 1e-10, .max_iterations = 60});
    EXPECT_EQ(report.status, Status::Converged);
    EXPECT_NEAR(u[0], start > 0 ? 1 : -1, 1e-9);
  }

  // x y + (x⁴ + y⁴) / 4: a saddle at 0, where the diagonal of the tangent vanishes, and minima at ±(1, −1)
  DenseObjective saddle(
      2, [](VectorIn u) { return u[0] * u[1] + (std::pow(u[0], 4) + std::pow(u[1], 4)) / 4; },
      [](VectorIn u) { return Vector((Vector(2) << u[1] + std::pow(u[0], 3), u[0] + std::pow(u[1], 3)).finished()); },
      [](VectorIn u) { return Matrix((Matrix(2, 2) << 3 * u[0] * u[0], 1, 1, 3 * u[1] * u[1]).finished()); });
  for (const Vector& start : {(Vector(2) << 0.1, 0.0).finished(), (Vector(2) << 0.0, 1e-9).finished()}) {
    Vector u = start;
    const Report report = Newton{}(saddle, solver, u, {.tolerance = 1e-10, .max_iterations = 60});
    EXPECT_EQ(report.status, Status::Converged) << "at " << u.transpose();
    EXPECT_NEAR(saddle.value(u), -0.5, 1e-12) << "at " << u.transpose();
  }

  // x² − y² + y⁴: the trace of the tangent vanishes at 0, minima at (0, ±1/√2)
  DenseObjective traceless(
      2, [](VectorIn u) { return u[0] * u[0] - u[1] * u[1] + std::pow(u[1], 4); },
      [](VectorIn u) { return Vector((Vector(2) << 2 * u[0], -2 * u[1] + 4 * std::pow(u[1], 3)).finished()); },
      [](VectorIn u) { return Matrix((Matrix(2, 2) << 2, 0, 0, -2 + 12 * u[1] * u[1]).finished()); });
  Vector u = (Vector(2) << 1, 1e-12).finished();
  const Report report = Newton{}(traceless, solver, u, {.tolerance = 1e-10, .max_iterations = 100});
  EXPECT_EQ(report.status, Status::Converged) << "at " << u.transpose();
  EXPECT_NEAR(std::abs(u[1]), std::sqrt(0.5), 1e-9);
}

TEST(Newton, TakesLongStepsAlongSoftDirectionsWhereTheTangentIsIndefinite) {
  // a thin shell in small: stretching 10⁸ times as stiff as the direction in which it buckles
  DenseObjective shell(
      2, [](VectorIn u) { return 0.5e8 * u[0] * u[0] + std::pow(u[1] * u[1] - 1, 2) / 4; },
      [](VectorIn u) { return Vector((Vector(2) << 1e8 * u[0], u[1] * (u[1] * u[1] - 1)).finished()); },
      [](VectorIn u) { return Matrix((Matrix(2, 2) << 1e8, 0, 0, 3 * u[1] * u[1] - 1).finished()); });
  SpdSolver<Matrix> solver;
  Vector u = (Vector(2) << 1e-3, 0.01).finished();
  const Report report = Newton{}(shell, solver, u, {.tolerance = 1e-10, .max_iterations = 40});
  EXPECT_EQ(report.status, Status::Converged);
  EXPECT_NEAR(u[1], 1, 1e-8);
}

TEST(Newton, ConvergesFromACompressedStateWithAnIndefiniteTangent) {
  const Cantilever<StVenantKirchhoff> c;
  // squeezed along x to 60 %: St. Venant–Kirchhoff has lost its stability there (below 1/√3 even in 1D)
  const Vector squeezed =
      c.system.restrict(affine_displacement(c.mesh.nodes, Point(0.6, 1, 1).asDiagonal().toDenseMatrix()));
  SpdSolver<SparseMatrix> solver;
  ASSERT_FALSE(solver.factorize(c.system.stiffness(squeezed))) << "the test needs an indefinite tangent";
  Equilibrium<FullSystem<TetElasticity<StVenantKirchhoff>>> free(c.system, {Vector::Zero(c.system.dim()), {}});
  Vector u = squeezed;
  const double before = free.value(u);
  // no load, so ‖f‖ / ‖f‖ = 1 and the relative residual says nothing: all it can do is go down to rounding
  const Report report = Newton{}(free, solver, u, {.tolerance = 1e-9, .max_iterations = 100});
  EXPECT_NE(report.status, Status::NotFinite);
  EXPECT_LT(free.value(u), 1e-6 * before);
  EXPECT_TRUE(is_near(u, Vector::Zero(u.size()), 1e-4));
}

TEST(Newton, ReportsStagnationWhenRoundingAllowsNoFurtherDecrease) {
  Cantilever<StVenantKirchhoff> c;
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(c.system.dim());
  const Report report = Newton{}(c.problem, solver, u, {.tolerance = 1e-30, .max_iterations = 200});
  EXPECT_EQ(report.status, Status::Stagnated);
  EXPECT_LT(report.residual, 1e-12);
  // the residual reported is that of the u returned
  Vector g(u.size());
  c.problem.gradient(u, g);
  EXPECT_EQ(report.residual, g.norm() / c.problem.scale(u));
}

TEST(Newton, ReportsStagnationForAGradientThatIsNotOfThisFunction) {
  DenseObjective wrong(
      1, [](VectorIn u) { return -u[0]; }, [](VectorIn) { return Vector::Constant(1, 1.0); },
      [](VectorIn) { return Matrix::Identity(1, 1); });
  SpdSolver<Matrix> solver;
  Vector u = Vector::Zero(1);
  const Report report = Newton{}(wrong, solver, u);
  EXPECT_EQ(report.status, Status::Stagnated);
  EXPECT_EQ(u[0], 0);
}

TEST(Newton, StopsAtTheLimitOfIterationsAndSaysSo) {
  Cantilever<StVenantKirchhoff> c;
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(c.system.dim());
  const Report report = Newton{}(c.problem, solver, u, {.tolerance = 1e-10, .max_iterations = 2});
  EXPECT_EQ(report.status, Status::MaxIterations);
  EXPECT_EQ(report.iterations, 2);
  EXPECT_GT(report.residual, 1e-10);
}

TEST(Newton, ShortensStepsThatLeaveTheDomain) {
  // −log x + x: the full step from 2.5 goes to x < 0, where the function is undefined
  DenseObjective barrier(
      1, [](VectorIn u) { return u[0] > 0 ? u[0] - std::log(u[0]) : std::numeric_limits<double>::infinity(); },
      [](VectorIn u) {
        return Vector::Constant(1, u[0] > 0 ? 1 - 1 / u[0] : std::numeric_limits<double>::quiet_NaN());
      },
      [](VectorIn u) { return Matrix::Constant(1, 1, 1 / (u[0] * u[0])); });
  SpdSolver<Matrix> solver;
  Vector u = Vector::Constant(1, 2.5);
  const Report report = Newton{}(barrier, solver, u, {.tolerance = 1e-10, .max_iterations = 30});
  EXPECT_EQ(report.status, Status::Converged);
  EXPECT_NEAR(u[0], 1, 1e-9);
}

TEST(Newton, EndsWithNotFiniteWhereTheStartIsNot) {
  Cantilever<StVenantKirchhoff> c;
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(c.system.dim());
  u[4] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Newton{}(c.problem, solver, u).status, Status::NotFinite);
  ASSERT_TRUE(solver.factorize(c.system.rest_stiffness()));
  with_every_memory(
      [&](auto memory) { EXPECT_EQ(quasi_newton_solve(c.problem, solver, memory, u).status, Status::NotFinite); });
  EXPECT_EQ(u.array().isNaN().count(), 1) << "u stays as it was";
}

TEST(SpdSolver, DenseRefusesWhatIsNotPositiveDefinite) {
  SpdSolver<Matrix> solver;
  EXPECT_THROW((void)solver.solve(Vector::Ones(2)), std::invalid_argument) << "nothing factorised yet";
  EXPECT_FALSE(solver.factorize((Matrix(2, 2) << 1, 2, 2, 1).finished()));
  EXPECT_FALSE(solver.factorize(Matrix::Zero(2, 2)));
  Matrix A = 2 * Matrix::Identity(3, 3);
  ASSERT_TRUE(solver.factorize(A));
  EXPECT_TRUE(is_near(solver.solve(Vector::Ones(3)), Vector::Constant(3, 0.5), 1e-15));
  EXPECT_THROW((void)solver.solve(Vector::Ones(2)), std::invalid_argument);
  A(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solver.factorize(A));
  EXPECT_THROW((void)solver.solve(Vector::Ones(3)), std::invalid_argument) << "as the sparse one does";
}

TEST(SpdSolver, SparseFollowsAChangeOfSize) {
  SpdSolver<SparseMatrix> solver;
  const auto diagonal = [](Index n) {
    SparseMatrix A(n, n);
    A.setIdentity();
    return A;
  };
  ASSERT_TRUE(solver.factorize(diagonal(6)));
  ASSERT_TRUE(solver.factorize(diagonal(9)));
  EXPECT_TRUE(is_near(solver.solve(Vector::Ones(9)), Vector::Ones(9), 1e-15));
}

}  // namespace
}  // namespace supple::test
