#pragma once
/// \file Test suite of what every SubsetSelector promises. A new selector joins with
/// INSTANTIATE_TYPED_TEST_SUITE_P(Mine, SubsetSelectorConformance, ::testing::Types<MySelector>); and, if it cannot be
/// told a size or its weights are no least-squares fit, a specialisation of SelectorTraits. One whose weights may be
/// negative says so by `static constexpr Signs signs = Signs::Any;`.

#include <core/parallel.hpp>
#include <sparse/selection/explain_subset_selector.hpp>
#include <sparse/selectors/selectors.hpp>
#include <testing/agreement.hpp>
#include <testing/random_problems.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace supple::test {

template <typename S>
struct SelectorTraits {
  static constexpr Signs signs = signs_of<S>();
  static constexpr bool chooses = true;          ///< false: takes all candidates, whatever the size
  static constexpr bool optimal_weights = true;  ///< the weights are a least-squares fit
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

/// What holds for the answer to any request, or a sentence that says what does not.
/// \param optimal_weights  whether the weights must be a least-squares fit.
inline ::testing::AssertionResult is_sound(const Selection& c, const DenseProblem& problem,
                                           const SelectionRequest& asked, Signs signs, bool optimal_weights) {
  const auto violated = [](const auto&... parts) {
    return ::testing::AssertionFailure() << text("selector: ", parts...);
  };
  const auto contains = [](const std::vector<Index>& set, Index j) {
    return std::find(set.begin(), set.end(), j) != set.end();
  };
  if (c.weights.size() != c.size())
    return violated("weights: expected one for each of ", c.size(), " indices, found ", c.weights.size());
  if (c.size() > asked.size) return violated("indices: expected at most ", asked.size, ", found ", c.size());
  for (Index k = 0; k < c.size(); ++k) {
    const Index j = c.indices[k];
    const double w = c.weights[k];
    if (j < 0 || j >= problem.cols())
      return violated("indices[", k, "]: expected a column 0 to ", problem.cols() - 1, ", found ", j);
    if (k > 0 && j <= c.indices[k - 1])
      return violated("indices[", k, "]: expected more than ", c.indices[k - 1], ", the one before it, found ", j);
    if (!contains(asked.must_keep, j)) {
      if (w == 0) return violated("weight of column ", j, ": expected a column without weight to be left out, found 0");
      if (!asked.candidates.empty() && !contains(asked.candidates, j))
        return violated("indices[", k, "]: expected a candidate, found column ", j);
    }
    if (signs == Signs::NonNegative && !(w >= 0)) return violated("weight of column ", j, ": expected >= 0, found ", w);
  }
  for (const Index j : asked.must_keep)
    if (!contains(c.indices, j)) return violated("indices: expected column ", j, ", which it must keep, found none");

  const SelectionReport& report = c.report;
  const Vector residual = problem.rhs() - problem.matrix()(Eigen::all, c.indices) * c.weights;
  const double r = residual.norm(), b = problem.rhs().norm();
  if (!(std::abs(report.residual - r) <= 1e-10 * b))
    return violated("report.residual: expected |A w - b| = ", r, ", found ", report.residual);
  if (!(std::abs(report.training_error - (b > 0 ? r / b : 0)) <= 1e-10))
    return violated("report.training_error: expected |A w - b| / |b| = ", b > 0 ? r / b : 0, ", found ",
                    report.training_error);
  if (!(report.residual <= b * (1 + 1e-12)))
    return violated("report.residual: expected at most |b| = ", b, ", that of no column, found ", report.residual);
  if (optimal_weights && !(report.kkt_residual <= 1e-10))
    return violated("report.kkt_residual: expected <= 1e-10, for weights are a least-squares fit, found ",
                    report.kkt_residual);
  if (report.stop_reason.empty()) return violated("report.stop_reason: expected words, found none");
  if (!(report.seconds >= 0)) return violated("report.seconds: expected >= 0, found ", report.seconds);
  if (report.columns_evaluated < c.size())
    return violated("report.columns_evaluated: expected at least ", c.size(), ", found ", report.columns_evaluated);
  for (std::size_t i = 1; i < report.history.size(); ++i)
    if (report.history[i].seconds < report.history[i - 1].seconds)
      return violated("report.history[", i, "].seconds: expected at least ", report.history[i - 1].seconds, ", found ",
                      report.history[i].seconds);
  return ::testing::AssertionSuccess();
}

template <typename S>
class SubsetSelectorConformance : public ::testing::Test {
 protected:
  static_assert(explain_subset_selector<S>());
  using Traits = SelectorTraits<S>;

