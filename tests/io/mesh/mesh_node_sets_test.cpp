#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/support/meshes.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Nodes at x = 0, ¼, …, 1 and y, z = 0, ¼; the half above x = ½ is the region 7, "right".
TetMesh bar() {
  TetMesh mesh = builtin_mesh("bar:4x1x1");
  for (const Tet& tet : mesh.cells) {
    double x = 0;
    for (const Index v : tet) x += mesh.nodes(v, 0) / 4;
    mesh.region.push_back(x < 0.5 ? 3 : 7);
  }
  mesh.region_names = {{7, "right"}};
  return mesh;
}

template <typename Select>
std::string refusal(const Select& select) {
  try {
    select();
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

TEST(SelectNodes, TakesOneSideOfAPlane) {
  const TetMesh mesh = bar();
  const auto expect = [&](const char* rule, const auto& holds) {
    EXPECT_EQ(select_nodes(mesh.nodes, rule), nodes_where(mesh, holds)) << rule;
  };
  expect("x<0.5", [](const Point& p) { return p[0] < 0.5; });
  expect("x<=0.5", [](const Point& p) { return p[0] <= 0.5; });
  expect(" x > 5e-1 ", [](const Point& p) { return p[0] > 0.5; });
  expect("x >= +0.5", [](const Point& p) { return p[0] >= 0.5; });
  expect("y<4%", [](const Point& p) { return p[1] == 0; });
  expect("y>=100%", [](const Point& p) { return p[1] == 0.25; });
  expect("z<=0 %", [](const Point& p) { return p[2] == 0; });
  expect("x<25.5%", [](const Point& p) { return p[0] <= 0.25; });
}

TEST(SelectNodes, TakesPlanesUnitsAndSeveralComparisons) {
  const TetMesh mesh = bar();
  const auto expect = [&](const char* rule, const auto& holds) {
    EXPECT_EQ(select_nodes(mesh.nodes, rule), nodes_where(mesh, holds)) << rule;
  };
  expect("x=0.5", [](const Point& p) { return p[0] == 0.5; });
  expect("x = 50 %", [](const Point& p) { return p[0] == 0.5; });
  expect("x=500 mm", [](const Point& p) { return p[0] == 0.5; });
  expect("x>=25cm", [](const Point& p) { return p[0] >= 0.25; });
  expect("x=0 and y=0", [](const Point& p) { return p[0] == 0 && p[1] == 0; });
  expect("x=0 or y=0", [](const Point& p) { return p[0] == 0 || p[1] == 0; });
  // "and" binds more
  expect("x=0 and y=0 or x=1 and z=0",
         [](const Point& p) { return (p[0] == 0 && p[1] == 0) || (p[0] == 1 && p[2] == 0); });
  expect("x=0 or y=0 and z=0", [](const Point& p) { return p[0] == 0 || (p[1] == 0 && p[2] == 0); });
  EXPECT_THAT(refusal([&] { select_nodes(mesh.nodes, "x=0 and x=1"); }), HasSubstr("selects no node"));
}

TEST(SelectNodes, FindsAPlaneThroughRoundedCoordinates) {
  TetMesh mesh = bar();
  const std::vector<Index> plane = select_nodes(mesh.nodes, "x=0");
  for (const Index v : plane) mesh.nodes(v, 0) += v % 2 == 0 ? 3e-8 : -3e-8;
  EXPECT_EQ(select_nodes(mesh.nodes, "x=0"), plane);
}

TEST(SelectNodes, CountsSharesFromTheLowerEndWhereverTheMeshLies) {
  TetMesh mesh = bar();
  const std::vector<Index> expected = select_nodes(mesh.nodes, "x<=25%");
  mesh.nodes.col(0).array() -= 1000;
  mesh.nodes *= 1e-3;
  EXPECT_EQ(select_nodes(mesh.nodes, "x<=25.001%"), expected);
}

TEST(SelectNodes, RefusesOtherRulesAndEmptySets) {
  const TetMesh mesh = bar();
  for (const char* rule : {"", "y", "y<", "w<1", "y=", "y<<1", "y<1 and", "y<1 or z", "y<1 and  or x>0", "y<2 kg", "<1",
                           "y<1%%", "y<a", "y<1 2", "y<nan", "xy<1", "y<1%x"})
    EXPECT_THAT(refusal([&] { select_nodes(mesh.nodes, rule); }),
                HasSubstr("\"" + std::string(rule) + "\": expected an axis"));
  EXPECT_THAT(refusal([&] { select_nodes(mesh.nodes, "x<0%"); }), HasSubstr("\"x<0%\": selects no node"));
}

TEST(NodesInBox, AreThoseInTheClosedBox) {
  const TetMesh mesh = bar();
  EXPECT_EQ(nodes_in_box(mesh.nodes, "0.25,0,0:0.5,0.1,0.25"),
            nodes_where(mesh, [](const Point& p) { return p[0] >= 0.25 && p[0] <= 0.5 && p[1] == 0; }));
  EXPECT_EQ(nodes_in_box(mesh.nodes, "-1, -1, -1 : 2, 2, 2").size(), 20u);
  for (const char* box : {"", "0,0,0", "0,0,0:1,1", "0,0,0:1,1,1,1", "0,0,0,1,1,1", "0,0,a:1,1,1", "0:0:0:1:1:1"})
    EXPECT_THAT(refusal([&] { nodes_in_box(mesh.nodes, box); }), HasSubstr("expected xmin,ymin,zmin:xmax,ymax,zmax"));
  EXPECT_THAT(refusal([&] { nodes_in_box(mesh.nodes, "1,0,0:0,1,1"); }), HasSubstr("above its upper bound"));
  EXPECT_THAT(refusal([&] { nodes_in_box(mesh.nodes, "5,5,5:6,6,6"); }), HasSubstr("selects no node"));
}

TEST(NodesOfRegion, AreThoseOfItsTetsByNameOrNumber) {
  const TetMesh mesh = bar();
  const std::vector<Index> right = nodes_where(mesh, [](const Point& p) { return p[0] >= 0.5; });
  EXPECT_EQ(nodes_of_region(mesh, "right"), right);
  EXPECT_EQ(nodes_of_region(mesh, "7"), right);
  EXPECT_EQ(nodes_of_region(mesh, "3"), nodes_where(mesh, [](const Point& p) { return p[0] <= 0.5; }));
  EXPECT_THAT(refusal([&] { nodes_of_region(mesh, "left"); }), HasSubstr("no such region; the mesh has 3, 7 (right)"));
  EXPECT_THAT(refusal([&] { nodes_of_region(builtin_mesh("cube:1"), "1"); }), HasSubstr("the mesh has no regions"));
}

TEST(ReadNodeSet, TakesOneIndexALine) {
  const TetMesh mesh = bar();
  const auto read = [&](const std::string& text) {
    return read_node_set(mesh.nodes, write(text, test_folder() / "nodes.txt"));
  };
  EXPECT_THAT(read("# fixed\n5\r\n0   # the corner\n\n19\n5\n"), ElementsAre(0, 5, 19));
  EXPECT_THAT(refusal([&] { read("1\n2\n20\n"); }),
              HasSubstr("nodes.txt:3: node 20 does not exist: indices are 0 … 19"));
  EXPECT_THAT(refusal([&] { read("1\n-1\n"); }), HasSubstr(":2: node -1 does not exist"));
  EXPECT_THAT(refusal([&] { read("1\n2.5\n"); }), HasSubstr(":2: expected a node index, found \"2.5\""));
  EXPECT_THAT(refusal([&] { read("# nothing\n"); }), HasSubstr("names no node"));
  EXPECT_THROW(read_node_set(mesh.nodes, "/absent/nodes.txt"), InputError);
}

}  // namespace
}  // namespace supple::test
