#pragma once
/// \file What every SubsetSelector promises. A new selector joins with
/// INSTANTIATE_TYPED_TEST_SUITE_P(Mine, SubsetSelectorConformance, ::testing::Types<MySelector>); and, if its
/// weights may be negative or it cannot be told a size, a specialisation of SelectorTraits.

#include <core/parallel.hpp>
#include <sparse/selectors.hpp>
#include <testing/random_problems.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace supple::test {

template <typename S>
struct SelectorTraits {
  static constexpr Signs signs = Signs::NonNegative;
  static constexpr bool chooses = true;          ///< false: takes all candidates, whatever the size
  static constexpr bool optimal_weights = true;  ///< the weights are a least-squares fit
};
template <>
struct SelectorTraits<Htp> : SelectorTraits<void> {
  static constexpr Signs signs = Signs::Any;
};
template <>
struct SelectorTraits<Niht> : SelectorTraits<void> {
  static constexpr Signs signs = Signs::Any;
  static constexpr bool optimal_weights = false;
};
template <>
struct SelectorTraits<NnNiht> : SelectorTraits<void> {
  static constexpr bool optimal_weights = false;
};
template <>
struct SelectorTraits<AllColumns> : SelectorTraits<void> {
  static constexpr bool chooses = false;
};

template <typename S>
class SubsetSelectorConformance : public ::testing::Test {
 protected:
  using Traits = SelectorTraits<S>;

  static constexpr Index rows = 48, cols = 90;

  // Columns with a positive mean, so that they resemble each other, and b their noisy sum.
  static Matrix matrix() { return uniform(rows, cols, 1) - Matrix::Constant(rows, cols, 0.3); }
  static Vector rhs(const Matrix& A) { return A * Vector::Ones(A.cols()) + gaussian(A.rows(), 1, 2); }
  static DenseProblem problem() { return DenseProblem(matrix(), rhs(matrix()), 4); }

  static SelectionRequest request(Index s) { return Traits::chooses ? s : cols; }

  // All that holds for any answer.
  static void expect_sound(const DenseProblem& problem, const SelectionRequest& asked, const Selection& c) {
    ASSERT_EQ(c.weights.size(), c.size());
    EXPECT_LE(c.size(), asked.size);
    EXPECT_TRUE(std::is_sorted(c.indices.begin(), c.indices.end()));
    EXPECT_EQ(std::adjacent_find(c.indices.begin(), c.indices.end()), c.indices.end());
    const auto contains = [](const std::vector<Index>& set, Index j) {
      return std::find(set.begin(), set.end(), j) != set.end();
    };
    for (Index k = 0; k < c.size(); ++k) {
      const Index j = c.indices[k];
      ASSERT_TRUE(0 <= j && j < problem.cols());
      if (!contains(asked.must_keep, j)) {
        EXPECT_NE(c.weights[k], 0) << "column " << j;
        EXPECT_TRUE(asked.candidates.empty() || contains(asked.candidates, j)) << "column " << j;
      }
      if (Traits::signs == Signs::NonNegative) {
        EXPECT_GE(c.weights[k], 0) << "column " << j;
      }
    }
    EXPECT_THAT(c.indices, ::testing::IsSupersetOf(asked.must_keep));

    const Vector r = problem.rhs() - problem.matrix()(Eigen::all, c.indices) * c.weights;
    const double b = problem.rhs().norm();
    EXPECT_NEAR(c.report.residual, r.norm(), 1e-10 * b);
    EXPECT_NEAR(c.report.training_error, b > 0 ? r.norm() / b : 0, 1e-10);
    EXPECT_LE(c.report.residual, b * (1 + 1e-12)) << "worse than nothing";
    if (Traits::optimal_weights) {
      EXPECT_LE(c.report.kkt_residual, 1e-10);
    }
    EXPECT_FALSE(c.report.stop_reason.empty());
    EXPECT_GE(c.report.seconds, 0);
    EXPECT_GE(c.report.columns_evaluated, c.size());
    for (std::size_t i = 1; i < c.report.history.size(); ++i)
      EXPECT_GE(c.report.history[i].seconds, c.report.history[i - 1].seconds);
  }

