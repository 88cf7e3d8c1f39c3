#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/builtin/isosurface_stuffing.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/mesh/tet_mesh.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace supple::test {
namespace {

using testing::HasSubstr;

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Index e = 0; e < mesh.num_cells(); ++e) sum += tet_volume(mesh, e);
  return sum;
}

double least_radius_ratio(const TetMesh& mesh) {
  double least = 1;
  for (Index e = 0; e < mesh.num_cells(); ++e) least = std::min(least, radius_ratio(mesh, e));
  return least;
}

void expect_one_solid(const TetMesh& mesh) {
  EXPECT_NO_THROW(check_mesh(mesh));
  EXPECT_EQ(connected_components(mesh).count, 1);
  EXPECT_EQ(boundary_hinges(mesh).edges, 0);
  EXPECT_EQ(boundary_hinges(mesh).nodes, 0);
}

TEST(BuiltinMesh, BarHasSixTetsACellAndALongestSideOfOneMetre) {
  const TetMesh mesh = builtin_mesh("bar:8x2x3");
  expect_one_solid(mesh);
  EXPECT_EQ(mesh.num_nodes(), 9 * 3 * 4);
  EXPECT_EQ(mesh.num_cells(), 6 * 8 * 2 * 3);
  const BoundingBox box = bounding_box(mesh.nodes);
  EXPECT_EQ(box.lower, Point(0, 0, 0));
  EXPECT_EQ(box.upper, Point(1, 0.25, 0.375));
  EXPECT_NEAR(volume(mesh), 0.25 * 0.375, 1e-15);
  EXPECT_EQ(static_cast<Index>(boundary_faces(mesh).size()), 4 * (8 * 2 + 2 * 3 + 8 * 3));
  EXPECT_EQ(builtin_mesh("bar:80x20x10").num_cells(), 96000);
}

TEST(BuiltinMesh, CubeFillsTheUnitCube) {
  const TetMesh mesh = builtin_mesh("cube:5");
  expect_one_solid(mesh);
  EXPECT_EQ(mesh.num_cells(), 6 * 125);
  EXPECT_NEAR(volume(mesh), 1, 1e-13);  // 750 terms, sums of rounding 1e-16
}

TEST(BuiltinMesh, MengerSpongesHaveTheCountsOfTheirConstruction) {
  struct Sponge {
    const char* spec;
    Index num_nodes, num_tets, num_faces;
    double volume;
  };
  const double classic = 20.0 / 27;
  for (const Sponge& sponge : {Sponge{"menger:3,1,1", 64, 120, 144, classic},
                               {"menger:3,2,1", 896, 2400, 2112, classic * classic},
                               {"menger:3,3,1", 15616, 48000, 36096, classic * classic * classic},
                               {"menger:4,1,1", 112, 192, 240, 0.5},
                               {"menger:4,2,1", 2720, 6144, 5952, 0.25},
                               {"menger:4,2,4", 90560, 393216, 95232, 0.25}}) {
    SCOPED_TRACE(sponge.spec);
    const TetMesh mesh = builtin_mesh(sponge.spec);
    EXPECT_EQ(mesh.num_nodes(), sponge.num_nodes);
    EXPECT_EQ(mesh.num_cells(), sponge.num_tets);
    EXPECT_EQ(static_cast<Index>(boundary_faces(mesh).size()), sponge.num_faces);
    EXPECT_NEAR(volume(mesh), sponge.volume, 1e-11);  // 4e5 terms of rounding 1e-17
    expect_one_solid(mesh);
  }
}

TEST(BuiltinMesh, VolumeOfTheBallConvergesWithOrderTwo) {
  const double exact = std::numbers::pi / 6;
  const double coarse = exact - volume(builtin_mesh("ball:12")), fine = exact - volume(builtin_mesh("ball:24"));
  EXPECT_GT(fine, 0);  // chords of a convex surface
  EXPECT_GT(std::log2(coarse / fine), 1.8);
}

