#include <core/check.hpp>
#include <io/builtin/builtin_surfaces.hpp>
#include <physics/mesh/tet_mesh.hpp>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace supple::test {
namespace {

using testing::HasSubstr;

double area(const TriangleMesh& mesh) {
  double sum = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t) sum += triangle_area(mesh, t);
  return sum;
}
double least_radius_ratio(const TriangleMesh& mesh) {
  double least = 1;
  for (Index t = 0; t < mesh.num_triangles(); ++t) least = std::min(least, radius_ratio(mesh, t));
  return least;
}
Point normal(const TriangleMesh& mesh, Index t) {
  const auto at = [&](int k) { return Point(mesh.nodes.row(mesh.triangles[t][k])); };
  return (at(1) - at(0)).cross(at(2) - at(0)).normalized();
}
void expect_one_surface(const TriangleMesh& mesh) {
  EXPECT_NO_THROW(check_mesh(mesh));
  EXPECT_EQ(connected_components(mesh).count, 1);
  EXPECT_EQ(surface_hinges(mesh.triangles, mesh.num_nodes()).nodes, 0);
}

TEST(BuiltinSurface, PlateIsARectangleOfEquilateralTrianglesButForItsTwoEnds) {
  for (const auto& [nx, ny] : {std::pair<Index, Index>{8, 5}, {1, 1}, {3, 12}, {40, 2}}) {
    SCOPED_TRACE(std::to_string(nx) + "x" + std::to_string(ny));
    const TriangleMesh mesh = builtin_surface("plate:" + std::to_string(nx) + "x" + std::to_string(ny));
    expect_one_surface(mesh);
    EXPECT_EQ(mesh.num_triangles(), (2 * nx + 1) * ny);
    EXPECT_EQ(mesh.num_nodes(), (nx + 1) * (ny + 1) + (ny + 1) / 2);
    const BoundingBox box = bounding_box(mesh.nodes);
    const double width = std::sqrt(0.75) * static_cast<double>(ny), length = static_cast<double>(nx);
    const double edge = 1 / std::max(width, length);
    EXPECT_EQ(box.lower, Point(0, 0, 0));
    EXPECT_NEAR((box.upper - Point(edge * length, 0, edge * width)).norm(), 0, 1e-15);
    EXPECT_NEAR(area(mesh), edge * length * edge * width, 1e-13);
    EXPECT_NEAR(box.extent().maxCoeff(), 1, 1e-15);
    Index num_equilateral = 0;
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      EXPECT_NEAR((normal(mesh, t) - Point::UnitY()).norm(), 0, 1e-15);
      num_equilateral += radius_ratio(mesh, t) > 1 - 1e-12;
    }
    EXPECT_EQ(num_equilateral, (2 * nx - 1) * ny);
    EXPECT_EQ(static_cast<Index>(boundary_edges(mesh).size()), 2 * nx + ny % 2 + 2 * ny);
  }
}

TEST(BuiltinSurface, CylinderIsAnOpenTubeOfEquilateralTriangles) {
  for (const auto& [n, m] : {std::pair<Index, Index>{24, 10}, {3, 1}, {5, 4}}) {
    SCOPED_TRACE(std::to_string(n) + "x" + std::to_string(m));
    const TriangleMesh mesh = builtin_surface("cylinder:" + std::to_string(n) + "x" + std::to_string(m));
    expect_one_surface(mesh);
    EXPECT_EQ(mesh.num_triangles(), 2 * n * m);
    EXPECT_EQ(mesh.num_nodes(), n * (m + 1));
    EXPECT_EQ(static_cast<Index>(boundary_edges(mesh).size()), 2 * n);
    EXPECT_GT(least_radius_ratio(mesh), 1 - 1e-12);
    EXPECT_EQ(bounding_box(mesh.nodes).lower[1], 0);
    for (Index v = 0; v < mesh.num_nodes(); ++v)
      EXPECT_NEAR(std::hypot(mesh.nodes(v, 0), mesh.nodes(v, 2)), 0.5, 1e-15);
    for (Index t = 0; t < mesh.num_triangles(); ++t) {
      const Point centre = (mesh.nodes.row(mesh.triangles[t][0]) + mesh.nodes.row(mesh.triangles[t][1]) +
                            mesh.nodes.row(mesh.triangles[t][2])) /
                           3;
      EXPECT_GT(normal(mesh, t).dot(Point(centre[0], 0, centre[2])), 0) << "outward";
    }
  }
}

TEST(BuiltinSurface, SphereIsAClosedSurfaceWhoseAreaConverges) {
  double error = 0;
  for (const Index n : {1, 2, 3, 8, 16}) {
    SCOPED_TRACE(n);
    const TriangleMesh mesh = builtin_surface("sphere:" + std::to_string(n));
    expect_one_surface(mesh);
    EXPECT_EQ(mesh.num_triangles(), 20 * n * n);
    EXPECT_EQ(mesh.num_nodes(), 10 * n * n + 2);
    EXPECT_TRUE(boundary_edges(mesh).empty());
    EXPECT_GT(least_radius_ratio(mesh), 0.85);
    for (Index v = 0; v < mesh.num_nodes(); ++v) EXPECT_NEAR(mesh.nodes.row(v).norm(), 0.5, 1e-15);
    EXPECT_GT(normal(mesh, 0).dot(Point(mesh.nodes.row(mesh.triangles[0][0]))), 0) << "outward";
    const double last = error;
    error = std::numbers::pi - area(mesh);
    if (n == 16) {
      EXPECT_NEAR(last / error, 4, 0.1);  // second order, from 8 to 16
    }
  }
}

TEST(BuiltinSurface, IsKnownByItsName) {
  for (const char* spec : {"plate:1x1", "cylinder:9x9", "sphere:3", "plate", "sphere:wrong"})
    EXPECT_TRUE(is_builtin_surface(spec)) << spec;
  for (const char* spec : {"", "bar:1x1x1", "plate.off", "spheres", ":2"})
    EXPECT_FALSE(is_builtin_surface(spec)) << spec;
}

TEST(BuiltinSurface, RefusesWhatItCannotMakeAndSaysWhatItExpects) {
  const auto refusal = [](const char* spec) -> std::string {
    try {
      builtin_surface(spec);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  };
  for (const char* spec : {"plate", "plate:", "plate:4", "plate:4x0", "plate:4x4x4", "plate:4,4"})
    EXPECT_THAT(refusal(spec), HasSubstr(std::string(spec) + ": expected plate:NXxNY"));
  EXPECT_THAT(refusal("cylinder:2x9"), HasSubstr("N ≥ 3"));
  EXPECT_THAT(refusal("sphere:0"), HasSubstr("N ≥ 1"));
  for (const char* spec :
       {"plate:99999999x99999999", "plate:1x999999999", "cylinder:9999x9999", "sphere:4611686018427387904"})
    EXPECT_THAT(refusal(spec), HasSubstr("30 million")) << spec;
  EXPECT_THAT(refusal("bar:1x1x1"), HasSubstr("cylinder:NxM"));
}

}  // namespace
}  // namespace supple::test