  static Selection expect_sound_answer(const DenseProblem& problem, const SelectionRequest& asked) {
    const Selection c = S{}(problem, asked);
    expect_sound(problem, asked, c);
    return c;
  }
};
TYPED_TEST_SUITE_P(SubsetSelectorConformance);

TYPED_TEST_P(SubsetSelectorConformance, AnswersSoundly) {
  const DenseProblem problem = this->problem();
  for (Index s : {2, 7, 20, 40}) {
    const Selection c = this->expect_sound_answer(problem, this->request(s));
    EXPECT_GT(c.size(), 0);
    EXPECT_LT(c.report.training_error, 1);
    EXPECT_FALSE(c.report.history.empty());
  }
}

TYPED_TEST_P(SubsetSelectorConformance, GivesTheSameBitsAgainWhateverTheNumberOfThreads) {
  const DenseProblem problem = this->problem();
  set_num_threads(1);
  const Selection one = TypeParam{}(problem, this->request(12));
  set_num_threads(3);
  const Selection three = TypeParam{}(problem, this->request(12));
  set_num_threads(0);
  EXPECT_EQ(one.indices, three.indices);
  EXPECT_EQ(one.weights, three.weights);
  EXPECT_EQ(one.report.residual, three.report.residual);
}

TYPED_TEST_P(SubsetSelectorConformance, KeepsWhatItMust) {
  SelectionRequest asked = this->request(8);
  asked.must_keep = {77, 3, 40};
  this->expect_sound_answer(this->problem(), asked);
  asked = this->request(3);
  asked.must_keep = {77, 3, 40};
  this->expect_sound_answer(this->problem(), asked);
}

TYPED_TEST_P(SubsetSelectorConformance, KeepsEvenAColumnThatOnlyHarms) {
  Matrix A = this->matrix();
  const Vector b = this->rhs(A);
  A.col(5) = -b;
  A.col(6).setZero();
  SelectionRequest asked = this->request(6);
  asked.must_keep = {5, 6};
  const Selection c = this->expect_sound_answer(DenseProblem(A, b), asked);
  if (SelectorTraits<TypeParam>::signs == Signs::NonNegative && SelectorTraits<TypeParam>::chooses) {
    EXPECT_EQ(c.weights[std::find(c.indices.begin(), c.indices.end(), 5) - c.indices.begin()], 0);
  }
}

TYPED_TEST_P(SubsetSelectorConformance, ChoosesAmongTheCandidates) {
  SelectionRequest asked = this->request(10);
  for (Index j = 1; j < this->cols; j += 3) asked.candidates.push_back(j);
  asked.must_keep = {0};
  this->expect_sound_answer(this->problem(), asked);
  asked.candidates = {4, 8};
  this->expect_sound_answer(this->problem(), asked);
}

TYPED_TEST_P(SubsetSelectorConformance, StartsFromAnEarlierSelection) {
  const DenseProblem problem = this->problem();
  SelectionRequest asked = this->request(10);
  asked.warm_start = TypeParam{}(problem, this->request(10));
  const Selection again = this->expect_sound_answer(problem, asked);
  if (SelectorTraits<TypeParam>::optimal_weights) {
    EXPECT_LE(again.report.residual, asked.warm_start.report.residual * (1 + 1e-9));
  }
  asked.candidates = {1, 2, 3, 5, 8, 13, 21, 34, 55, 89};  // the start may not be a candidate any more
  this->expect_sound_answer(problem, asked);
}

