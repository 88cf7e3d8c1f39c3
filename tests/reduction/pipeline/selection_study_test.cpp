#include <reduction/pipeline/reduce.hpp>
#include <reduction/pipeline/selection_study.hpp>
#include <sparse/selectors/selector_library.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

namespace supple::test {
namespace {

ReduceOptions small_fit() {
  ReduceOptions options;
  options.modes = 4;
  options.poses.count = 48;
  options.held_out_poses = 16;
  return options;
}

Solid held_bar() {
  const TetMesh mesh = bar_mesh();
  return isotropic_solid(mesh, {.young = 1e5, .poisson = 0.35}, bar_end(mesh));
}

const SelectionStudy& study() {
  static const SelectionStudy shared(
      held_bar(), small_fit(), {{.name = "pull"}, {.name = "ramped", .ramp = 60}, {.name = "damped", .damping = 0.1}});
  return shared;
}

Selection select(const std::string& selector, Index size, std::uint64_t seed = 1) {
  return select_by_name(selector, study().problem(), size, seed);
}

TEST(SelectionStudy, PullsReachTheirTargets) {
  ASSERT_EQ(study().scenes().size(), 3u);
  EXPECT_THAT(study().largest_displacements(), testing::Each(testing::DoubleNear(0.25, 0.02)));
}

TEST(SelectionStudy, FindsNothingWrongWithAllComponents) {
  Selection all = select("all", 144);
  all.weights.setOnes();
  const SelectionMeasure measure = study().measure(all);
  for (const auto& [share, error] : measure.held_out) EXPECT_LT(error, 1e-12);
  EXPECT_NEAR(measure.softest_eigenvalue, 1, 1e-9);
  EXPECT_THAT(measure.trajectory_errors, testing::Each(testing::Lt(1e-4)));
  EXPECT_GT(measure.force_seconds, 0);
}

TEST(SelectionStudy, SeesMoreComponentsComeCloser) {
  const SelectionMeasure few = study().measure(select("nn-sp", 10)), many = study().measure(select("nn-sp", 60));
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_LT(many.held_out[k].second, few.held_out[k].second);
    EXPECT_LT(many.trajectory_errors[k], few.trajectory_errors[k]);
  }
  EXPECT_LT(std::abs(many.softest_eigenvalue - 1), 0.05);
}

TEST(SelectionStudy, PosesTheProblemThatReduceSolves) {
  ReduceOptions options = small_fit();
  options.points = 30;
  options.seed = 1;
  ReduceReport report;
  const ReducedModel model = reduce(held_bar(), options, &report);
  const Selection selection = select(options.selector, 30);
  EXPECT_EQ(selection.indices, model.indices);
  EXPECT_EQ(study().report().dimension, report.dimension);
  EXPECT_EQ(study().measure(selection).held_out, report.held_out);
  EXPECT_EQ(study().held_out_error(model.indices, model.weights), report.held_out_error);
}

TEST(SelectionStudy, LeavesMotionsWithNegativeWeightsOut) {
  Selection selection = select("nn-sp", 30);
  selection.weights[3] = -selection.weights[3];
  const SelectionMeasure measure = study().measure(selection);
  EXPECT_TRUE(std::isnan(measure.softest_eigenvalue));
  EXPECT_THAT(measure.trajectory_errors, testing::Each(testing::IsNan()));
  EXPECT_GT(measure.held_out[0].second, 0.01);
}

TEST(Reduce, RefusesSelectorsThatGiveNegativeWeights) {
  ReduceOptions options = small_fit();
  options.selector = "htp";
  options.points = 60;
  EXPECT_THROW((void)reduce(held_bar(), options), SolverError);
}

TEST(SelectionStudy, DeformsFreeObjectsInsteadOfPushingThemAway) {
  Solid free = held_bar();
  free.fixed_nodes = {};
  ReduceOptions options = small_fit();
  options.modes = 9;
  const SelectionStudy some(free, options, {{.name = "pull", .steps = 40}});
  EXPECT_NEAR(some.largest_displacements()[0], 0.25, 0.05);
  const SelectionMeasure few = some.measure(select_by_name("nn-sp", some.problem(), 12, 1)),
                         many = some.measure(select_by_name("nn-sp", some.problem(), 70, 1));
  EXPECT_GT(few.trajectory_errors[0], 1e-3);  // a translation would be exact
  EXPECT_LT(many.trajectory_errors[0], few.trajectory_errors[0]);
}

TEST(PullTest, GivesTheSameMotionsWithOneThreadAndTwo) {
  const Selection selection = select("nn-sp", 30);
  set_num_threads(1);
  const std::vector<double> one = study().measure(selection).trajectory_errors;
  set_num_threads(2);
  EXPECT_EQ(study().measure(selection).trajectory_errors, one);
  set_num_threads(0);
}

}  // namespace
}  // namespace supple::test
