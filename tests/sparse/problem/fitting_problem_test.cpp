#include <core/parallel.hpp>
#include <sparse/nnls/updatable_cholesky.hpp>
#include <tests/sparse/problems.hpp>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <type_traits>

namespace supple {
namespace {

using test::gaussian;

const std::vector<Index> some{7, 2, 300, 11};
const std::vector<Index> more{0, 150};

template <ColumnBlock C>
void expect_columns(const C& block, const Matrix& matrix, const std::vector<Index>& indices) {
  const Matrix A_C = matrix(Eigen::all, indices);
  const Vector w = gaussian(A_C.cols(), 1, 3), r = gaussian(matrix.rows(), 1, 4);
  ASSERT_EQ(block.size(), A_C.cols());
  for (Index k = 0; k < block.size(); ++k) EXPECT_EQ(block.index(k), indices[k]);
  EXPECT_TRUE(block.times(w).isApprox(A_C * w, 1e-13));
  EXPECT_TRUE(block.transpose_times(r).isApprox(A_C.transpose() * r, 1e-13));
  EXPECT_TRUE(block.gram(block).isApprox(A_C.transpose() * A_C, 1e-13));
  EXPECT_TRUE(block.squared_norms().isApprox(A_C.colwise().squaredNorm().transpose(), 1e-13));
}

// Both representations of columns, from the same numbers.
const Matrix stored = gaussian(60, 320, 1);
const DenseProblem stored_problem(stored, gaussian(60, 1, 2));
const test::ColumnsOnly on_demand(stored, stored_problem.rhs());

template <typename P>
struct Block : ::testing::Test {
  static const P& problem() {
    if constexpr (std::is_same_v<P, DenseProblem>)
      return stored_problem;
    else
      return on_demand;
  }
};
using Problems = ::testing::Types<DenseProblem, test::ColumnsOnly>;
TYPED_TEST_SUITE(Block, Problems);

TYPED_TEST(Block, HoldsTheColumnsOfTheMatrix) {
  expect_columns(columns_of(this->problem(), some), stored, some);
}

TYPED_TEST(Block, GrowsAndShrinksLikeItsIndexSet) {
  auto block = columns_of(this->problem(), some);
  block.append(columns_of(this->problem(), more));
  expect_columns(block, stored, {7, 2, 300, 11, 0, 150});
  const std::vector<Index> positions{5, 0, 2};
  expect_columns(block.subset(positions), stored, {150, 7, 300});
  auto empty = columns_of(this->problem(), std::vector<Index>{});
  EXPECT_EQ(empty.size(), 0);
  EXPECT_EQ(empty.times(Vector(0)), Vector::Zero(60));
  empty.append(block);
  expect_columns(empty, stored, {7, 2, 300, 11, 0, 150});
}

TYPED_TEST(Block, MultipliesWithAnother) {
  const Matrix expected = stored(Eigen::all, some).transpose() * stored(Eigen::all, more);
  EXPECT_TRUE(columns_of(this->problem(), some).gram(columns_of(this->problem(), more)).isApprox(expected, 1e-13));
}

TYPED_TEST(Block, GivesTheSameBitsWhateverTheNumberOfThreads) {
  std::vector<Index> all(stored.cols());
  std::iota(all.begin(), all.end(), Index{0});
  const auto block = columns_of(this->problem(), all);
  set_num_threads(1);
  const Matrix G = block.gram(block);
  const Vector g = block.transpose_times(stored_problem.rhs());
  set_num_threads(4);
  EXPECT_EQ(block.gram(block), G);
  EXPECT_EQ(block.transpose_times(stored_problem.rhs()), g);
  set_num_threads(0);
}

TEST(DenseProblem, MultipliesWithAllItsColumns) {
  EXPECT_TRUE(
      stored_problem.transpose_times(stored_problem.rhs()).isApprox(stored.transpose() * stored_problem.rhs(), 1e-13));
  EXPECT_TRUE(stored_problem.squared_norms().isApprox(stored.colwise().squaredNorm().transpose(), 1e-13));
}

TEST(DenseProblem, RestrictsToGroupsOfRows) {
  const DenseProblem whole(stored, stored_problem.rhs(), 20);
  ASSERT_EQ(whole.num_groups(), 3);
  const DenseRows part = whole.restricted_to(std::vector<Index>{2, 0});
  Matrix expected(40, stored.cols());
  expected << stored.bottomRows(20), stored.topRows(20);
  expect_columns(columns_of(part, some), expected, some);
  EXPECT_TRUE(part.transpose_times(part.rhs()).isApprox(expected.transpose() * part.rhs(), 1e-13));
  EXPECT_TRUE(part.squared_norms().isApprox(expected.colwise().squaredNorm().transpose(), 1e-13));
  const DenseRows first = part.restricted_to(std::vector<Index>{1});  // which is group 0 of the whole
  expect_columns(columns_of(first, some), stored.topRows(20), some);
  EXPECT_EQ(first.rhs(), stored_problem.rhs().head(20));
  EXPECT_EQ(part.rhs().head(20), stored_problem.rhs().tail(20));
  EXPECT_EQ(part.rhs().tail(20), stored_problem.rhs().head(20));
}

TEST(DenseProblem, RefusesWhatDoesNotFit) {
  EXPECT_THROW(DenseProblem(Matrix::Zero(4, 2), Vector::Zero(3)), std::invalid_argument);
  EXPECT_THROW(DenseProblem(Matrix::Zero(4, 2), Vector::Zero(4), 3), std::invalid_argument);
}

TEST(UpdatableCholesky, FollowsItsMatrix) {
  Matrix B = gaussian(30, 12, 5);
  B.colwise().normalize();
  const Matrix G = B.transpose() * B;
  UpdatableCholesky factor(12);
  std::vector<Index> present;
  const auto append = [&](Index j) {
    ASSERT_TRUE(factor.append(G(present, j)));
    present.push_back(j);
  };
  const auto check = [&] {
    const Matrix G_P = G(present, present);
    const Vector c = gaussian(G_P.rows(), 1, 6);
    EXPECT_TRUE(factor.solve(c).isApprox(G_P.llt().solve(c), 1e-12));
  };
  for (Index j = 0; j < 12; ++j) append(j);
  check();
  for (Index k : {11, 0, 4, 5}) {
    factor.remove(k);
    present.erase(present.begin() + k);
    check();
  }
  append(0);
  append(5);
  check();
  ASSERT_TRUE(factor.assign(G));
  present = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  check();
}

TEST(UpdatableCholesky, RefusesADependentColumn) {
  Matrix B = gaussian(30, 5, 7);
  B.col(4) = B.leftCols(4).rowwise().sum();
  B.colwise().normalize();
  const Matrix G = B.transpose() * B;
  UpdatableCholesky factor(5);
  for (Index j = 0; j < 4; ++j) ASSERT_TRUE(factor.append(G.col(j).head(j)));
  EXPECT_FALSE(factor.append(G.col(4).head(4)));
  EXPECT_EQ(factor.size(), 4);
  EXPECT_FALSE(factor.assign(G));
  EXPECT_TRUE(factor.assign(G.topLeftCorner(4, 4)));
}

}  // namespace
}  // namespace supple