TYPED_TEST_P(SubsetSelectorConformance, ReachesTheTargetErrorOrSaysWhyNot) {
  const DenseProblem problem = this->problem();
  for (double target : {0.9, 0.3, 1e-3, 1e-9}) {
    SelectionRequest asked = this->request(15);
    asked.target_error = target;
    const Selection c = this->expect_sound_answer(problem, asked);
    const bool reached = c.report.training_error <= target * (1 + 1e-9);
    EXPECT_EQ(c.report.status == Status::Converged, reached) << c.report.stop_reason << ", target " << target;
  }
}

TYPED_TEST_P(SubsetSelectorConformance, NeedsNoSizeForATargetError) {
  const DenseProblem problem = this->problem();
  const SelectionRequest asked = SelectionRequest::to_error(0.3);
  const Selection c = this->expect_sound_answer(problem, asked);
  EXPECT_LE(c.report.training_error, 0.3 * (1 + 1e-9));
  if (SelectorTraits<TypeParam>::chooses) {
    EXPECT_LT(c.size(), this->cols / 2);
  }
}

TYPED_TEST_P(SubsetSelectorConformance, ChoosesOneColumn) {
  const Selection c = this->expect_sound_answer(this->problem(), this->request(1));
  if (SelectorTraits<TypeParam>::chooses) {
    EXPECT_EQ(c.size(), 1);
  }
}

TYPED_TEST_P(SubsetSelectorConformance, TakesAllColumnsOfASmallProblem) {
  const Matrix A = gaussian(30, 12, 3);
  const DenseProblem problem(A, A * planted_weights(12, random_subset(12, 12, 1), 4));
  const Selection c = this->expect_sound_answer(problem, 12);
  if (SelectorTraits<TypeParam>::optimal_weights) {
    EXPECT_LE(c.report.training_error, 1e-12);
  }
}

TYPED_TEST_P(SubsetSelectorConformance, BearsASizeBeyondTheRank) {
  const Matrix A = uniform(this->rows, 6, 5) * uniform(6, this->cols, 6);
  this->expect_sound_answer(DenseProblem(A, this->rhs(A)), this->request(30));
  this->expect_sound_answer(this->problem(), this->request(80));  // of 48 rows
}

TYPED_TEST_P(SubsetSelectorConformance, NeedsNothingWhereBIsZero) {
  const DenseProblem problem(this->matrix(), Vector::Zero(this->rows));
  SelectionRequest asked = this->request(5);
  EXPECT_EQ(this->expect_sound_answer(problem, asked).size(), 0);
  asked.must_keep = {7};
  EXPECT_EQ(this->expect_sound_answer(problem, asked).size(), 1);
}

TYPED_TEST_P(SubsetSelectorConformance, NeverTakesAZeroColumn) {
  Matrix A = this->matrix();
  A.col(0).setZero();
  A.col(44).setZero();
  const Vector b = this->rhs(A);
  const Selection c = this->expect_sound_answer(DenseProblem(A, b), this->request(12));
  EXPECT_THAT(c.indices, ::testing::Not(::testing::Contains(::testing::AnyOf(0, 44))));
  EXPECT_EQ(this->expect_sound_answer(DenseProblem(Matrix::Zero(this->rows, this->cols), b), this->request(5))
                .size(),
            0);
}

TYPED_TEST_P(SubsetSelectorConformance, BearsCopiesOfColumns) {
  Matrix A(this->rows, this->cols);
  A << this->matrix().leftCols(30), this->matrix().leftCols(30), this->matrix().leftCols(30);
  const DenseProblem problem(A, this->rhs(A));
  for (Index s : {5, 20, 60}) this->expect_sound_answer(problem, this->request(s));
}

TYPED_TEST_P(SubsetSelectorConformance, BearsColumnsOfVeryDifferentScale) {
  Matrix A = this->matrix();
  const Vector b = this->rhs(A);
  for (Index j = 0; j < A.cols(); ++j) A.col(j) *= std::pow(10.0, 8 * (j % 3) - 8);
  this->expect_sound_answer(DenseProblem(A, b), this->request(12));
  this->expect_sound_answer(DenseProblem(A, 1e8 * b), this->request(12));
  this->expect_sound_answer(DenseProblem(1e-8 * A, 1e-8 * b), this->request(12));
}

