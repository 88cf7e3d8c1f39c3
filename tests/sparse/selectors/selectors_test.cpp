#include <sparse/selectors/selector_library.hpp>
#include <testing/subset_selector_conformance.hpp>
#include <tests/sparse/problems.hpp>

#include <gmock/gmock.h>

namespace supple {
namespace {

struct NnHtpFull : NnHtp {
  NnHtpFull() : NnHtp{.candidates_per_size = std::numeric_limits<double>::infinity()} {}
};
struct SubsetTrainedGreedy : GreedyCubature {
  SubsetTrainedGreedy() : GreedyCubature{.subset_groups = 6} {}
};
struct OvershootingOmp : NnOmp {
  OvershootingOmp() : NnOmp{.overshoot = 1.3, .batch = 2} {}
};

using Selectors =
    ::testing::Types<NnSp, NnHtp, NnHtpFull, Htp, Niht, NnNiht, GreedyCubature, SubsetTrainedGreedy, BatchedGreedy,
                     NnOmp, OvershootingOmp, Ecsw, Ecm, Sketched<NnSp>, UniformRandom, AllColumns>;

struct Names {
  template <typename S>
  static std::string GetName(int i) {
    static const std::vector<std::string> names{
        "NnSp",          "NnHtp",        "NnHtpFull",       "Htp",
        "Niht",          "NnNiht",       "GreedyCubature",  "SubsetTrainedGreedy",
        "BatchedGreedy", "NnOmp",        "OvershootingOmp", "Ecsw",
        "Ecm",           "SketchedNnSp", "UniformRandom",   "AllColumns"};
    return names[i];
  }
};

}  // namespace

namespace test {
INSTANTIATE_TYPED_TEST_SUITE_P(Every, SubsetSelectorConformance, Selectors, Names);
}

namespace {

using test::force_fitting_on_a_cube;
using test::gaussian;

// A force fitting of d = 18, T = 30, m = 1500 on which the selectors are compared.
const DenseProblem& cube() {
  static const DenseProblem problem = force_fitting_on_a_cube(6, 30, 1500, 1);
  return problem;
}

TEST(NnSp, HasHalfTheErrorOfNnHtp) {
  for (Index s : {40, 80})
    EXPECT_LT(NnSp{}(cube(), s).report.training_error, 0.6 * NnHtp{}(cube(), s).report.training_error) << "s = " << s;
}

TEST(NnSp, NeverGetsWorse) {
  double best = 2;
  for (Index iterations : {1, 3, 10, 30}) {
    const double error = NnSp{.max_iterations = iterations}(cube(), 40).report.training_error;
    EXPECT_LE(error, best * (1 + 1e-9));
    best = error;
  }
}

TEST(NnSp, RecoversAPlantedSolution) {
  const auto support = test::random_subset(200, 12, 1);
  const Matrix A = gaussian(100, 200, 2);
  const Vector w = test::planted_weights(200, support, 3);
  const Selection c = NnSp{}(DenseProblem(A, A * w), 12);
  EXPECT_EQ(c.indices, support);
  EXPECT_EQ(c.report.status, Status::Converged);
}

TEST(NnSp, FindsTheBestOfAllSelectionsOfASmallProblem) {
  const Matrix A = test::uniform(20, 12, 1);
  const Vector b = A * Vector::Ones(12) + gaussian(20, 1, 2);
  double least = b.norm();
  for (unsigned set = 0; set < (1u << 12); ++set) {
    if (__builtin_popcount(set) != 3) continue;
    std::vector<Index> chosen;
    for (Index j = 0; j < 12; ++j)
      if (set >> j & 1) chosen.push_back(j);
    const Matrix A_S = A(Eigen::all, chosen);
    const Vector w = Fnnls{}(A_S.transpose() * A_S, A_S.transpose() * b).w;
    least = std::min(least, (b - A_S * w).norm());
  }
  const NnSp patient{.max_iterations = 200, .added_per_size = 1, .patience = 100};
  EXPECT_LE(patient(DenseProblem(A, b), 3).report.residual, least * (1 + 1e-9));
}

TEST(NnOmp, TakesTheColumnsInTheOrderOfTheirUse) {
  const Matrix A = Matrix::Identity(10, 10);
  const Vector b{{0, 5, 1, 4, 0, 2, -9, 3, 0, 0}};
  EXPECT_THAT(NnOmp{}(DenseProblem(A, b), 3).indices, ::testing::ElementsAre(1, 3, 7));
}

TEST(NnOmp, GainsByGrowingTooFarAndPruning) {
  EXPECT_LT(NnOmp{.overshoot = 1.3}(cube(), 50).report.residual, NnOmp{}(cube(), 50).report.residual);
}

TEST(Ecsw, ReachesTheOptimumOfNnlsIfNotStopped) {
  const Matrix A = test::uniform(40, 60, 3);
  const Vector b = gaussian(40, 1, 4) + Vector::Ones(40);
  const Selection c = Ecsw{}(DenseProblem(A, b), 60);
  EXPECT_NEAR(c.report.residual, AllColumns{}(DenseProblem(A, b), 60).report.residual, 1e-12 * b.norm());
}

TEST(GreedyCubature, LosesLittleBySubsetTraining) {
  const double all = GreedyCubature{}(cube(), 50).report.training_error;
  const Selection subset = GreedyCubature{.subset_groups = 10}(cube(), 50);
  EXPECT_EQ(subset.size(), 50);
  EXPECT_LT(subset.report.training_error, 3 * all);
}

TEST(Ecm, IsExactOnItsModes) {
  const Matrix A = gaussian(60, 8, 1) * test::uniform(8, 300, 2);  // rank 8: eight columns suffice
  const Selection c = Ecm{}(DenseProblem(A, A * Vector::Ones(300)), 8);
  EXPECT_EQ(c.size(), 8);
  EXPECT_LE(c.report.training_error, 1e-10);
}

TEST(CountSketch, KeepsInnerProductsInTheMean) {
  const Vector x = gaussian(400, 1, 1), y = gaussian(400, 1, 2);
  double mean = 0, square = 0;
  const int trials = 400;
  for (int seed = 0; seed < trials; ++seed) {
    const CountSketch sketch(400, 64, seed);
    Vector sx(64), sy(64);
    sketch.apply(x, sx);
    sketch.apply(y, sy);
    mean += sx.dot(sy) / trials;
    square += sx.squaredNorm() / trials;
  }
  const double deviation = x.norm() * y.norm() * std::sqrt(2.0 / 64 / trials);  // of the mean
  EXPECT_NEAR(mean, x.dot(y), 4 * deviation);
  EXPECT_NEAR(square, x.squaredNorm(), 4 * deviation);
}

TEST(Sketched, LosesLittle) {
  const double exact = NnSp{}(cube(), 40).report.training_error;
  EXPECT_LT(Sketched<NnSp>{}(cube(), 40).report.training_error, 1.5 * exact);
}

TEST(Sketched, ReachesATargetThatItsSizeAllows) {
  const auto expect_reached = [](const auto& select) {
    SelectionRequest request(20);
    request.target_error = 1.05 * select(cube(), request).report.training_error;
    const Selection c = select(cube(), request);
    EXPECT_LE(c.report.training_error, request.target_error);
    EXPECT_EQ(c.report.status, Status::Converged);
  };
  expect_reached(Ecm{});
  expect_reached(Sketched<NnSp>{});
  expect_reached(Sketched<NnOmp>{.select = {}, .rows = 60});
}

TEST(Sketched, AnswersWhereThereAreNoRows) {
  const DenseProblem nothing(Matrix(0, 5), Vector(0));
  EXPECT_EQ(Ecm{}(nothing, 3).size(), 0);
  EXPECT_EQ(Sketched<NnSp>{}(nothing, 3).size(), 0);
}

TEST(Ecm, AccountsForBothItsPasses) {
  const test::CountingProblem problem(cube().matrix(), cube().rhs());
  const Selection c = Ecm{}(problem, 20);
  EXPECT_EQ(c.report.columns_evaluated, problem.evaluated());
  EXPECT_GE(problem.evaluated(), 2 * problem.cols());
}

TEST(GreedyGrowth, JudgesTheTargetByWhatItReturns) {
  SelectionRequest request(50);
  request.target_error = 1.05 * NnOmp{.overshoot = 1.3}(cube(), request).report.training_error;
  const Selection c = NnOmp{.overshoot = 1.3}(cube(), request);
  EXPECT_LE(c.report.training_error, request.target_error);
  EXPECT_EQ(c.report.status, Status::Converged);
}

TEST(NnSp, GoesForTheRequestsTargetBeforeItsOwnTolerance) {
  const Selection c = NnSp{.tolerance = 0.2}(cube(), SelectionRequest::to_error(0.02));
  EXPECT_LE(c.report.training_error, 0.02);
  EXPECT_LT(c.size(), 60);
}

/// b = A w, A Gaussian rows × 200, w with `size` weights of both signs.
struct SignedSignal {
  std::vector<Index> support;
  Vector w;
  DenseProblem problem;

