#include <core/parallel.hpp>
#include <sparse/updatable_cholesky.hpp>
#include <tests/sparse/problems.hpp>

#include <Eigen/Cholesky>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple {
namespace {

using testing::gaussian;

const std::vector<Index> some{7, 2, 300, 11};
const std::vector<Index> more{0, 150};

DenseProblem problem() {
  return {gaussian(60, 320, 1), gaussian(60, 1, 2)};
}

template <ColumnBlock C>
void expect_columns(const C& block, const Matrix& A, const std::vector<Index>& indices) {
  const Matrix A_C = A(Eigen::all, indices);
  const Vector w = gaussian(A_C.cols(), 1, 3), r = gaussian(A.rows(), 1, 4);
  ASSERT_EQ(block.size(), A_C.cols());
  for (Index k = 0; k < block.size(); ++k) EXPECT_EQ(block.index(k), indices[k]);
  EXPECT_TRUE(block.times(w).isApprox(A_C * w, 1e-13));
  EXPECT_TRUE(block.transpose_times(r).isApprox(A_C.transpose() * r, 1e-13));
  EXPECT_TRUE(block.gram(block).isApprox(A_C.transpose() * A_C, 1e-13));
  EXPECT_TRUE(block.squared_norms().isApprox(A_C.colwise().squaredNorm().transpose(), 1e-13));
}

TEST(ColumnsOf, AreTheColumnsOfTheMatrix) {
  const DenseProblem dense = problem();
  expect_columns(columns_of(dense, some), dense.matrix(), some);
  expect_columns(columns_of(testing::ColumnsOnly(dense.matrix(), dense.rhs()), some), dense.matrix(), some);
}

TEST(DenseColumns, GrowAndShrinkLikeTheirIndexSets) {
  const DenseProblem dense = problem();
  DenseColumns block = columns_of(dense, some);
  block.append(columns_of(dense, more));
  expect_columns(block, dense.matrix(), {7, 2, 300, 11, 0, 150});
  const std::vector<Index> positions{5, 0, 2};
  expect_columns(block.subset(positions), dense.matrix(), {150, 7, 300});
  DenseColumns empty = columns_of(dense, std::vector<Index>{});
  EXPECT_EQ(empty.size(), 0);
  EXPECT_EQ(empty.times(Vector(0)), Vector::Zero(60));
  empty.append(block);
  expect_columns(empty, dense.matrix(), {7, 2, 300, 11, 0, 150});
}

TEST(DenseColumns, GramOfTwoBlocksIsTheirProduct) {
  const DenseProblem dense = problem();
  const Matrix expected = dense.matrix()(Eigen::all, some).transpose() * dense.matrix()(Eigen::all, more);
  EXPECT_TRUE(columns_of(dense, some).gram(columns_of(dense, more)).isApprox(expected, 1e-13));
}

TEST(DenseColumns, GiveTheSameBitsWhateverTheNumberOfThreads) {
  const DenseProblem dense = problem();
  std::vector<Index> all(dense.cols());
  for (Index j = 0; j < dense.cols(); ++j) all[j] = j;
  const DenseColumns block = columns_of(dense, all);
  set_num_threads(1);
  const Matrix G = block.gram(block);
  const Vector g = block.transpose_times(dense.rhs());
  set_num_threads(4);
  EXPECT_EQ(block.gram(block), G);
  EXPECT_EQ(block.transpose_times(dense.rhs()), g);
  set_num_threads(0);
}

TEST(DenseProblem, RestrictsToGroupsOfRows) {
  const Matrix A = gaussian(6, 3, 1);
  const DenseProblem part = DenseProblem(A, A.col(0), 2).restricted_to(std::vector<Index>{2, 0});
  EXPECT_EQ(part.matrix().topRows(2), A.middleRows(4, 2));
  EXPECT_EQ(part.matrix().bottomRows(2), A.topRows(2));
  EXPECT_EQ(part.rhs(), part.matrix().col(0));
}

TEST(DenseProblem, RefusesWhatDoesNotFit) {
  EXPECT_THROW(DenseProblem(Matrix::Zero(4, 2), Vector::Zero(3)), std::invalid_argument);
  EXPECT_THROW(DenseProblem(Matrix::Zero(4, 2), Vector::Zero(4), 3), std::invalid_argument);
}

TEST(UpdatableCholesky, FollowsItsMatrix) {
  Matrix A = gaussian(30, 12, 5);
  A.colwise().normalize();
  const Matrix G = A.transpose() * A;
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
}

TEST(UpdatableCholesky, RefusesADependentColumn) {
  Matrix A = gaussian(30, 5, 7);
  A.col(4) = A.leftCols(4).rowwise().sum();
  A.colwise().normalize();
  const Matrix G = A.transpose() * A;
  UpdatableCholesky factor(5);
  for (Index j = 0; j < 4; ++j) ASSERT_TRUE(factor.append(G.col(j).head(j)));
  EXPECT_FALSE(factor.append(G.col(4).head(4)));
  EXPECT_EQ(factor.size(), 4);
}

}  // namespace
}  // namespace supple