TEST(BuiltinMesh, BallsOfEveryResolutionAreSound) {
  for (int n = 6; n <= 30; n += 3) {
    SCOPED_TRACE(n);
    const TetMesh mesh = builtin_mesh("ball:" + std::to_string(n));
    expect_one_solid(mesh);
    EXPECT_GT(least_radius_ratio(mesh), 0.2);
    for (const Triangle& face : boundary_faces(mesh))
      for (const Index v : face) EXPECT_NEAR(mesh.nodes.row(v).norm(), 0.5, 1e-8);
  }
}

TEST(BuiltinMesh, OctopusIsASoundSolidOfNinetyThousandTetsOnAFoot) {
  const TetMesh mesh = builtin_mesh("octopus");
  expect_one_solid(mesh);
  EXPECT_GE(mesh.num_cells(), 90000);
  EXPECT_GT(least_radius_ratio(mesh), 0.1);
  const BoundingBox box = bounding_box(mesh.nodes);
  EXPECT_NEAR(box.lower[1], 0, 1e-9);
  EXPECT_NEAR(box.extent()[0], 1, 0.05);
  for (const Index v : select_nodes(mesh.nodes, "y<4%"))  // the foot, no arm
    EXPECT_LT(std::hypot(mesh.nodes(v, 0), mesh.nodes(v, 2)), 0.2);
  EXPECT_GT(static_cast<Index>(select_nodes(mesh.nodes, "y<4%").size()), 300);
}

TEST(BuiltinMesh, OctopusOfOtherResolutionsIsSound) {
  for (const char* spec : {"octopus:30", "octopus:36", "octopus:60"}) {
    SCOPED_TRACE(spec);
    const TetMesh mesh = builtin_mesh(spec);
    expect_one_solid(mesh);
    EXPECT_GT(least_radius_ratio(mesh), 0.1);
  }
}

TEST(BuiltinMesh, IsTheSameEveryTime) {
  const TetMesh a = builtin_mesh("octopus:30"), b = builtin_mesh("octopus:30");
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.nodes, b.nodes);
}

TEST(BuiltinMesh, IsKnownByItsName) {
  for (const char* spec :
       {"bar:1x1x1", "cube:2", "menger:3,1,1", "octopus", "octopus:50", "ball:9", "cube", "bar:wrong"})
    EXPECT_TRUE(is_builtin(spec)) << spec;
  for (const char* spec : {"", "bar.msh", "octopuses", "./cube", "cube/2", ":2"})
    EXPECT_FALSE(is_builtin(spec)) << spec;
}

TEST(BuiltinMesh, RefusesWhatItCannotMakeAndSaysWhatItExpects) {
  const auto refusal = [](const char* spec) -> std::string {
    try {
      builtin_mesh(spec);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  for (const char* spec :
       {"bar", "bar:", "bar:80x20", "bar:80x20x0", "bar:80x20x10x1", "bar:-1x2x2", "bar:8x2x2 ", "bar:axbxc"})
    EXPECT_THAT(refusal(spec), HasSubstr(std::string(spec) + ": expected bar:NXxNYxNZ"));
  EXPECT_THAT(refusal("cube:1.5"), HasSubstr("expected cube:N"));
  EXPECT_THAT(refusal("menger:2,1,1"), HasSubstr("BASE ≥ 3"));
  EXPECT_THAT(refusal("octopus:9"), HasSubstr("30 … 200 cells"));
  EXPECT_THAT(refusal("ball:3"), HasSubstr("4 … 130 cells"));
  for (const char* spec : {"cube:1000", "bar:99999999999x1x1", "menger:3,99,1", "menger:3,1,999999999",
                           "menger:4611686018427387904,2,4611686018427387904"})
    EXPECT_THAT(refusal(spec), HasSubstr("30 million")) << spec;
  EXPECT_THAT(refusal("teapot"), HasSubstr("octopus"));
}

TEST(StuffIsosurface, RefusesASpacingThatIsNoneAndASolidThatIsNot) {
  const BoundingBox box{Point::Zero(), Point::Ones()};
  const auto outside = [](const Point&) { return -1.0; };
  EXPECT_THROW(stuff_isosurface(outside, box, 0), std::invalid_argument);
  EXPECT_THROW(stuff_isosurface(outside, box, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(stuff_isosurface(outside, box, 1e-6), std::invalid_argument);
  EXPECT_THROW(stuff_isosurface(outside, box, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