TYPED_TEST_P(SubsetSelectorConformance, RefusesNumbersThatAreNotFinite) {
  Matrix A = this->matrix();
  Vector b = this->rhs(A);
  b[11] = std::nan("");
  EXPECT_THROW(TypeParam{}(DenseProblem(A, b), this->request(9)), InputError);
  b[11] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(TypeParam{}(DenseProblem(A, b), this->request(9)), InputError);
  b[11] = 1;
  A(3, 50) = std::nan("");
  SelectionRequest asked = this->request(9);
  asked.must_keep = {50};  // so that every selector meets it
  EXPECT_THROW(TypeParam{}(DenseProblem(A, b), asked), InputError);
}

TYPED_TEST_P(SubsetSelectorConformance, RefusesAnRhsWhoseSquareIsLost) {
  const DenseProblem problem(1e-170 * this->matrix(), Vector::Constant(this->rows, 1e-170));
  EXPECT_THROW(TypeParam{}(problem, this->request(5)), InputError);
}

TYPED_TEST_P(SubsetSelectorConformance, RefusesRequestsThatMakeNoSense) {
  const DenseProblem problem = this->problem();
  const auto refused = [&](auto&& change) {
    SelectionRequest asked = this->request(5);
    change(asked);
    EXPECT_THROW(TypeParam{}(problem, asked), std::invalid_argument);
  };
  refused([](SelectionRequest& asked) { asked.size = 0; });
  refused([](SelectionRequest& asked) { asked.size = 91; });
  refused([](SelectionRequest& asked) { asked.size = SelectionRequest::unlimited; });
  refused([](SelectionRequest& asked) { asked.target_error = -1; });
  refused([](SelectionRequest& asked) { asked.target_error = std::nan(""); });
  refused([](SelectionRequest& asked) { asked.candidates = {90}; });
  refused([](SelectionRequest& asked) { asked.must_keep = {-1}; });
  refused([](SelectionRequest& asked) { asked.size = 2, asked.must_keep = {1, 2, 3}; });
  refused([](SelectionRequest& asked) { asked.warm_start.indices = {3}; });  // without a weight
}

TYPED_TEST_P(SubsetSelectorConformance, AsksForHeldOutErrors) {
  SelectionRequest asked = this->request(6);
  Index calls = 0;
  asked.validate = [&](const std::vector<Index>& indices, VectorIn weights) {
    EXPECT_EQ(static_cast<Index>(indices.size()), weights.size());
    for (Index j : indices) EXPECT_TRUE(0 <= j && j < this->cols);
    return 0.25 + 0 * static_cast<double>(++calls);
  };
  const Selection c = TypeParam{}(this->problem(), asked);
  EXPECT_GT(calls, 0);
  for (const SelectionStep& step : c.report.history) EXPECT_EQ(step.held_out_error, 0.25);
}

REGISTER_TYPED_TEST_SUITE_P(SubsetSelectorConformance, AnswersSoundly,
                            GivesTheSameBitsAgainWhateverTheNumberOfThreads, KeepsWhatItMust,
                            KeepsEvenAColumnThatOnlyHarms, ChoosesAmongTheCandidates,
                            StartsFromAnEarlierSelection, ReachesTheTargetErrorOrSaysWhyNot,
                            NeedsNoSizeForATargetError, ChoosesOneColumn, TakesAllColumnsOfASmallProblem,
                            BearsASizeBeyondTheRank, NeedsNothingWhereBIsZero, NeverTakesAZeroColumn,
                            BearsCopiesOfColumns, BearsColumnsOfVeryDifferentScale,
                            RefusesAnRhsWhoseSquareIsLost,
                            RefusesNumbersThatAreNotFinite, RefusesRequestsThatMakeNoSense,
                            AsksForHeldOutErrors);

}  // namespace supple::test
