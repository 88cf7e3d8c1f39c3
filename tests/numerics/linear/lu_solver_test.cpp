#include <core/parallel.hpp>
#include <numerics/linear/lu_solver.hpp>
#include <numerics/optimize/newton.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/heat.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace supple::test {
namespace {

SparseMatrix heat_tangent(double amplitude) {
  const HeatedBar bar;
  return bar.system->stiffness(random_vector(bar.system->dim(), amplitude, 5));
}

TEST(LuSolver, SolvesWithTangentsThatAreNotSymmetric) {
  const SparseMatrix A = heat_tangent(100);
  const Matrix dense = A;
  ASSERT_GT((dense - dense.transpose()).norm(), 0.05 * dense.norm());
  const Vector x = random_vector(A.rows(), 1, 6), b = A * x;
  LuSolver<SparseMatrix> sparse;
  ASSERT_TRUE(sparse.factorize(A));
  EXPECT_TRUE(is_near(sparse.solve(b), x, 1e-10));
  LuSolver<Matrix> full;
  ASSERT_TRUE(full.factorize(dense));
  EXPECT_TRUE(is_near(full.solve(b), x, 1e-10));
  ASSERT_TRUE(sparse.factorize(2 * A)) << "values may change";
  EXPECT_TRUE(is_near(sparse.solve(b), x / 2, 1e-10));
}

TEST(LuSolver, TellsOfMatricesItCannotSolveWith) {
  SparseMatrix A = heat_tangent(50);
  LuSolver<SparseMatrix> sparse;
  EXPECT_THROW((void)sparse.solve(Vector::Ones(A.rows())), std::invalid_argument);
  ASSERT_TRUE(sparse.factorize(A));
  EXPECT_THROW((void)sparse.solve(Vector::Ones(A.rows() - 1)), std::invalid_argument);
  EXPECT_FALSE(sparse.factorize(0 * A));
  EXPECT_THROW((void)sparse.solve(Vector::Ones(A.rows())), std::invalid_argument) << "the old factor is gone";
  A.valuePtr()[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(sparse.factorize(A));
  EXPECT_THROW(UmfpackSolver().analyze(SparseMatrix(3, 4)), std::invalid_argument);
  EXPECT_THROW(UmfpackSolver().analyze(SparseMatrix(0, 0)), std::invalid_argument);

  LuSolver<Matrix> dense;
  EXPECT_THROW((void)dense.solve(Vector::Ones(2)), std::invalid_argument);
  EXPECT_FALSE(dense.factorize(Matrix::Zero(2, 2)));
  EXPECT_FALSE(dense.factorize(Matrix::Constant(2, 2, std::numeric_limits<double>::infinity())));
  ASSERT_TRUE(dense.factorize((Matrix(2, 2) << 0, 1, -1, 0).finished()));
  EXPECT_TRUE(is_near(dense.solve(Vector::Unit(2, 0)), Vector::Unit(2, 1), 1e-15)) << "pivots are sought";
  EXPECT_THROW((void)dense.factorize(Matrix::Ones(2, 3)), std::invalid_argument);
}

/// r given by lambdas.
template <typename Residual, typename Jacobian>
struct DenseResidual {
  using MatrixType = Matrix;
  Residual r;
  Jacobian J;
  void residual(VectorIn u, VectorOut out) { out = r(u); }
  void jacobian(VectorIn u, Matrix& out) const { out = J(u); }
  double scale(VectorIn) const { return 1; }
};
template <typename Residual, typename Jacobian>
DenseResidual(Residual, Jacobian) -> DenseResidual<Residual, Jacobian>;

// Newton's method alone diverges for |x| > 1.39 on arctan.
TEST(NewtonSolve, ShortensStepsThatWouldDiverge) {
  DenseResidual equation{[](VectorIn u) -> Vector { return u.array().atan(); },
                         [](VectorIn u) -> Matrix { return (1 / (1 + u.array().square())).matrix().asDiagonal(); }};
  Vector u = Vector::Constant(2, 3);
  u[1] = -20;
  LuSolver<Matrix> solver;
  const Report report = Newton{}(equation, solver, u, {.tolerance = 1e-12});
  EXPECT_EQ(report.status, Status::Converged);
  EXPECT_TRUE(is_near(u, Vector::Zero(2), 1e-12));
}

// A force that turns: no potential, its tangent is as far from symmetric as can be.
TEST(NewtonSolve, SolvesEquationsWithoutAPotentialQuadratically) {
  const auto r = [](VectorIn u) -> Vector { return Vector{{-u[1] + 0.1 * u[0] * u[0] - 1, u[0] + std::sin(u[1])}}; };
  DenseResidual equation{
      r, [](VectorIn u) -> Matrix { return (Matrix(2, 2) << 0.2 * u[0], -1, 1, std::cos(u[1])).finished(); }};
  Vector u = Vector::Zero(2);
  LuSolver<Matrix> solver;
  const Report report = Newton{}(equation, solver, u, {.tolerance = 1e-14});
  EXPECT_EQ(report.status, Status::Converged);
  EXPECT_LE(report.iterations, 6);
  EXPECT_LT(r(u).norm(), 1e-14);
}

TEST(NewtonSolve, SaysWhyItStopped) {
  DenseResidual no_root{[](VectorIn u) -> Vector { return u.array().square() + 1; },
                        [](VectorIn u) -> Matrix { return (2 * u).asDiagonal(); }};
  LuSolver<Matrix> solver;
  Vector u = Vector::Constant(1, 2);
  EXPECT_NE(Newton{}(no_root, solver, u, {.max_iterations = 30}).status, Status::Converged);
  EXPECT_TRUE(u.allFinite());
  u.setZero();  // J = 0
  EXPECT_EQ(Newton{}(no_root, solver, u).status, Status::Stagnated);
  u.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(Newton{}(no_root, solver, u).status, Status::NotFinite);
  u.setConstant(1e9);
  EXPECT_EQ(Newton{}(no_root, solver, u, {.max_iterations = 1}).status, Status::MaxIterations);
}

}  // namespace
}  // namespace supple::test
