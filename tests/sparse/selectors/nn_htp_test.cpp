#include <core/parallel.hpp>
#include <sparse/selectors/nn_htp.hpp>
#include <tests/sparse/problems.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace supple {
namespace {

using test::gaussian;
using test::random_subset;

// 12 of 200 columns, weights in [1, 2], no noise.
struct Planted {
  std::vector<Index> support = random_subset(200, 12, 1);
  Matrix A = gaussian(100, 200, 2);
  Vector w = test::planted_weights(200, support, 3);
  DenseProblem problem{A, A* w};
};

DenseProblem noisy(std::uint64_t seed = 1) {
  const Matrix A = test::uniform(60, 150, seed);
  return {A, A * Vector::Ones(150)};
}

TEST(LargestPositive, KeepsTheLargestAndBreaksTiesByPosition) {
  const Vector x{{3, -5, 0, 7, 3, 3, 1}};
  EXPECT_THAT(largest_positive(x, 3), ::testing::ElementsAre(0, 3, 4));
  EXPECT_THAT(largest_positive(x, 100), ::testing::ElementsAre(0, 3, 4, 5, 6));
  EXPECT_THAT(largest_positive(x, 0), ::testing::IsEmpty());
  EXPECT_THAT(largest_magnitude(x, 2), ::testing::ElementsAre(1, 3));
}

TEST(NnHtp, RecoversAPlantedSolution) {
  const Planted planted;
  for (StepLength step : {StepLength::Paper, StepLength::Exact}) {
    const Selection c = NnHtp{.candidates_per_size = 20, .step = step}(planted.problem, 12);
    EXPECT_EQ(c.indices, planted.support);
    EXPECT_TRUE(c.weights.isApprox(planted.w(planted.support), 1e-12));
    EXPECT_LE(c.report.training_error, 1e-14);
    EXPECT_EQ(c.report.status, Status::Converged);
  }
}

TEST(NnHtp, RecoversItFromLazyDrawsToo) {
  const Planted planted;
  const Selection c = NnHtp{.max_iterations = 200, .patience = 50}(planted.problem, 12);
  EXPECT_EQ(c.indices, planted.support);
}

TEST(NnHtp, ReportsTheErrorThatADirectEvaluationGives) {
  const DenseProblem problem = noisy();
  const Selection c = NnHtp{}(problem, 10);
  const Vector r = problem.matrix()(Eigen::all, c.indices) * c.weights - problem.rhs();
  EXPECT_NEAR(c.report.residual, r.norm(), 1e-12 * problem.rhs().norm());
  EXPECT_NEAR(c.report.training_error, r.norm() / problem.rhs().norm(), 1e-12);
  EXPECT_LE(c.report.kkt_residual, 1e-12);
}

TEST(NnHtp, ReturnsTheBestIterateOfItsHistory) {
  const DenseProblem problem = noisy();
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Selection c = NnHtp{.seed = seed}(problem, 10);
    for (const SelectionStep& step : c.report.history) EXPECT_GE(step.training_error, c.report.training_error - 1e-13);
    EXPECT_EQ(c.report.iterations + 1 >= static_cast<Index>(c.report.history.size()), true);
  }
}

TEST(NnHtp, GivesTheSameBitsWhateverTheNumberOfThreads) {
  const DenseProblem problem(gaussian(300, 900, 5), gaussian(300, 1, 6));
  set_num_threads(1);
  const Selection one = NnHtp{.seed = 7}(problem, 60);
  set_num_threads(3);
  const Selection three = NnHtp{.seed = 7}(problem, 60);
  set_num_threads(0);
  EXPECT_EQ(one.indices, three.indices);
  EXPECT_EQ(one.weights, three.weights);
  EXPECT_EQ(one.report.residual, three.report.residual);
}

