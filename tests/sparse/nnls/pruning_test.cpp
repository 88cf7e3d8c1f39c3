#include <sparse/nnls/nnls.hpp>
#include <sparse/nnls/pruning.hpp>
#include <tests/sparse/problems.hpp>

#include <Eigen/QR>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

/// Many columns in a fit with positive weights.
struct PruneTest : testing::Test {
  Vector least_squares(const std::vector<Index>& positions) const {
    return Matrix(A(Eigen::all, positions)).colPivHouseholderQr().solve(b);
  }
  double squared_error(const std::vector<Index>& positions) const {
    return (b - A(Eigen::all, positions) * least_squares(positions)).squaredNorm();
  }
  /// Backward elimination by a fit for each column that might go.
  std::vector<Index> eliminated(std::vector<Index> left, std::size_t size, const std::vector<char>& fixed = {}) const {
    while (left.size() > size) {
      const Vector x = least_squares(left);
      Index worst = -1;
      double least = 0;
      for (std::size_t k = 0; k < left.size(); ++k) {
        if (!fixed.empty() && fixed[left[k]]) continue;
        std::vector<Index> others = left;
        others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
        const double loss = x[k] > 0 ? squared_error(others) : x[k] * A.col(left[k]).norm();
        if (worst < 0 || loss < least) worst = static_cast<Index>(k), least = loss;
      }
      left.erase(left.begin() + worst);
    }
    return left;
  }

  const Matrix A = uniform(100, 60, 5);
  const Vector b = A * Vector::Constant(60, 2) + gaussian(100, 1, 6);
  const Matrix G = A.transpose() * A;
  const Vector w = Fnnls{}(G, A.transpose() * b).w;
  const std::vector<char> none = std::vector<char>(60, 0);
};

TEST_F(PruneTest, TakesTheColumnThatIsMissedLeastEachTime) {
  ASSERT_GT(positive(w).size(), 50u);
  for (const Index size : {50, 40, 23, 3, 1})
    EXPECT_EQ(prune(G, w, size, none), eliminated(positive(w), static_cast<std::size_t>(size))) << size;
}

TEST_F(PruneTest, LeavesFixedColumnsWithAWeightOrWithout) {
  std::vector<char> fixed = none;
  for (const Index k : {0, 1, 2, 3, 30, 31, 32, 33, 56, 57, 58, 59}) fixed[k] = 1;
  std::vector<Index> without;
  for (Index k = 0; k < w.size(); ++k)
    if (fixed[k] && !(w[k] > 0)) without.push_back(k);
  std::vector<Index> expected = eliminated(positive(w), 20 - without.size(), fixed);
  expected.insert(expected.end(), without.begin(), without.end());
  std::sort(expected.begin(), expected.end());
  EXPECT_EQ(prune(G, w, 20, fixed), expected);
}

TEST_F(PruneTest, TakesOnlyWhatHasNoWeightWhereThereIsRoom) {
  EXPECT_EQ(prune(G, w, 60, none), positive(w));
}

// Two equal columns: one of them is enough, and the Gram matrix is singular to rounding.
TEST_F(PruneTest, EqualColumnsAreNoObstacle) {
  Matrix twice(100, 40);
  twice << A.leftCols(20), A.leftCols(20);
  const Vector half = Fnnls{}(G.topLeftCorner(20, 20), A.leftCols(20).transpose() * b).w / 2;
  Vector weights(40);
  weights << half, half;
  const std::vector<Index> left = prune(twice.transpose() * twice, weights, 20, std::vector<char>(40, 0));
  std::vector<Index> originals;
  for (const Index k : left) originals.push_back(k % 20);
  std::sort(originals.begin(), originals.end());
  EXPECT_EQ(std::unique(originals.begin(), originals.end()), originals.end());
}

}  // namespace
}  // namespace supple::test
