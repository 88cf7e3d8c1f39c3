#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/random.hpp>
#include <numerics/linear/cholmod_solver.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <numeric>
#include <thread>
#include <vector>

namespace supple {
namespace {

Matrix random_matrix(Index rows, Index cols, std::uint64_t seed) {
  Random random(seed);
  return Matrix::NullaryExpr(rows, cols, [&](Index, Index) { return random.normal(); });
}

/// Symmetric positive definite by diagonal dominance: node i meets a few random others in full b × b blocks.
SparseMatrix random_spd(Index nodes, Index b, Index neighbours, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Triplet<double>> entries;
  Vector row_sums = Vector::Zero(nodes * b);
  for (Index i = 0; i < nodes; ++i)
    for (Index k = 0; k < neighbours; ++k) {
      const Index j = random.below(nodes);
      if (i == j) continue;
      for (Index r = 0; r < b; ++r)
        for (Index c = 0; c < b; ++c) {
          const double value = random.normal();
          entries.emplace_back(i * b + r, j * b + c, value);
          entries.emplace_back(j * b + c, i * b + r, value);
          row_sums[i * b + r] += std::abs(value);
          row_sums[j * b + c] += std::abs(value);
        }
    }
  for (Index i = 0; i < nodes * b; ++i)
    for (Index c = i / b * b; c < (i / b + 1) * b; ++c) entries.emplace_back(i, c, i == c ? row_sums[i] + 1 : 0);
  SparseMatrix A(nodes * b, nodes * b);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Seven-point Laplacian of an n × n × n grid with fixed boundary, times the b × b matrix I + 1 1ᵀ.
SparseMatrix grid_laplacian(Index n, Index b) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto couple = [&](Index i, Index j, double value) {
    for (Index r = 0; r < b; ++r)
      for (Index c = 0; c < b; ++c) entries.emplace_back(i * b + r, j * b + c, value * (r == c ? 2 : 1));
  };
  for (Index z = 0; z < n; ++z)
    for (Index y = 0; y < n; ++y)
      for (Index x = 0; x < n; ++x) {
        const Index i = x + n * (y + n * z);
        couple(i, i, 6);
        if (x > 0) couple(i, i - 1, -1), couple(i - 1, i, -1);
        if (y > 0) couple(i, i - n, -1), couple(i - n, i, -1);
        if (z > 0) couple(i, i - n * n, -1), couple(i - n * n, i, -1);
      }
  SparseMatrix A(n * n * n * b, n * n * n * b);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Dense diagonal blocks that are coupled to the last one only, densely: few supernodes, each large.
SparseMatrix arrow_of_dense_blocks(const std::vector<Index>& sizes, std::uint64_t seed) {
  Random random(seed);
  const Index n = std::accumulate(sizes.begin(), sizes.end(), Index{0}), last = n - sizes.back();
  std::vector<Eigen::Triplet<double>> entries;
  for (Index k = 0, begin = 0; k < static_cast<Index>(sizes.size()); begin += sizes[k++])
    for (Index j = begin; j < begin + sizes[k]; ++j) {
      entries.emplace_back(j, j, static_cast<double>(n));
      for (Index i = j + 1; i < n; ++i)
        if (i < begin + sizes[k] || i >= last) {
          const double value = random.uniform() - 0.5;
          entries.emplace_back(i, j, value);
          entries.emplace_back(j, i, value);
        }
    }
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

bool same_bits(const Matrix& a, const Matrix& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(double) * static_cast<std::size_t>(a.size())) == 0;
}

struct WithThreads {
  explicit WithThreads(int threads) { set_num_threads(threads); }
  ~WithThreads() { set_num_threads(0); }
};

TEST(CholmodSolver, AgreesWithADenseFactorisation) {
  for (const Index b : {1, 2, 3}) {
    const SparseMatrix A = random_spd(60, b, 3, 7 + static_cast<std::uint64_t>(b));
    const Matrix B = random_matrix(A.rows(), 21, 5);
    CholmodSolver cholesky;
    cholesky.analyze(A, b);
    ASSERT_TRUE(cholesky.factorize(A));
    const Matrix expected = Matrix(A).llt().solve(B);
    Matrix X(B.rows(), B.cols());
    cholesky.solve(B, X);
    // Diagonally dominant, so the condition is modest: only rounding separates the two.
    EXPECT_LE((X - expected).norm(), 1e-12 * expected.norm()) << "b = " << b;
    EXPECT_LE((cholesky.solve(B.col(3)) - expected.col(3)).norm(), 1e-12 * expected.col(3).norm());
  }
}

TEST(CholmodSolver, ReadsTheLowerTriangleOnly) {
  const SparseMatrix A = random_spd(40, 1, 3, 3);
  SparseMatrix lopsided = A;
  for (Index j = 0; j < A.cols(); ++j)
    for (SparseMatrix::InnerIterator entry(lopsided, j); entry; ++entry)
      if (entry.row() < j) entry.valueRef() = 1e3;
  CholmodSolver cholesky;
  cholesky.analyze(lopsided);
  ASSERT_TRUE(cholesky.factorize(lopsided));
  const Vector b = random_matrix(40, 1, 4);
  EXPECT_LE((A * cholesky.solve(b) - b).norm(), 1e-12 * b.norm());
}

TEST(CholmodSolver, FactorsLargeDenseFronts) {
  const std::vector<std::vector<Index>> cases{{1100}, {500, 450, 700}, {900, 40, 30, 200}};
  for (const std::vector<Index>& sizes : cases) {
    const SparseMatrix A = arrow_of_dense_blocks(sizes, 1);
    const Matrix B = random_matrix(A.rows(), 9, 5);
    CholmodSolver cholesky;
    cholesky.analyze(A);
    ASSERT_TRUE(cholesky.factorize(A));
    const Matrix expected = Matrix(A).llt().solve(B);
    for (const Index cols : {1, 2, 4, 5, 8, 9}) {
      Matrix X(A.rows(), cols);
      cholesky.solve(B.leftCols(cols), X);
      EXPECT_LE((X - expected.leftCols(cols)).norm(), 1e-13 * expected.norm()) << cols << " columns";  // condition: 3
    }
  }
}

TEST(CholmodSolver, HandlesTrivialAndDisconnectedMatrices) {
  SparseMatrix one(1, 1);
  one.insert(0, 0) = 4;
  SparseMatrix diagonal(7, 7);
  for (Index i = 0; i < 7; ++i) diagonal.insert(i, i) = static_cast<double>(i + 1);
  const SparseMatrix islands = arrow_of_dense_blocks({5, 1, 9, 30, 1}, 2).topLeftCorner(45, 45);
  for (SparseMatrix A : {one, diagonal, islands}) {
    A.makeCompressed();
    CholmodSolver cholesky;
    cholesky.analyze(A);
    ASSERT_TRUE(cholesky.factorize(A));
    const Matrix B = random_matrix(A.rows(), 6, 5);
    Matrix X(A.rows(), 6);
    cholesky.solve(B, X);
    EXPECT_LE((A * X - B).norm(), 1e-14 * B.norm() * static_cast<double>(A.rows()));
    EXPECT_FALSE(cholesky.factorize(-A));
  }
}

TEST(CholmodSolver, SolvesAGridWithAndWithoutBlocks) {
  const SparseMatrix A = grid_laplacian(12, 3);
  const Vector x = random_matrix(A.rows(), 1, 1);
  const Vector b = A * x;
  for (const Index block_size : {0, 1, 3}) {
    CholmodSolver cholesky;
    cholesky.analyze(A, block_size);
    ASSERT_TRUE(cholesky.factorize(A));
    EXPECT_LE((cholesky.solve(b) - x).norm(), 1e-12 * x.norm());  // condition of A: about 300
    EXPECT_GT(cholesky.factor_nonzeros(), A.nonZeros() / 2);
    EXPECT_GT(cholesky.factor_flops(), 1e6);
  }
}

TEST(CholmodSolver, TellsAnIndefiniteOrSingularOrInfiniteMatrix) {
  const SparseMatrix A = grid_laplacian(6, 3);
  CholmodSolver cholesky;
  cholesky.analyze(A, 3);
  SparseMatrix wrong = A;
  wrong.coeffRef(300, 300) = -1;
  EXPECT_FALSE(cholesky.factorize(wrong));
  EXPECT_THROW(static_cast<void>(cholesky.solve(Vector::Ones(A.rows()))), std::invalid_argument);
  wrong.coeffRef(300, 300) = 0;
  EXPECT_FALSE(cholesky.factorize(wrong));
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    wrong.coeffRef(300, 300) = value;
    EXPECT_FALSE(cholesky.factorize(wrong));
  }
  EXPECT_FALSE(cholesky.factorize(-A));
  ASSERT_TRUE(cholesky.factorize(A));  // and recovers
  const Vector b = Vector::Ones(A.rows());
  EXPECT_LE((A * cholesky.solve(b) - b).norm(), 1e-12 * b.norm());
}

TEST(CholmodSolver, FactorsNewValuesOfTheSamePattern) {
  SparseMatrix A = grid_laplacian(7, 2);
  CholmodSolver cholesky;
  cholesky.analyze(A, 2);
  const Vector b = random_matrix(A.rows(), 1, 8);
  for (const double shift : {0.0, 3.0, 1e6}) {
    for (Index i = 0; i < A.rows(); ++i) A.coeffRef(i, i) += shift;
    ASSERT_TRUE(cholesky.factorize(A));
    EXPECT_LE((A * cholesky.solve(b) - b).norm(), 1e-12 * b.norm());
  }
}

class CholmodSolverBits : public testing::TestWithParam<SparseMatrix (*)()> {};  // a matrix itself would be printed

TEST_P(CholmodSolverBits, AreTheSameForAnyNumberOfThreads) {
  const SparseMatrix A = GetParam()();
  const Matrix B = random_matrix(A.rows(), 37, 2);
  Matrix reference(B.rows(), B.cols());
  Vector reference_single;
  for (const int threads : {1, 2, 5}) {
    const WithThreads guard(threads);
    CholmodSolver cholesky;
    cholesky.analyze(A);
    ASSERT_TRUE(cholesky.factorize(A));
    Matrix X(B.rows(), B.cols());
    cholesky.solve(B, X);
    const Vector x = cholesky.solve(B.col(0));
    if (threads == 1) reference = X, reference_single = x;
    EXPECT_TRUE(same_bits(X, reference)) << threads << " threads";
    EXPECT_TRUE(same_bits(x, reference_single)) << threads << " threads";
  }
}

INSTANTIATE_TEST_SUITE_P(CholmodSolver, CholmodSolverBits,
                         testing::Values([] { return grid_laplacian(14, 3); },
                                         [] {
                                           return arrow_of_dense_blocks({700, 800, 600}, 4);
                                         }));

TEST(CholmodSolver, SolvesFromSeveralThreadsAtOnce) {
  const SparseMatrix A = grid_laplacian(10, 3);
  const Matrix B = random_matrix(A.rows(), 12, 2);
  CholmodSolver cholesky;
  cholesky.analyze(A, 3);
  ASSERT_TRUE(cholesky.factorize(A));
  Matrix expected(B.rows(), B.cols());
  cholesky.solve(B, expected);
  std::vector<Matrix> results(4, Matrix(B.rows(), B.cols()));
  {
    std::vector<std::jthread> callers;
    for (Matrix& X : results)
      callers.emplace_back([&] {
        for (int repeat = 0; repeat < 5; ++repeat) cholesky.solve(B, X);
      });
  }
  for (const Matrix& X : results) EXPECT_TRUE(same_bits(X, expected));
}

TEST(CholmodSolver, SolvesInPlaceAndIntoPartsOfAMatrix) {
  const SparseMatrix A = grid_laplacian(6, 1);
  const Matrix B = random_matrix(A.rows(), 19, 2);
  CholmodSolver cholesky;
  cholesky.analyze(A);
  ASSERT_TRUE(cholesky.factorize(A));
  Matrix expected(B.rows(), B.cols());
  cholesky.solve(B, expected);
  Matrix tall = Matrix::Zero(A.rows() + 5, 21);
  tall.block(3, 1, B.rows(), B.cols()) = B;
  cholesky.solve(tall.block(3, 1, B.rows(), B.cols()), tall.block(3, 1, B.rows(), B.cols()));
  EXPECT_TRUE(same_bits(tall.block(3, 1, B.rows(), B.cols()), expected));
  EXPECT_EQ(tall.topRows(3).norm() + tall.bottomRows(2).norm() + tall.col(0).norm() + tall.col(20).norm(), 0);
  Matrix nothing(A.rows(), 0);
  cholesky.solve(nothing, nothing);
}

TEST(CholmodSolver, NamesTheCallersMistake) {
  const SparseMatrix A = grid_laplacian(4, 3);
  CholmodSolver cholesky;
  EXPECT_EQ(cholesky.dim(), 0);
  EXPECT_THROW(static_cast<void>(cholesky.factorize(A)), std::invalid_argument);
  EXPECT_THROW(cholesky.analyze(SparseMatrix(3, 4)), std::invalid_argument);
  EXPECT_THROW(cholesky.analyze(SparseMatrix(0, 0)), std::invalid_argument);
  EXPECT_THROW(cholesky.analyze(A, 5), std::invalid_argument);
  EXPECT_THROW(cholesky.analyze(A, -1), std::invalid_argument);
  cholesky.analyze(A, 3);
  EXPECT_EQ(cholesky.dim(), A.rows());
  EXPECT_THROW(static_cast<void>(cholesky.factorize(grid_laplacian(4, 1))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(cholesky.factorize(random_spd(A.rows() / 3, 3, 3, 1))), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(cholesky.solve(Vector::Ones(A.rows()))), std::invalid_argument);
  ASSERT_TRUE(cholesky.factorize(A));
  EXPECT_THROW(static_cast<void>(cholesky.solve(Vector::Ones(5))), std::invalid_argument);
  CholmodSolver moved = std::move(cholesky);
  EXPECT_EQ(moved.solve(Vector::Ones(A.rows())).size(), A.rows());
}

}  // namespace
}  // namespace supple
