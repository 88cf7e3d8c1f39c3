#include <physics/mesh/mass.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <testing/near.hpp>
#include <tests/support/meshes.hpp>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <set>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// A band of `count` squares, its end joined to its start: as it is, or turned over (a Möbius strip).
TriangleMesh band(Index count, bool turned_over) {
  TriangleMesh mesh;
  mesh.nodes.resize(2 * count, 3);
  for (Index k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(count);
    const double turn = turned_over ? angle / 2 : 0;
    for (int side = 0; side < 2; ++side) {
      const double w = side == 0 ? -0.3 : 0.3, r = 1 + w * std::sin(turn);
      mesh.nodes.row(2 * k + side) << r * std::cos(angle), w * std::cos(turn), r * std::sin(angle);
    }
    const bool is_last = k + 1 == count;
    const Index a = 2 * k, b = a + 1, next = is_last ? 0 : a + 2, swap = is_last && turned_over ? 1 : 0;
    mesh.triangles.push_back({a, b, next + swap});
    mesh.triangles.push_back({b, next + 1 - swap, next + swap});
  }
  return mesh;
}

TEST(TriangleMesh, AreasAddUpToTheSheet) {
  const TriangleMesh mesh = square_grid(4, 3, 0.1);
  double area = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) area += triangle_area(mesh, t);
  EXPECT_NEAR(area, 0.12, 1e-15);
}

TEST(TriangleMesh, RadiusRatioIsOneForTheEquilateralTriangleAndZeroForAFlatOne) {
  EXPECT_NEAR(radius_ratio(equilateral_grid(1, 1, 1e-5), 0), 1, 1e-14);
  EXPECT_NEAR(radius_ratio(square_grid(1, 1), 0), 2 * (std::sqrt(2) - 1), 1e-14);
  TriangleMesh flat = square_grid(1, 1);
  flat.nodes.row(3) = 2 * flat.nodes.row(1);
  EXPECT_EQ(radius_ratio(flat, 0), 0);
}

TEST(TriangleMesh, FlapsAndBoundaryEdgesTogetherAreTheSidesOfTheTriangles) {
  for (const TriangleMesh& mesh : {square_grid(3, 2), equilateral_grid(2, 3), octahedron(), band(5, false)}) {
    std::set<std::array<Index, 2>> sides;
    for (const Triangle& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) sides.insert({t[k], t[(k + 1) % 3]});
    const std::vector<Flap> flaps = interior_edges(mesh);
    const auto boundary = boundary_edges(mesh);
    EXPECT_EQ(2 * flaps.size() + boundary.size(), sides.size());
    for (const auto& edge : boundary) EXPECT_EQ(sides.erase(edge), 1u);
    for (const Flap& flap : flaps) {
      const auto [a, b, c, d] = flap.nodes;
      EXPECT_EQ(sides.erase({a, b}), 1u);
      EXPECT_EQ(sides.erase({b, a}), 1u);
      const auto has_corners = [&](Index t, Triangle corners) {
        std::rotate(corners.begin(), std::find(corners.begin(), corners.end(), mesh.triangles[t][0]), corners.end());
        return mesh.triangles[t] == corners;
      };
      EXPECT_TRUE(has_corners(flap.triangles[0], {a, b, c}));
      EXPECT_TRUE(has_corners(flap.triangles[1], {b, a, d}));
      EXPECT_LT(flap.triangles[0], flap.triangles[1]);
    }
    EXPECT_TRUE(sides.empty());
    EXPECT_TRUE(std::is_sorted(flaps.begin(), flaps.end(),
                               [](const Flap& f, const Flap& g) { return f.triangles[0] < g.triangles[0]; }));
  }
}

TEST(TriangleMesh, ClosedSurfacesHaveThreeHalvesAsManyFlapsAsTriangles) {
  EXPECT_EQ(interior_edges(octahedron()).size(), 12u);
  EXPECT_TRUE(boundary_edges(octahedron()).empty());
  EXPECT_EQ(boundary_edges(band(7, false)).size(), 14u);
}

TEST(TriangleMesh, ConnectedComponentsAndPinchedNodesAreThoseOfTheSurface) {
  TriangleMesh two = square_grid(2, 1);
  const TriangleMesh one = octahedron();
  const Index n = two.num_nodes();
  two.nodes.conservativeResize(n + 6, 3);
  two.nodes.bottomRows(6) = one.nodes;
  for (Triangle t : one.triangles) {
    for (Index& v : t) v += n;
    two.triangles.push_back(t);
  }
  EXPECT_NO_THROW(check_mesh(two));
  EXPECT_EQ(connected_components(two).count, 2);
  EXPECT_EQ(connected_components(one).count, 1);
  EXPECT_EQ(surface_hinges(two.triangles, two.num_nodes()).nodes, 0);
  for (Triangle& t : two.triangles)
    for (Index& v : t)
      if (v == n) v = 0;  // hangs by a node
  EXPECT_EQ(surface_hinges(two.triangles, two.num_nodes()).nodes, 1);
}

TEST(OrientConsistently, TurnsTheSmallerPartOfEachPieceAndKeepsTheFirstTriangleOfEqualOnes) {
  TriangleMesh mesh = equilateral_grid(4, 3);
  const std::vector<Triangle> original = mesh.triangles;
  EXPECT_EQ(orient_consistently(mesh), 0);
  for (const std::size_t t : {0u, 5u, 6u}) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  EXPECT_EQ(orient_consistently(mesh), 3);
  EXPECT_EQ(mesh.triangles, original);

  TriangleMesh pair = square_grid(1, 1);
  std::swap(pair.triangles[0][1], pair.triangles[0][2]);
  const Triangle first = pair.triangles[0];
  EXPECT_EQ(orient_consistently(pair), 1);
  EXPECT_EQ(pair.triangles[0], first);
  EXPECT_NO_THROW(check_mesh(pair));
}

