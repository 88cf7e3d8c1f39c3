#include <physics/body/material_law.hpp>
#include <reduction/pipeline/model_ladder.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace supple::test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

Solid solid(const TetMesh& mesh, std::vector<Index> held) {
  return isotropic_solid(mesh, {.young = 1e5, .poisson = 0.35}, std::move(held));
}
Solid large_solid(bool held) {
  const TetMesh mesh = kuhn_box(12, 4, 4, 0.1);
  return solid(mesh, held ? bar_end(mesh) : std::vector<Index>{});
}
Shell large_shell() {
  const TriangleMesh mesh = equilateral_grid(20, 16, 0.1);
  return isotropic_shell(mesh, {.young = 1e6, .poisson = 0.35}, 0.01,
                         nodes_where(mesh, [](const Point& x) { return x[0] < 0.08; }), 1000);
}

TEST(ModelLadder, RunsFromCoarseToFineAndKeepsWhatIsNotOfTheSize) {
  const ReduceOptions base = ReduceOptions::relaxed_derivatives();
  for (const Body& body : {Body(large_solid(true)), Body(large_solid(false)), Body(large_shell())}) {
    const std::vector<ModelRung> ladder = model_ladder(body, base);
    ASSERT_GE(ladder.size(), 5u);
    for (const ModelRung& rung : ladder) {
      EXPECT_NO_THROW(check(rung.options));
      EXPECT_TRUE(rung.options.relaxed);
      EXPECT_EQ(rung.options.poses.count, base.poses.count);
      EXPECT_GE(rung.options.points, rung.dimension);
    }
    EXPECT_TRUE(std::ranges::is_sorted(
        ladder, {}, [](const ModelRung& rung) { return relative_step_time(rung.dimension, rung.options.points); }));
  }
  const ModelRung usual = model_ladder(large_solid(true), base)[2];  // what `supple reduce` does without a goal
  EXPECT_EQ(usual.options.subspace, base.subspace);
  EXPECT_EQ(usual.options.modes, base.modes);
  EXPECT_EQ(usual.options.points, 120);
}

TEST(ModelLadder, EndsWhereTheObjectIsTooSmallButNeverIsEmpty) {
  const TetMesh bar = bar_mesh();  // 63 nodes, of which 9 are held
  const std::vector<ModelRung> some = model_ladder(solid(bar, bar_end(bar)), {});
  ASSERT_EQ(some.size(), 2u);
  EXPECT_EQ(some.back().dimension, 60);
  const TetMesh cube = kuhn_box(1, 1, 1, 1);
  EXPECT_EQ(model_ladder(solid(cube, {0, 1, 2}), {}).size(), 1u);
}

TEST(ModelWords, SayWhatTheModelIs) {
  ReduceOptions options = ReduceOptions::relaxed_derivatives();
  options.points = 110;
  EXPECT_EQ(in_words(options), "derivatives:num_derivatives=70:modes=20:points=110");
  for (const ModelRung& rung : model_ladder(large_shell(), options)) {
    const ModelWords words = ModelWords::parse(in_words(rung.options));
    EXPECT_EQ(words.subspace, rung.options.subspace);
    EXPECT_EQ(words.modes, rung.options.modes);
    EXPECT_EQ(words.points, rung.options.points);
    EXPECT_EQ(words.dimension, std::nullopt);
  }
  const ModelWords words = ModelWords::parse("derivatives:dimension=40:affine_fields=no+modal:points=7");
  EXPECT_EQ(words.subspace, "derivatives:affine_fields=no+modal");
  EXPECT_EQ(words.dimension, 40);
  EXPECT_EQ(words.points, 7);
  EXPECT_EQ(words.modes, std::nullopt);
}

TEST(ModelWords, NameWhatIsWrong) {
  const auto parse = [](const char* text) { return [text] { (void)ModelWords::parse(text); }; };
  EXPECT_THAT(parse("extended:points=many"), ThrowsMessage<std::invalid_argument>(HasSubstr("points is 'many'")));
  EXPECT_THAT(parse("extended:points"), ThrowsMessage<std::invalid_argument>(HasSubstr("whole number")));
  EXPECT_THAT(parse("extended:modes=0"), ThrowsMessage<std::invalid_argument>(HasSubstr("modes is '0'")));
  EXPECT_THAT(parse("extended:points=3:points=4"), ThrowsMessage<std::invalid_argument>(HasSubstr("'points' twice")));
  EXPECT_THAT(parse("teapot:points=3"), ThrowsMessage<std::invalid_argument>(HasSubstr("teapot")));
  EXPECT_THAT(parse(""), ThrowsMessage<std::invalid_argument>(HasSubstr("subspace")));
}

TEST(RelativeStepTime, GrowsWithDimensionAndPoints) {
  EXPECT_GT(relative_step_time(60, 80), relative_step_time(50, 80));
  EXPECT_GT(relative_step_time(60, 80), relative_step_time(60, 70));
}

}  // namespace
}  // namespace supple::test