  static SignedSignal planted(Index rows, Index size) {
    const auto support = test::random_subset(200, size, 1);
    const Matrix A = gaussian(rows, 200, 2);
    Vector w = test::planted_weights(200, support, 3);
    for (std::size_t k = 0; k < support.size(); k += 2) w[support[k]] *= -1;
    return {support, w, DenseProblem(A, A * w)};
  }
};

TEST(Niht, RecoversAPlantedSignedSolution) {
  const SignedSignal signal = SignedSignal::planted(100, 10);
  for (const Selection& c : {Niht{}(signal.problem, 10), Htp{}(signal.problem, 10)}) {
    EXPECT_EQ(c.indices, signal.support);
    EXPECT_TRUE(c.weights.isApprox(signal.w(signal.support), 1e-6));
  }
  EXPECT_GT(NnNiht{}(signal.problem, 10).report.training_error, 0.1);
}

TEST(Htp, KeepsItsSignsInSketchesAndWarmStarts) {
  const SignedSignal signal = SignedSignal::planted(1000, 10);
  const Selection sketched = Sketched<Htp>{.select = {}, .rows = 150}(signal.problem, 10);
  EXPECT_EQ(sketched.indices, signal.support);
  EXPECT_LE(sketched.report.training_error, 1e-12);

  SelectionRequest request(10);
  request.warm_start.indices = signal.support;
  request.warm_start.weights = signal.w(signal.support);
  EXPECT_LE((Htp{.max_iterations = 0}(signal.problem, request).report.training_error), 1e-12);
}

TEST(Niht, SurvivesDrawsThatHelpNothing) {
  Matrix A(1, 4);
  A << -1, -1, -1, 1;
  const DenseProblem problem(A, Vector::Ones(1));
  for (std::uint64_t seed = 0; seed < 8; ++seed)
    EXPECT_EQ((NnNiht{.candidates_per_size = 1, .patience = 100, .seed = seed}(problem, 1).report.training_error), 0);
}

TEST(Niht, DecreasesTheErrorMonotonicallyWithNormalizedSteps) {
  const Selection c = Niht{.max_iterations = 50}(cube(), 20);
  ASSERT_GT(c.report.history.size(), 10u);
  for (std::size_t i = 1; i < c.report.history.size(); ++i)
    EXPECT_LE(c.report.history[i].training_error, c.report.history[i - 1].training_error * (1 + 1e-12));
}

TEST(SelectByName, KnowsEveryName) {
  const DenseProblem problem(gaussian(20, 15, 1), gaussian(20, 1, 2));
  for (std::string_view name : selector_names) {
    const Index s = name == "all" ? 15 : 4;
    EXPECT_LE(select_by_name(name, problem, s, 1).size(), s) << name;
  }
  EXPECT_THROW(select_by_name("nn_sp", problem, 4, 1), std::invalid_argument);
}

TEST(SelectByName, DoesTheSameOnATypeErasedProblem) {
  for (std::string_view name : selector_names) {
    if (name == "all") continue;
    const Selection expected = select_by_name(name, cube(), 10, 1), c = select_by_name(name, AnyProblem(cube()), 10, 1);
    EXPECT_EQ(c.indices, expected.indices) << name;
    EXPECT_EQ(c.weights, expected.weights) << name;
  }
  const GreedyCubature greedy{.subset_groups = 5};
  EXPECT_EQ(greedy(AnyProblem(cube()), 10).indices, greedy(cube(), 10).indices);
}

TEST(SelectByName, RefusesAnAnswerThatIsNone) {
  struct Answer {
    Selection answer;
    Selection operator()(const AnyProblem&, const SelectionRequest&) const { return answer; }
  };
  const auto refused = [](const char* name, std::vector<Index> indices, Vector weights, const char* reason) {
    selectors().add({name,
                     "",
                     {},
                     [answer = Selection{std::move(indices), std::move(weights), {}}](
                         const OptionValues&, std::uint64_t) -> NamedSelector::Run { return Answer{answer}; }});
    EXPECT_THAT(
        [&] { (void)AnySelector(name)(cube(), 10); },
        testing::ThrowsMessage<SolverError>(testing::AllOf(testing::HasSubstr(name), testing::HasSubstr(reason))));
  };
  refused("beyond", {1, 1000000}, Vector::Ones(2), "column 1000000");
  refused("negative-index", {-1}, Vector::Ones(1), "column -1");
  refused("too-many-weights", {1, 2}, Vector::Ones(5), "5 weights for 2 columns");
  refused("unsorted", {5, 1}, Vector::Ones(2), "do not ascend");
  refused("twice", {1, 1}, Vector::Ones(2), "do not ascend");
  refused("not-finite", {1}, Vector::Constant(1, NAN), "not finite");
}

// Only what the concept asks for: no blocks, no full gradient, no groups.
TEST(SelectByName, NeedsNoMoreThanColumnsOnDemand) {
  const test::ColumnsOnly problem(cube().matrix(), cube().rhs());
  for (std::string_view name : selector_names) {
    if (name == "all") continue;
    const Selection expected = select_by_name(name, cube(), 10, 1), c = select_by_name(name, problem, 10, 1);
    if (name == "nn-sp") {  // draws by norms where the problem knows them
      EXPECT_LT(c.report.residual, 1.2 * expected.report.residual);
      continue;
    }
    EXPECT_EQ(c.indices, expected.indices) << name;
    EXPECT_NEAR(c.report.residual, expected.report.residual, 1e-9 * problem.rhs().norm()) << name;
  }
}

}  // namespace
}  // namespace supple
