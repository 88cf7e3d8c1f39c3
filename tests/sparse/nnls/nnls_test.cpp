#include <sparse/nnls/nnls.hpp>
#include <tests/sparse/problems.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace supple {
namespace {

using test::gaussian;
using test::uniform;

NnlsSolution solve(const Matrix& A, const Vector& b, std::span<const Index> passive = {}) {
  return Fnnls{}(A.transpose() * A, A.transpose() * b, passive);
}

// The conditions of Karush, Kuhn and Tucker, evaluated on A itself; columns and b scaled to one.
double kkt_residual(const Matrix& A, const Vector& b, const Vector& w) {
  const Vector r = b - A * w;
  double worst = 0;
  for (Index j = 0; j < A.cols(); ++j) {
    const double norm = A.col(j).norm();
    if (norm == 0) continue;
    const double g = A.col(j).dot(r) / norm;
    worst = std::max(worst, w[j] > 0 ? std::abs(g) : g);
  }
  return b.norm() > 0 ? worst / b.norm() : worst;
}

void expect_optimal(const Matrix& A, const Vector& b, const NnlsSolution& solution, const char* what) {
  ASSERT_EQ(solution.w.size(), A.cols()) << what;
  EXPECT_TRUE((solution.w.array() >= 0).all()) << what;
  EXPECT_LE(kkt_residual(A, b, solution.w), 1e-11) << what;
  EXPECT_LE(solution.report.residual, 1e-10) << what;
}

TEST(Fnnls, SatisfiesTheOptimalityConditionsOnRandomProblems) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const Index rows = 5 + static_cast<Index>(seed * 7 % 60), cols = 3 + static_cast<Index>(seed * 5 % 40);
    const Matrix A = seed % 2 ? gaussian(rows, cols, seed) : uniform(rows, cols, seed);
    const Vector b = gaussian(rows, 1, 1000 + seed);
    expect_optimal(A, b, solve(A, b), ("seed " + std::to_string(seed)).c_str());
  }
}

TEST(Fnnls, RecoversAPlantedSolution) {
  const Matrix A = gaussian(80, 50, 1);
  const Vector w = test::planted_weights(50, test::random_subset(50, 20, 2), 3);
  EXPECT_TRUE(solve(A, A * w).w.isApprox(w, 1e-11));
}

TEST(Fnnls, ReturnsTheUnconstrainedSolutionWhereThatIsPositive) {
  const Matrix A = gaussian(60, 30, 1);
  const Vector w = Vector::Constant(30, 2) + uniform(30, 1, 2);
  const Vector b = A * w;
  const NnlsSolution solution = solve(A, b);
  EXPECT_EQ(solution.passive.indices.size(), 30u);
  EXPECT_TRUE(solution.w.isApprox(w, 1e-11));
}

TEST(Fnnls, HandlesARankDeficientMatrix) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Matrix A = gaussian(40, 6, seed) * gaussian(6, 25, 100 + seed);
    const Vector b = gaussian(40, 1, 200 + seed);
    expect_optimal(A, b, solve(A, b), "rank 6 of 25");
  }
}

TEST(Fnnls, HandlesCopiesOfColumns) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Matrix half = gaussian(30, 12, seed);
    Matrix A(30, 36);
    A << half, half, 3 * half;
    const Vector b = half * uniform(12, 1, 300 + seed) + 0.1 * gaussian(30, 1, 400 + seed);
    const NnlsSolution solution = solve(A, b);
    expect_optimal(A, b, solution, "every column three times");
    EXPECT_LE((solution.w.array() > 0).count(), 12);
    EXPECT_NEAR((b - A * solution.w).norm(), (b - half * solve(half, b).w).norm(), 1e-12 * b.norm());
  }
}