  static constexpr Index rows = 48, cols = 90;

  // Columns with a positive mean, so that they resemble each other, and b their noisy sum.
  static Matrix matrix() { return uniform(rows, cols, 1) - Matrix::Constant(rows, cols, 0.3); }
  static Vector rhs(const Matrix& A) { return A * Vector::Ones(A.cols()) + gaussian(A.rows(), 1, 2); }
  static DenseProblem problem() { return DenseProblem(matrix(), rhs(matrix()), 4); }

  static SelectionRequest request(Index s) { return Traits::chooses ? s : cols; }

  static Selection expect_sound_answer(const DenseProblem& problem, const SelectionRequest& asked) {
    const Selection c = S{}(problem, asked);
    EXPECT_TRUE(is_sound(c, problem, asked, Traits::signs, Traits::optimal_weights));
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
  const Matrix A = uniform(60, 700, 1) - Matrix::Constant(60, 700, 0.3);  // enough columns for several threads
  const DenseProblem problem(A, this->rhs(A), 4);
  SelectionRequest asked = 12;
  if (!SelectorTraits<TypeParam>::chooses)
    for (Index j = 0; j < 700; j += 5) asked.candidates.push_back(j);
  if (!SelectorTraits<TypeParam>::chooses) asked.size = 700;
  set_num_threads(1);
  const Selection one = TypeParam{}(problem, asked);
  set_num_threads(3);
  const Selection three = TypeParam{}(problem, asked);
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

TYPED_TEST_P(SubsetSelectorConformance, IsNoWorseThanABetterStart) {
  const DenseProblem problem = this->problem();
  SelectionRequest asked = this->request(10);
  asked.warm_start = NnSp{.seed = 7}(problem, this->request(10));
  const Index copied = asked.warm_start.indices[0];  // copies count once
  asked.warm_start.indices.insert(asked.warm_start.indices.begin(), 3, copied);
  asked.warm_start.weights = Vector::Ones(asked.warm_start.size());
  const Selection chosen = this->expect_sound_answer(problem, asked);
  if (SelectorTraits<TypeParam>::optimal_weights) {
    EXPECT_LE(chosen.report.residual, asked.warm_start.report.residual * (1 + 1e-9) + 1e-14 * problem.rhs().norm());
    // reached already, up to rounding
    asked.target_error = 1e-12 + 1.001 * asked.warm_start.report.residual / problem.rhs().norm();
    EXPECT_EQ(this->expect_sound_answer(problem, asked).report.status, Status::Converged);
  }
}

TYPED_TEST_P(SubsetSelectorConformance, ReachesTheTargetErrorOrSaysWhyNot) {
  const DenseProblem problem = this->problem();
  const double within_reach = TypeParam{}(problem, this->request(15)).report.training_error;
  for (double target : {0.9, 0.3, 1.05 * within_reach + 1e-12, 0.95 * within_reach + 1e-12, 1e-3, 1e-9}) {
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
  EXPECT_EQ(this->expect_sound_answer(DenseProblem(Matrix::Zero(this->rows, this->cols), b), this->request(5)).size(),
            0);
}

TYPED_TEST_P(SubsetSelectorConformance, BearsCopiesOfColumns) {
  Matrix A(this->rows, this->cols);
  A << this->matrix().leftCols(30), this->matrix().leftCols(30), this->matrix().leftCols(30);
  const DenseProblem problem(A, this->rhs(A));
  for (Index s : {5, 20, 60}) this->expect_sound_answer(problem, this->request(s));
}

TYPED_TEST_P(SubsetSelectorConformance, BearsColumnsThatHardlyDiffer) {
  if (SelectorTraits<TypeParam>::signs == Signs::Any) return;  // whose weights cancel: as large as columns are near
  for (const double apart : {1e-6, 1e-9, 1e-12, 1e-15}) {
    Matrix A(this->rows, this->cols);
    A << this->matrix().leftCols(30), this->matrix().leftCols(30), this->matrix().leftCols(30);
    A += apart * gaussian(this->rows, this->cols, 9);
    const DenseProblem problem(A, this->rhs(A), 4);
    for (Index s : {5, 20, 60}) this->expect_sound_answer(problem, this->request(s));
  }
}

TYPED_TEST_P(SubsetSelectorConformance, NeedsNothingWhereBIsOrthogonalToAllColumns) {
  Matrix A = this->matrix();
  A.topRows(8).setZero();
  Vector b = Vector::Zero(this->rows);
  b.head(8).setOnes();
  EXPECT_EQ(this->expect_sound_answer(DenseProblem(A, b, 4), this->request(12)).size(), 0);
}

TYPED_TEST_P(SubsetSelectorConformance, BearsColumnsOfVeryDifferentScale) {
  Matrix A = this->matrix();
  const Vector b = this->rhs(A);
  for (Index j = 0; j < A.cols(); ++j) A.col(j) *= std::pow(10.0, 8 * (j % 3) - 8);
  this->expect_sound_answer(DenseProblem(A, b), this->request(12));
  this->expect_sound_answer(DenseProblem(A, 1e8 * b), this->request(12));
  this->expect_sound_answer(DenseProblem(1e-8 * A, 1e-8 * b), this->request(12));
}

TYPED_TEST_P(SubsetSelectorConformance, GivesTheSameBitsInAnyUnits) {
  const Matrix A = this->matrix();
  const Vector b = this->rhs(A);
  const Selection plain = this->expect_sound_answer(DenseProblem(A, b), this->request(12));
  for (const int of_A : {-450, 0, 450})  // powers of two, which change no digit: about 1e-135 and 1e135
    for (const int of_b : {-450, 450}) {
      const DenseProblem problem(std::ldexp(1, of_A) * A, std::ldexp(1, of_b) * b);
      const Selection c = TypeParam{}(problem, this->request(12));
      EXPECT_EQ(c.indices, plain.indices) << of_A << ", " << of_b;
      EXPECT_EQ(c.report.training_error, plain.report.training_error) << of_A << ", " << of_b;
      ASSERT_EQ(c.weights.size(), plain.weights.size());
      for (Index k = 0; k < c.size(); ++k) EXPECT_EQ(c.weights[k], std::ldexp(plain.weights[k], of_b - of_A));
    }
  Matrix mixed = A;  // one column beside which the others are nothing
  mixed.col(5) *= 1e120;
  this->expect_sound_answer(DenseProblem(mixed, b), this->request(12));
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

TYPED_TEST_P(SubsetSelectorConformance, RefusesUnitsInWhichSquaresAreNoNumbers) {
  const Matrix A = this->matrix();
  const Vector b = this->rhs(A);
  for (const double unit : {1e-170, 1e-145, 1e150, 1e200})
    EXPECT_THROW(TypeParam{}(DenseProblem(A, unit * b), this->request(5)), InputError) << unit;
  for (const double unit : {1e-145, 1e150, 1e200})
    EXPECT_THROW(TypeParam{}(DenseProblem(unit * A, b), this->request(5)), InputError) << unit;
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

REGISTER_TYPED_TEST_SUITE_P(SubsetSelectorConformance, AnswersSoundly, GivesTheSameBitsAgainWhateverTheNumberOfThreads,
                            KeepsWhatItMust, KeepsEvenAColumnThatOnlyHarms, ChoosesAmongTheCandidates,
                            StartsFromAnEarlierSelection, IsNoWorseThanABetterStart, ReachesTheTargetErrorOrSaysWhyNot,
                            NeedsNoSizeForATargetError, ChoosesOneColumn, TakesAllColumnsOfASmallProblem,
                            BearsASizeBeyondTheRank, NeedsNothingWhereBIsZero, NeverTakesAZeroColumn,
                            BearsCopiesOfColumns, BearsColumnsThatHardlyDiffer,
                            NeedsNothingWhereBIsOrthogonalToAllColumns, BearsColumnsOfVeryDifferentScale,
                            GivesTheSameBitsInAnyUnits, RefusesUnitsInWhichSquaresAreNoNumbers,
                            RefusesNumbersThatAreNotFinite, RefusesRequestsThatMakeNoSense, AsksForHeldOutErrors);

}  // namespace supple::test
