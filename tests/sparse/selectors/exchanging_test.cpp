#include <sparse/nnls/nnls.hpp>
#include <sparse/selection/weighted_sample.hpp>
#include <sparse/selectors/exchanging.hpp>
#include <tests/sparse/problems.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

struct NormalEquations {
  Matrix A, G;
  Vector b, c;

  NormalEquations(Index rows, Index cols, std::uint64_t seed)
      : A(uniform(rows, cols, seed)),
        G(A.transpose() * A),
        b(A * Vector::Ones(cols) + gaussian(rows, 1, seed + 1)),
        c(A.transpose() * b) {}

  /// Weights on these columns, 0 elsewhere.
  Vector fit(const std::vector<Index>& positions) const {
    Vector w = Vector::Zero(c.size());
    w(positions) = Fnnls{}(G(positions, positions), c(positions)).w;
    return w;
  }
  double error(const std::vector<Index>& positions) const { return (b - A * fit(positions)).norm(); }
};

TEST(Exchange, EndsWhereNoPairThatKeepsAllWeightsPositiveLowersTheError) {
  for (std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const NormalEquations problem(40, 20, seed);
    const Vector w = problem.fit(random_subset(20, 6, seed));
    const std::vector<Index> start = positive(w), end = exchange(problem.G, problem.c, w, std::vector<char>(20, 0));
    EXPECT_EQ(end.size(), start.size());
    EXPECT_LE(problem.error(end), problem.error(start) * (1 + 1e-12));
    EXPECT_THAT(problem.fit(end)(end), ::testing::Each(::testing::Gt(0)));
    for (std::size_t out = 0; out < end.size(); ++out)
      for (Index in = 0; in < 20; ++in) {
        if (std::find(end.begin(), end.end(), in) != end.end()) continue;
        std::vector<Index> other = end;
        other[out] = in;
        if (positive(problem.fit(other)).size() == end.size()) {
          EXPECT_GE(problem.error(other), problem.error(end) * (1 - 1e-9));
        }
      }
  }
}

TEST(Exchange, LeavesFixedColumnsWhereTheyAre) {
  const NormalEquations problem(40, 20, 7);
  const Vector w = problem.fit({0, 1, 2, 3, 4, 5});
  std::vector<char> fixed(20, 0);
  for (Index k : {0, 1, 2, 18, 19}) fixed[k] = 1;
  const std::vector<Index> end = exchange(problem.G, problem.c, w, fixed);
  EXPECT_THAT(end, ::testing::IsSupersetOf({0, 1, 2, 18, 19}));
  EXPECT_EQ(end.size(), positive(w).size() + 2);
}

TEST(Exchange, ReturnsASupportThatDependsOnItself) {
  Matrix A = gaussian(10, 6, 1).cwiseAbs();
  A.col(1) = A.col(0);
  const Vector b = A.rowwise().sum(), w{{1, 1, 1, 0, 0, 0}};
  EXPECT_THAT(exchange(A.transpose() * A, A.transpose() * b, w, std::vector<char>(6, 0)),
              ::testing::ElementsAre(0, 1, 2));
}

TEST(WeightedSample, DrawsInProportionToTheWeights) {
  const std::vector<Index> items{0, 1, 2};
  const Vector weight{{1, 2, 5}};
  Random random(1);
  Vector first = Vector::Zero(3);
  const int trials = 4000;
  for (int trial = 0; trial < trials; ++trial) first[weighted_sample(items, weight, 1, random).front()] += 1;
  for (Index k = 0; k < 3; ++k) {
    const double p = weight[k] / 8;
    EXPECT_NEAR(first[k] / trials, p, 4 * std::sqrt(p * (1 - p) / trials));
  }
  EXPECT_THAT(weighted_sample(items, weight, 7, random), ::testing::UnorderedElementsAre(0, 1, 2));
}

}  // namespace
}  // namespace supple::test
