#include <sparse/problem/any_problem.hpp>
#include <sparse/problem/stacked_problem.hpp>
#include <sparse/selectors/nn_sp.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/sparse/problems.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

struct StackedProblemTest : testing::Test {
  static constexpr Index cols = 30;

  const DenseProblem above{random_matrix(24, cols, 1, 1), random_vector(24, 1, 2), 4};
  const DenseProblem below{random_matrix(10, cols, 1, 3), random_vector(10, 1, 4), 5};
  const StackedProblem<DenseProblem, DenseProblem> stacked{above, below};
  const Matrix A = (Matrix(34, cols) << above.matrix(), below.matrix()).finished();
  const Vector b = (Vector(34) << above.rhs(), below.rhs()).finished();
};

TEST_F(StackedProblemTest, IsTheProblemOfAllRows) {
  ASSERT_EQ(stacked.rows(), 34);
  ASSERT_EQ(stacked.cols(), cols);
  EXPECT_TRUE(is_same(stacked.rhs(), b));
  Vector column(34);
  stacked.column(7, column);
  EXPECT_TRUE(is_same(column, A.col(7)));
  const Vector r = random_vector(34, 1, 5);
  EXPECT_TRUE(is_near(stacked.transpose_times(r), A.transpose() * r, 1e-13));
  EXPECT_TRUE(is_near(stacked.squared_norms(), A.colwise().squaredNorm().transpose(), 1e-12));
  Vector wrong(33);
  EXPECT_THROW(stacked.column(0, wrong), std::invalid_argument);
  const DenseProblem other(random_matrix(8, cols + 1, 1, 6), random_vector(8, 1, 7), 4);
  EXPECT_THROW((StackedProblem<DenseProblem, DenseProblem>(above, other)), std::invalid_argument);
}

TEST_F(StackedProblemTest, ItsBlocksAreThoseOfTheMatrix) {
  const std::vector<Index> some{4, 17, 2, 29}, more{8, 3}, at{2, 0};
  auto block = stacked.columns(some);
  const auto other = stacked.columns(more);
  EXPECT_TRUE(is_near(block.gram(other), A(Eigen::all, some).transpose() * A(Eigen::all, more), 1e-12));
  block.append(other);
  std::vector<Index> all = some;
  all.insert(all.end(), more.begin(), more.end());
  const Matrix A_C = A(Eigen::all, all);
  ASSERT_EQ(block.size(), 6);
  for (Index k = 0; k < 6; ++k) EXPECT_EQ(block.index(k), all[k]);
  const Vector w = random_vector(6, 1, 8), r = random_vector(34, 1, 9);
  EXPECT_TRUE(is_near(block.times(w), A_C * w, 1e-13));
  EXPECT_TRUE(is_near(block.transpose_times(r), A_C.transpose() * r, 1e-13));
  EXPECT_TRUE(is_near(block.squared_norms(), A_C.colwise().squaredNorm().transpose(), 1e-12));
  const Matrix G = block.gram(block);
  EXPECT_TRUE(is_near(G, A_C.transpose() * A_C, 1e-12));
  EXPECT_TRUE(is_same(G, G.transpose()));
  const auto subset = block.subset(at);
  EXPECT_EQ(subset.index(0), 2);
  EXPECT_EQ(subset.index(1), 4);
}

TEST_F(StackedProblemTest, GroupsAreThoseOfBothAndNeitherIsEverEmpty) {
  ASSERT_EQ(stacked.num_groups(), 6 + 2);
  const auto rows = [&](std::vector<Index> groups, const std::vector<Index>& expected) {
    const auto restricted = stacked.restricted_to(groups);
    EXPECT_TRUE(is_same(restricted.rhs(), Vector(b(expected))));
    EXPECT_TRUE(
        is_near(restricted.squared_norms(), A(expected, Eigen::all).colwise().squaredNorm().transpose(), 1e-12));
  };
  rows({1, 7}, {4, 5, 6, 7, 29, 30, 31, 32, 33});
  rows({1}, {4, 5, 6, 7, 24, 25, 26, 27, 28});
  rows({6}, {0, 1, 2, 3, 24, 25, 26, 27, 28});
}

TEST_F(StackedProblemTest, OnePartMayHaveNoRows) {
  const DenseProblem nothing(Matrix(0, cols), Vector(0));
  const Selection alone = NnSp{.seed = 3}(above, 8), both = NnSp{.seed = 3}(StackedProblem(above, nothing), 8);
  EXPECT_EQ(both.indices, alone.indices);
  EXPECT_TRUE(is_near(both.weights, alone.weights, 1e-12));
}

TEST_F(StackedProblemTest, CountsTheNumbersOfBothParts) {
  const ColumnsOnly below_by_columns(A.bottomRows(10), b.tail(10));
  EXPECT_EQ(numbers_per_column(StackedProblem(above, below_by_columns)), 10);  // those of `above` are in memory
  EXPECT_EQ(numbers_per_column(AnyProblem(stacked)), numbers_per_column(stacked));
}

TEST_F(StackedProblemTest, IsSolvedAsTheMatrixIs) {
  const Selection c = NnSp{.seed = 3}(AnyProblem(stacked), 8);
  ASSERT_LE(c.size(), 8);
  EXPECT_NEAR(c.report.residual, (A(Eigen::all, c.indices) * c.weights - b).norm(), 1e-10 * b.norm());
}

}  // namespace
}  // namespace supple::test