TEST(NnHtp, NeedsNoMoreThanColumnsOnDemand) {
  const DenseProblem dense = noisy();
  const Selection a = NnHtp{.seed = 1}(dense, 10);
  const Selection b = NnHtp{.seed = 1}(test::ColumnsOnly(dense.matrix(), dense.rhs()), 10);
  EXPECT_EQ(a.indices, b.indices);
  EXPECT_TRUE(a.weights.isApprox(b.weights, 1e-10));
}

TEST(NnHtp, DependsOnItsSeed) {
  const DenseProblem problem = noisy();
  EXPECT_NE((NnHtp{.max_iterations = 1, .seed = 1}(problem, 5).indices),
            (NnHtp{.max_iterations = 1, .seed = 2}(problem, 5).indices));
}

TEST(NnHtp, StopsAtTheTargetError) {
  const Planted planted;
  SelectionRequest request(40);
  request.target_error = 0.5;
  const Selection c = NnHtp{}(planted.problem, request);
  EXPECT_LE(c.report.training_error, 0.5);
  EXPECT_EQ(c.report.status, Status::Converged);
  EXPECT_LT(c.report.iterations, 5);
}

TEST(NnHtp, ChoosesAmongTheCandidatesAndKeepsWhatItMust) {
  const DenseProblem problem = noisy();
  SelectionRequest request(6);
  for (Index j = 0; j < 150; j += 2) request.candidates.push_back(j);
  request.must_keep = {31, 10};
  const Selection c = NnHtp{}(problem, request);
  EXPECT_THAT(c.indices, ::testing::IsSupersetOf({10, 31}));
  EXPECT_THAT(c.indices, ::testing::Each(::testing::AnyOf(31, ::testing::Truly([](Index j) { return j % 2 == 0; }))));
}

TEST(NnHtp, NeverLosesAgainstItsWarmStart) {
  const DenseProblem problem = noisy();
  SelectionRequest request(10);
  request.warm_start = NnHtp{.max_iterations = 40, .seed = 3}(problem, 10);
  EXPECT_LE((NnHtp{.max_iterations = 2, .seed = 4}(problem, request).report.residual),
            request.warm_start.report.residual * (1 + 1e-12));
}

TEST(NnHtp, CallsForHeldOutErrors) {
  SelectionRequest request(5);
  request.validate = [](const std::vector<Index>& indices, VectorIn weights) {
    EXPECT_EQ(static_cast<Index>(indices.size()), weights.size());
    return 0.25;
  };
  const Selection c = NnHtp{}(noisy(), request);
  for (const SelectionStep& step : c.report.history) EXPECT_EQ(step.held_out_error, 0.25);
}

TEST(NnHtp, RefusesRequestsThatMakeNoSense) {
  const DenseProblem problem = noisy();
  EXPECT_THROW(NnHtp{}(problem, 0), std::invalid_argument);
  EXPECT_THROW(NnHtp{}(problem, 151), std::invalid_argument);
  EXPECT_THROW(NnHtp{}(problem, SelectionRequest::to_error(0)), std::invalid_argument);
  SelectionRequest request(1);
  request.must_keep = {3, 4};
  EXPECT_THROW(NnHtp{}(problem, request), std::invalid_argument);
  request.must_keep = {150};
  EXPECT_THROW(NnHtp{}(problem, request), std::invalid_argument);
  request.must_keep = {};
  request.candidates = {-1};
  EXPECT_THROW(NnHtp{}(problem, request), std::invalid_argument);
}

TEST(NnHtp, RefusesNumbersThatAreNotFinite) {
  Matrix A = gaussian(20, 10, 1);
  Vector b = gaussian(20, 1, 2);
  b[7] = std::nan("");
  EXPECT_THROW(NnHtp{}(DenseProblem(A, b), 3), InputError);
  b[7] = 0;
  A(4, 5) = std::nan("");
  EXPECT_THROW(NnHtp{}(DenseProblem(A, b), 3), InputError);
}

}  // namespace
}  // namespace supple