TEST(Fnnls, HandlesMoreColumnsThanRows) {
  const Matrix A = gaussian(10, 60, 8);
  const Vector b = gaussian(10, 1, 9);
  const NnlsSolution solution = solve(A, b);
  expect_optimal(A, b, solution, "10 x 60");
  EXPECT_LE((solution.w.array() > 0).count(), 10);
}

TEST(Fnnls, IgnoresZeroColumns) {
  Matrix A = gaussian(20, 8, 1);
  A.col(3).setZero();
  const Vector b = A * Vector::Ones(8);
  const NnlsSolution solution = solve(A, b, std::vector<Index>{3, 1});
  expect_optimal(A, b, solution, "zero column");
  EXPECT_EQ(solution.w[3], 0);
  EXPECT_EQ(solve(Matrix::Zero(5, 3), Vector::Ones(5)).w, Vector::Zero(3));
}

TEST(Fnnls, ReturnsZeroWhereNothingPointsTowardB) {
  const Matrix A = uniform(20, 8, 1);
  EXPECT_EQ(solve(A, Vector::Zero(20)).w, Vector::Zero(8));
  EXPECT_EQ(solve(A, Vector::Zero(20)).report.status, Status::Converged);
  EXPECT_EQ(solve(A, -Vector::Ones(20)).w, Vector::Zero(8));
  EXPECT_EQ(solve(Matrix(20, 0), Vector::Ones(20)).w.size(), 0);
}

TEST(Fnnls, DoesNotCareAboutTheScaleOfColumns) {
  const Matrix A = gaussian(50, 20, 4);
  const Vector b = gaussian(50, 1, 5);
  const Vector scale = Vector::NullaryExpr(20, [](Index j) { return std::pow(10.0, j % 3 * 8 - 8); });
  const Vector w = solve(A, b).w, w_scaled = solve(A * scale.asDiagonal(), b).w;
  EXPECT_TRUE(w_scaled.cwiseProduct(scale).isApprox(w, 1e-11));
}

TEST(Fnnls, FindsTheSameFromAnyStart) {
  const Matrix A = uniform(60, 30, 6);
  const Vector b = gaussian(60, 1, 7) + Vector::Ones(60);
  const Vector w = solve(A, b).w;
  for (std::uint64_t seed = 1; seed <= 20; ++seed)
    EXPECT_TRUE(solve(A, b, test::random_subset(30, static_cast<Index>(seed), seed)).w.isApprox(w, 1e-10));
}

TEST(Fnnls, AnswersWithinItsLimitOfIterations) {
  const Matrix A = gaussian(60, 40, 6);
  const Vector b = gaussian(60, 1, 7);
  const NnlsSolution solution = Fnnls{.max_iterations = 1}(A.transpose() * A, A.transpose() * b);
  EXPECT_EQ(solution.report.status, Status::MaxIterations);
  EXPECT_TRUE((solution.w.array() >= 0).all());
  EXPECT_LT((b - A * solution.w).norm(), b.norm());
  EXPECT_GT(solution.report.residual, 1e-6);
}

TEST(Fnnls, SaysSoWhereNumbersAreNotFinite) {
  const Matrix G = Matrix::Identity(3, 3);
  const Vector c = Vector::Constant(3, std::nan(""));
  EXPECT_EQ(Fnnls{}(G, c).report.status, Status::NotFinite);
  EXPECT_EQ(Fnnls{}(Matrix::Constant(3, 3, std::nan("")), Vector::Ones(3)).report.status, Status::NotFinite);
}

TEST(Fnnls, RefusesWhatDoesNotFit) {
  EXPECT_THROW(Fnnls{}(Matrix::Identity(3, 2), Vector::Ones(2)), std::invalid_argument);
  EXPECT_THROW(Fnnls{}(Matrix::Identity(3, 3), Vector::Ones(2)), std::invalid_argument);
  EXPECT_THROW(Fnnls{}(Matrix::Identity(3, 3), Vector::Ones(3), std::vector<Index>{3}), std::invalid_argument);
}

}  // namespace
}  // namespace supple