TEST(OrientConsistently, RefusesAMoebiusStripByAnEdge) {
  TriangleMesh ring = band(9, false), moebius = band(9, true);
  orient_consistently(ring);
  EXPECT_NO_THROW(check_mesh(ring));
  try {
    orient_consistently(moebius);
    FAIL() << "a Möbius strip was oriented";
  } catch (const std::invalid_argument& error) {
    EXPECT_THAT(error.what(), HasSubstr("only one side"));
    EXPECT_THAT(error.what(), HasSubstr("edge ("));
  }
}

TEST(CheckTriangleMesh, AcceptsSurfacesOfAnySizeAndPlace) {
  for (const double scale : {1e-9, 1.0, 1e9}) {
    TriangleMesh mesh = octahedron(scale);
    mesh.nodes.rowwise() += scale * Eigen::RowVector3d(1e3, -1e3, 1e3);
    EXPECT_NO_THROW(check_mesh(mesh)) << scale;
  }
  TriangleMesh needles = square_grid(1, 1, 1.0);
  needles.nodes(3, 1) = 1e-9;
  EXPECT_NO_THROW(check_mesh(needles));
}

TEST(CheckTriangleMesh, NamesWhatIsAtFault) {
  const auto message = [](const TriangleMesh& mesh, const MeshNumbers& numbers = {}) -> std::string {
    try {
      check_mesh(mesh, numbers);
      return "";
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
  };
  const TriangleMesh good = square_grid(2, 1);  // 6 nodes, triangles (0 1 4) (0 4 3) (1 2 5) (1 5 4)
  EXPECT_EQ(message(good), "");
  EXPECT_EQ(message(TriangleMesh{Points::Zero(0, 3), {}}), "mesh has no triangles");
  const auto changed = [&](auto&& change) {
    TriangleMesh mesh = good;
    change(mesh);
    return message(mesh);
  };
  EXPECT_EQ(changed([](auto& m) { m.triangles[1][2] = 6; }), "triangle 1 names node 6, which does not exist");
  EXPECT_EQ(changed([](auto& m) { m.triangles[1][2] = -1; }), "triangle 1 names node -1, which does not exist");
  EXPECT_EQ(changed([](auto& m) { m.triangles[2][2] = 1; }), "triangle 2 names node 1 twice");
  EXPECT_EQ(changed([](auto& m) { m.triangles.resize(2); }), "node 2 belongs to no triangle");
  EXPECT_EQ(changed([](auto& m) { m.nodes(4, 2) = std::numeric_limits<double>::infinity(); }),
            "node 4 has a coordinate that is not finite");
  EXPECT_EQ(changed([](auto& m) { m.nodes.row(2) = 2.5 * m.nodes.row(5) - 1.5 * m.nodes.row(1); }),
            "triangle 2 has zero area: its nodes lie in a line");
  EXPECT_EQ(changed([](auto& m) { m.nodes *= 1e200; }), "the area of triangle 0 is beyond the range of numbers");
  EXPECT_EQ(changed([](auto& m) { m.nodes *= 1e-110; }), "the area of triangle 0 is beyond the range of numbers");
  EXPECT_EQ(changed([](auto& m) {
              m.triangles.push_back({4, 1, 0});
            }),
            "triangle 0 and triangle 4 have the same three nodes");
  EXPECT_EQ(changed([](auto& m) {
              m.triangles.push_back({0, 5, 4});
            }),
            "triangle 0, triangle 1 and triangle 4 share their edge (0, 4): at most two triangles can meet at "
            "an edge");
  EXPECT_EQ(changed([](auto& m) { std::swap(m.triangles[1][0], m.triangles[1][1]); }),
            "triangle 0 and triangle 1 run along their common edge (0, 4) in the same direction: one of them is "
            "turned over");
  TriangleMesh turned = good;
  std::swap(turned.triangles[1][0], turned.triangles[1][1]);
  EXPECT_EQ(message(turned, {.node = {10, 20, 30, 40, 50, 60}, .triangle = {7, 8, 9, 10}}),
            "triangle 7 and triangle 8 run along their common edge (10, 50) in the same direction: one of them "
            "is turned over");
}

TEST(LumpedMassOfAShell, SumsToTheMassOfTheSheet) {
  const TriangleMesh mesh = perturbed(equilateral_grid(4, 3), 0.02, 3);
  double area = 0, mass = 0;
  const Vector density = Vector::LinSpaced(mesh.num_triangles(), 500, 3000);
  const Vector thickness = Vector::LinSpaced(mesh.num_triangles(), 0.001, 0.02);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    area += triangle_area(mesh, t);
    mass += density[t] * thickness[t] * triangle_area(mesh, t);
  }
  const double rounding = 1e-13;
  EXPECT_NEAR(lumped_mass(mesh, 1200.0, 0.01).sum(), 12 * area, rounding * 12 * area);
  EXPECT_NEAR(lumped_mass(mesh, density, thickness).sum(), mass, rounding * mass);
  EXPECT_TRUE(is_near(lumped_mass(square_grid(1, 1, 2.0), 3.0, 0.5), Vector{{2, 1, 1, 2}}, rounding));
  EXPECT_THROW((void)lumped_mass(mesh, 0.0, 0.1), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass(mesh, 1.0, -0.1), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass(mesh, Vector::Ones(3), Vector::Ones(1)), std::invalid_argument);
  EXPECT_THROW((void)lumped_mass(mesh, Vector::Ones(1), Vector::Ones(3)), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
