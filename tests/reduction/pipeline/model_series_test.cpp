#include <reduction/pipeline/model_series.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace supple::test {
namespace {

double seconds_of(const ReduceReport& report, const std::string& stage) {
  const auto found = std::ranges::find(report.seconds, stage, &std::pair<std::string, double>::first);
  return found == report.seconds.end() ? -1 : found->second;
}

TEST(ModelSeries, MakesTheModelsOfReduceAndSharesTheTrainingOfThoseThatDifferInPoints) {
  const TetMesh mesh = bar_mesh();
  const Body body = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.35}, bar_end(mesh));
  ReduceOptions options;
  options.modes = 4;
  options.poses.count = 24;
  options.held_out_poses = 8;
  ModelSeries series(body);
  double last = -1;
  for (const auto& [modes, points] : {std::pair{4, 20}, {4, 40}, {3, 40}}) {
    options.modes = modes;
    options.points = points;
    ReduceReport report, alone_report;
    const ReducedModel model = series.make(options, report), alone = reduce(body, options, &alone_report);
    EXPECT_EQ(model.indices, alone.indices);
    EXPECT_EQ(model.weights, alone.weights);
    EXPECT_EQ(model.subspace_name, alone.subspace_name);
    EXPECT_EQ(report.training_error, alone_report.training_error);
    EXPECT_EQ(report.held_out_error, alone_report.held_out_error);
    ASSERT_EQ(report.seconds.size(), alone_report.seconds.size());  // those of the training, too
    const double training = seconds_of(report, "training forces");
    EXPECT_EQ(training == last, modes == 4 && points == 40);  // the very same stage
    last = training;
    double sum = 0;
    for (const auto& [stage, seconds] : report.seconds) sum += seconds;
    EXPECT_LE(sum, report.total_seconds * (1 + 1e-9));
  }
}

}  // namespace
}  // namespace supple::test
