#include <physics/mesh/tet_mesh.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/meshes.hpp>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <numeric>

namespace supple::test {
namespace {

using testing::HasSubstr;

Point node(const TetMesh& mesh, Index v) {
  return mesh.nodes.row(v);
}

/// Copies with nodes of their own, each shifted.
TetMesh copies(const TetMesh& part, Index count) {
  TetMesh mesh;
  mesh.nodes.resize(count * part.num_nodes(), 3);
  for (Index k = 0; k < count; ++k) {
    mesh.nodes.middleRows(k * part.num_nodes(), part.num_nodes()) =
        part.nodes.rowwise() + Eigen::RowVector3d(5 * static_cast<double>(k), 0, 0);
    for (Tet tet : part.cells) {
      for (Index& v : tet) v += k * part.num_nodes();
      mesh.cells.push_back(tet);
    }
  }
  return mesh;
}

TEST(TetMesh, VolumesAreSignedAndFillTheBox) {
  EXPECT_NEAR(tet_volume(single_tet(2), 0), 8.0 / 6, 1e-15);
  TetMesh reversed = single_tet(2);
  std::swap(reversed.cells[0][1], reversed.cells[0][3]);
  EXPECT_NEAR(tet_volume(reversed, 0), -8.0 / 6, 1e-15);

  const TetMesh box = kuhn_box(3, 2, 4, 0.5);
  ASSERT_EQ(box.num_cells(), 6 * 24);
  double sum = 0;
  for (Index e = 0; e < box.num_cells(); ++e) {
    EXPECT_NEAR(tet_volume(box, e), 0.125 / 6, 1e-15);
    sum += tet_volume(box, e);
  }
  EXPECT_NEAR(sum, 24 * 0.125, 1e-13);
}

TEST(TetMesh, OrientationIsRelativeToTheSizeOfTheTet) {
  for (const double size : {1e-9, 1.0, 1e9}) {
    TetMesh mesh = single_tet(size);
    EXPECT_EQ(tet_orientation(mesh, 0), 1);
    mesh.nodes(3, 2) = 1e-10 * size;  // thin, but rounding does not decide
    EXPECT_EQ(tet_orientation(mesh, 0), 1);
    std::swap(mesh.cells[0][0], mesh.cells[0][1]);
    EXPECT_EQ(tet_orientation(mesh, 0), -1);
    mesh.nodes.row(3) = 0.3 * mesh.nodes.row(1) + 0.1 * mesh.nodes.row(2);
    EXPECT_EQ(tet_orientation(mesh, 0), 0);
  }
}

TEST(TetMesh, RadiusRatioIsOneForTheRegularTetAndZeroForAFlatOne) {
  TetMesh regular = single_tet();
  regular.nodes << 1, 1, 1, -1, 1, -1, 1, -1, -1, -1, -1, 1;  // corners of a cube
  EXPECT_NEAR(radius_ratio(regular, 0), 1, 1e-14);
  TetMesh moved = regular;
  moved.nodes = ((7.0 * regular.nodes) * random_rotation(3)).rowwise() + Eigen::RowVector3d(1, 2, 3);
  EXPECT_NEAR(radius_ratio(moved, 0), 1, 1e-13);
  // (0, e₁, e₂, e₃): r = (3 − √3) / 6, R = √3 / 2
  EXPECT_NEAR(radius_ratio(single_tet(), 0), (3 - std::sqrt(3.0)) / std::sqrt(3.0), 1e-14);
  TetMesh flat = single_tet();
  flat.nodes.row(3) << 0.5, 0.5, 0;
  EXPECT_EQ(radius_ratio(flat, 0), 0);
}

TEST(TetMesh, BoundaryIsAClosedSurfaceAroundTheVolume) {
  const TetMesh mesh = perturbed(kuhn_box(3, 2, 2, 0.5), 0.05, 4);
  const std::vector<Triangle> faces = boundary_faces(mesh);
  EXPECT_EQ(faces.size(), 2u * 2 * (3 * 2 + 3 * 2 + 2 * 2));  // two triangles a square
  std::map<std::pair<Index, Index>, int> edges;
  Point area = Point::Zero();
  double volume = 0, sum = 0;
  for (const Triangle& t : faces) {
    for (int a = 0; a < 3; ++a) ++edges[{t[a], t[(a + 1) % 3]}];
    const Point a = node(mesh, t[0]), b = node(mesh, t[1]), c = node(mesh, t[2]);
    area += (b - a).cross(c - a) / 2;
    volume += a.dot(b.cross(c)) / 6;  // divergence theorem: positive if oriented outward
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1) << edge.first << " - " << edge.second;
    EXPECT_EQ((edges.count({edge.second, edge.first})), 1u) << "every edge once each way";
  }
  for (Index e = 0; e < mesh.num_cells(); ++e) sum += tet_volume(mesh, e);
  EXPECT_TRUE(is_near(area, Point::Zero(), 1e-13));
  EXPECT_NEAR(volume, sum, 1e-13);
  EXPECT_EQ(static_cast<int>(mesh.num_nodes()) - 2 * 1 * 1, static_cast<int>(boundary_nodes(mesh).size()));
}

TEST(TetMesh, BoundaryOfOneTetIsItsFourFaces) {
  EXPECT_THAT(boundary_faces(single_tet()), testing::SizeIs(4));
}

TEST(TetMesh, ConnectedComponentsAreNumberedByTheirFirstNodes) {
  const TetMesh box = kuhn_box(2, 1, 1);
  EXPECT_EQ(connected_components(box).count, 1);
  TetMesh three = copies(box, 3);
  NodeComponents components = connected_components(three);
  EXPECT_EQ(components.count, 3);
  for (Index v = 0; v < three.num_nodes(); ++v) EXPECT_EQ(components.of_node[v], v / box.num_nodes()) << v;

  // a tet from the first to the last joins these two
  three.cells.push_back({0, 1, 2, 2 * box.num_nodes()});
  components = connected_components(three);
  EXPECT_EQ(components.count, 2);
  for (Index v = 0; v < three.num_nodes(); ++v) EXPECT_EQ(components.of_node[v], v / box.num_nodes() == 1 ? 1 : 0) << v;

  // a node without tets is a component of its own
  TetMesh isolated = single_tet();
  isolated.nodes.conservativeResize(6, 3);
  isolated.cells = {{5, 2, 3, 1}};
  components = connected_components(isolated);
  EXPECT_EQ(components.count, 3);
  EXPECT_THAT(components.of_node, testing::ElementsAre(0, 1, 1, 1, 2, 1));
}

TEST(TetMesh, HingesAreCountedWhereTheBoundaryIsNoSurface) {
  const auto hinges = [](const TetMesh& mesh) {
    const Hinges h = boundary_hinges(mesh);
    return std::pair(h.edges, h.nodes);
  };
  EXPECT_EQ(hinges(kuhn_box(3, 2, 2)), std::pair(Index{0}, Index{0}));
  EXPECT_EQ(hinges(copies(single_tet(), 2)), std::pair(Index{0}, Index{0}));
  TetMesh at_node;  // two tets back to back at the origin
  at_node.nodes.resize(7, 3);
  at_node.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, -1, 0, 0, 0, -1, 0, 0, 0, -1;
  at_node.cells = {{0, 1, 2, 3}, {0, 4, 6, 5}};
  EXPECT_EQ(hinges(at_node), std::pair(Index{0}, Index{1}));
  TetMesh at_edge;  // two tets on either side of the z-axis
  at_edge.nodes.resize(6, 3);
  at_edge.nodes << 0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, -1, 0, 0, 0, -1, 0;
  at_edge.cells = {{0, 2, 3, 1}, {0, 4, 5, 1}};
  EXPECT_NO_THROW(check_mesh(at_edge));
  EXPECT_EQ(hinges(at_edge), std::pair(Index{1}, Index{0}));
}

TEST(TetMesh, BoundingBoxHoldsAllNodes) {
  const BoundingBox box = bounding_box(kuhn_box(3, 2, 4, 0.5).nodes);
  EXPECT_TRUE(is_same(box.lower, Point::Zero()));
  EXPECT_TRUE(is_same(box.upper, Point(1.5, 1, 2)));
  EXPECT_NEAR(box.diagonal(), std::sqrt(1.5 * 1.5 + 1 + 4), 1e-15);
}

TEST(CheckMesh, AcceptsGoodMeshes) {
  EXPECT_NO_THROW(check_mesh(single_tet(1e-6)));
  EXPECT_NO_THROW(check_mesh(perturbed(kuhn_box(3, 3, 2), 0.015, 8)));
}

TEST(CheckMesh, NamesTheFirstFault) {
  const auto message = [](const TetMesh& mesh, const MeshNumbers& numbers = {}) -> std::string {
    try {
      check_mesh(mesh, numbers);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "nothing";
  };
  TetMesh mesh = single_tet();
  mesh.cells.clear();
  EXPECT_THAT(message(mesh), HasSubstr("no cells"));
  mesh = single_tet();
  mesh.cells[0][2] = 4;
  EXPECT_THAT(message(mesh), HasSubstr("tet 0 names node 4, which does not exist"));
  mesh.cells[0][2] = 1;
  EXPECT_THAT(message(mesh), HasSubstr("names node 1 twice"));
  mesh = single_tet();
  mesh.nodes.conservativeResize(5, 3);
  mesh.nodes.row(4).setOnes();
  EXPECT_THAT(message(mesh), HasSubstr("node 4 belongs to no tet"));
  mesh = single_tet();
  mesh.nodes(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message(mesh), HasSubstr("node 2 has a coordinate that is not finite"));
  EXPECT_THAT(message(mesh, {.node = {11, 12, 13, 14}, .cell = {}}), HasSubstr("node 13"));
  mesh = single_tet();
  mesh.nodes(3, 2) = 0;
  EXPECT_THAT(message(mesh), HasSubstr("zero volume"));
  mesh = single_tet();
  std::swap(mesh.cells[0][0], mesh.cells[0][1]);
  EXPECT_THAT(message(mesh), HasSubstr("reversed"));
  mesh = kuhn_box(1, 1, 1);
  mesh.region = {1, 2};
  EXPECT_THAT(message(mesh), HasSubstr("mesh.region has size 2, expected 6"));
  mesh.region.clear();
  mesh.cells.push_back(mesh.cells[4]);
  EXPECT_THAT(message(mesh), HasSubstr("have the same nodes"));
  mesh = single_tet();  // a second apex on the same side of a face
  mesh.nodes.conservativeResize(5, 3);
  mesh.nodes.row(4) << 0.2, 0.2, 0.8;
  mesh.cells.push_back({0, 1, 2, 4});
  EXPECT_THAT(message(mesh), HasSubstr("overlap"));
}

}  // namespace
}  // namespace supple::test
