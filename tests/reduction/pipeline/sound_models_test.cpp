// Models that cannot work are not made silently: what is left of the stiffness at rest decides.

#include <core/check.hpp>
#include <physics/body/material_law.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/solids.hpp>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <vector>

namespace supple::test {
namespace {

struct NamedBody {
  std::string name;
  Body body;
  Index rank;  ///< the largest of a component's stiffness: its unknowns less six rigid motions
};

std::vector<Index> end_of(const Points& nodes) {
  std::vector<Index> end;
  for (Index v = 0; v < nodes.rows(); ++v)
    if (nodes(v, 0) < 0.03) end.push_back(v);
  return end;
}

/// Bars of every law, held and free; of other elements and of Gauss points; a plate.
std::vector<NamedBody> bodies() {
  std::vector<NamedBody> all;
  for (const std::string law :
       {"stvk", "mooney-rivlin", "neo-hookean", "stable-neo-hookean", "corotational", "ogden", "fung"})
    all.push_back({law, isotropic_solid(bar_mesh(), rubber, bar_end(bar_mesh()), law), 6});
  all.push_back({"free bar", isotropic_solid(bar_mesh(), rubber), 6});
  const HexMesh hexes = irregular_box<TrilinearHex>({6, 2, 2}, 0.1);
  all.push_back({"hexahedra", isotropic_solid(hexes, rubber, end_of(hexes.nodes)), 18});
  const QuadraticTetMesh tets = irregular_box<QuadraticTet>({4, 1, 1}, 0.2);
  QuadraticTetSolid points = isotropic_solid(tets, rubber, end_of(tets.nodes), "neo-hookean");
  all.push_back({"quadratic tets", points, 24});
  points.component = SolidComponent::GaussPoint;
  all.push_back({"Gauss points", points, 6});
  const TriangleMesh plate = equilateral_grid(8, 6, 0.1);
  all.push_back({"plate", isotropic_shell(plate, {.young = 1e6, .poisson = 0.35}, 0.01, end_of(plate.nodes)), 6});
  return all;
}

ReduceOptions coarse_fit() {
  ReduceOptions options;
  options.modes = 4;
  options.poses.count = 24;
  options.held_out_poses = 0;
  options.equilibria = 0;
  options.selector = "nn-sp:max_iterations=8";
  return options;
}
ReduceOptions coarse_fit(const Body& body) {
  ReduceOptions options = coarse_fit();
  if (fixed_nodes(body).empty()) options.modes = 9;
  return options;
}

/// Smallest of xᵀ K̃(0) x / xᵀ K̄ x over motions x with energy, by Cholesky factors.
double smallest_ratio(const ReducedModel& model) {
  const Matrix fitted = model.system().stiffness(Vector::Zero(model.dim()));
  const Eigen::SelfAdjointEigenSolver<Matrix> exact(model.rest_stiffness);
  Index zero = 0;
  while (exact.eigenvalues()[zero] < 1e-9 * exact.eigenvalues()[model.dim() - 1]) ++zero;
  const Matrix V = exact.eigenvectors().rightCols(model.dim() - zero);
  return Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(V.transpose() * fitted * V,
                                                          V.transpose() * model.rest_stiffness * V)
      .eigenvalues()[0];
}

std::string refusal(const Body& body, const ReduceOptions& options) {
  try {
    (void)reduce(body, options);
    return "";
  } catch (const SolverError& error) {
    return error.what();
  }
}

// 30 % of the error are reached by components that are too few to hold the object: so few that their ranks do not even add
// up to the dimension, or nearly so.
TEST(SoundModels, MeetATargetErrorWithStiffnessInEveryDirection) {
  Index repaired = 0, below_rank = 0;
  for (const auto& [name, body, rank] : bodies()) {
    SCOPED_TRACE(name);
    ReduceOptions options = coarse_fit(body);
    options.points = 400;
    options.target_error = 0.3;
    ReduceReport report;
    const ReducedModel model = reduce(body, options, &report);
    const double ratio = smallest_ratio(model);
    EXPECT_LE(report.training_error, options.target_error);
    EXPECT_GE(ratio, 0.1);
    EXPECT_NEAR(report.rest_stiffness.smallest, ratio, 1e-9);
    const Index flexible = model.dim() - report.rigid_modes;
    EXPECT_GE(report.points * rank, flexible);
    if (report.points_too_weak == 0) continue;
    ++repaired;
    if (report.points_too_weak * rank < flexible) ++below_rank;
    EXPECT_LT(report.points_too_weak, report.points);
  }
  EXPECT_GE(repaired, 8) << "the bodies are too easy for the test";
  EXPECT_GE(below_rank, 1);
}

TEST(SoundModels, AreNotMadeOfFewerPointsThanItTakes) {
  for (const auto& [name, body, rank] : bodies()) {
    SCOPED_TRACE(name);
    ReduceOptions options = coarse_fit(body);
    options.points = 24 / rank;  // the dimension is at least 36
    options.singular = SingularModels::Refuse;
    const std::string message = refusal(body, options);
    ASSERT_THAT(message, testing::HasSubstr(std::string(component_name(body)) + " leave a direction with"));
    const std::string before = "it takes ";
    const std::size_t at = message.find(before);
    ASSERT_NE(at, std::string::npos) << message;
    options.points = std::stol(message.substr(at + before.size()));
    EXPECT_GE(options.points * rank, 36);
    ReduceReport report;
    EXPECT_GE(smallest_ratio(reduce(body, options, &report)), 0.1);
    EXPECT_THAT(report.notes, testing::Not(testing::Contains(testing::HasSubstr("leave a direction"))));
  }
}

TEST(SoundModels, OfStudiesMayBeSingularWithANote) {
  ReduceOptions options = coarse_fit();
  options.points = 4;
  ReduceReport report;
  const Body bar = isotropic_solid(bar_mesh(), rubber, bar_end(bar_mesh()));
  EXPECT_LT(smallest_ratio(reduce(bar, options, &report)), 1e-9);
  EXPECT_TRUE(report.rest_stiffness.is_singular() && report.rest_stiffness.is_weak());
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_THAT(report.notes[0], testing::HasSubstr("no stiffness at rest"));
}

// What is allowed may be too little, whatever is asked for.
TEST(SoundModels, NameWhatIsNotEnough) {
  const Body bar = isotropic_solid(bar_mesh(), rubber, bar_end(bar_mesh()));
  ReduceOptions options = coarse_fit();
  options.singular = SingularModels::Refuse;
  options.candidates = {30, 70, 110};
  for (const Index points : {2, 100}) {
    options.points = points;
    EXPECT_THAT(refusal(bar, options), testing::HasSubstr("not even 3 points mend that"));
  }
  options.target_error = 0.9;
  EXPECT_THAT(refusal(bar, options), testing::HasSubstr("not even 3 points mend that"));
  options.candidates.clear();
  options.points = 5;
  EXPECT_THAT(refusal(bar, options), testing::HasSubstr("it takes"));
}

// Components at random hold an object only if there are many: of the usual number not always enough.
TEST(SoundModels, TakeAsManyPointsAsItTakesWhereTheNumberIsOpen) {
  const TetMesh mesh = kuhn_box(16, 4, 4, 0.05);
  const Body bar = isotropic_solid(mesh, rubber, end_of(mesh.nodes));
  ReduceOptions options = coarse_fit();
  options.points = 0;
  options.selector = "random";
  Index repaired = 0;
  for (options.seed = 1; options.seed <= 5; ++options.seed) {
    ReduceReport report;
    EXPECT_GE(smallest_ratio(reduce(bar, options, &report)), 0.1);
    if (report.points_too_weak == 0) continue;
    ++repaired;
    EXPECT_LE(report.points_too_weak, 4 * 36 / 3);
    EXPECT_GT(report.points, report.points_too_weak);
  }
  EXPECT_GT(repaired, 0) << "components at random do too well for the test";
}

}  // namespace
}  // namespace supple::test
