#include <core/random.hpp>
#include <reduction/pipeline/model_choice.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {
namespace {

using testing::ElementsAre;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// From the definition.
bool dominated(const ModelMeasure& model, const std::vector<ModelMeasure>& others) {
  return std::ranges::any_of(others, [&](const ModelMeasure& other) {
    const bool as_good = other.step_seconds <= model.step_seconds && other.error <= model.error;
    return as_good && (other.step_seconds < model.step_seconds || other.error < model.error);
  });
}

TEST(ParetoFront, HoldsExactlyTheModelsThatNoOtherDominates) {
  Random random(3);
  for (int round = 0; round < 50; ++round) {
    std::vector<ModelMeasure> models(1 + static_cast<std::size_t>(round));
    for (ModelMeasure& model : models)  // on a coarse grid, for ties
      model = {std::floor(8 * random.uniform()), std::floor(8 * random.uniform())};
    const std::vector<bool> front = pareto_front(models);
    ASSERT_EQ(front.size(), models.size());
    EXPECT_TRUE(std::ranges::find(front, true) != front.end());
    for (std::size_t k = 0; k < models.size(); ++k) EXPECT_EQ(front[k], !dominated(models[k], models)) << k;
  }
}

TEST(ParetoFront, LeavesOutWhatIsNotKnown) {
  const std::vector<ModelMeasure> models{{1, nan}, {nan, 0}, {2, 0.1}, {3, 0.2}};
  EXPECT_THAT(pareto_front(models), ElementsAre(false, false, true, false));
  EXPECT_TRUE(pareto_front({}).empty());
}

TEST(ModelGoal, OfErrorTakesTheFirstThatIsNearEnoughAndElseTheNearest) {
  const std::vector<ModelMeasure> tried{{1, 0.09}, {2, 0.04}, {3, nan}, {4, 0.01}};
  EXPECT_EQ((ModelGoal{ModelGoal::Limit::Error, 0.1}.best_of(tried)), 0u);
  EXPECT_EQ((ModelGoal{ModelGoal::Limit::Error, 0.05}.best_of(tried)), 1u);
  EXPECT_EQ((ModelGoal{ModelGoal::Limit::Error, 0.04}.best_of(tried)), 1u);  // at most
  EXPECT_EQ((ModelGoal{ModelGoal::Limit::Error, 0.001}.best_of(tried)), 3u);
  EXPECT_EQ((ModelGoal{ModelGoal::Limit::Error, 1}.best_of(std::vector<ModelMeasure>{{1, nan}, {2, 3}, {3, 2}})), 2u);
}

TEST(ModelGoal, OfTimeTakesTheNearestThatIsFastEnoughAndElseTheFastest) {
  const std::vector<ModelMeasure> tried{{4e-5, 0.09}, {6e-5, 0.02}, {5e-5, 0.03}, {9e-5, 0.01}};
  const auto best = [&](double most) { return ModelGoal{ModelGoal::Limit::StepTime, most}.best_of(tried); };
  EXPECT_EQ(best(1), 3u);
  EXPECT_EQ(best(7e-5), 1u);
  EXPECT_EQ(best(5e-5), 2u);
  EXPECT_EQ(best(4.5e-5), 0u);
  EXPECT_EQ(best(1e-6), 0u);
  EXPECT_EQ((ModelGoal{ModelGoal::Limit::StepTime, 1e-6}.best_of(std::vector<ModelMeasure>{{3, 0.1}, {2, 0.2}})), 1u);
}

/// A search keeps one model, the best so far: a better one among more must be among the new.
TEST(ModelGoal, NeverReturnsToAModelThatItPassedOver) {
  Random random(5);
  for (const ModelGoal::Limit limit : {ModelGoal::Limit::Error, ModelGoal::Limit::StepTime})
    for (int round = 0; round < 200; ++round) {
      const ModelGoal goal{limit, random.uniform()};
      std::vector<ModelMeasure> tried;
      std::size_t before = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        tried.push_back({random.uniform(), random.uniform()});
        const std::size_t best = goal.best_of(tried);
        EXPECT_TRUE(best == k || best == before);
        const bool any = std::ranges::any_of(tried, [&](const ModelMeasure& model) { return goal.is_met_by(model); });
        EXPECT_EQ(goal.is_met_by(tried[best]), any);
        before = best;
      }
    }
}

TEST(ModelGoal, HasNothingToChooseFromNothing) {
  EXPECT_THROW((void)ModelGoal{}.best_of({}), std::invalid_argument);
}

}  // namespace
}  // namespace supple
