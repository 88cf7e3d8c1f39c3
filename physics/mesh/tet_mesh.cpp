#include <core/check.hpp>
#include <physics/mesh/tet_mesh.hpp>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace supple {

namespace {

struct TetEdges {
  Point ab, ac, ad;
  TetEdges(const Points& nodes, const Tet& tet) {
    const Point a = nodes.row(tet[0]);
    ab = nodes.row(tet[1]).transpose() - a;
    ac = nodes.row(tet[2]).transpose() - a;
    ad = nodes.row(tet[3]).transpose() - a;
  }
  TetEdges(const TetMesh& mesh, Index e) : TetEdges(mesh.nodes, mesh.cells[e]) {}
};

}  // namespace

double tet_volume(const TetMesh& mesh, Index e) {
  const TetEdges tet(mesh, e);
  return tet.ab.cross(tet.ac).dot(tet.ad) / 6;
}

TetShape tet_shape(const TetMesh& mesh, Index e) {
  for (const Index v : mesh.cells[e])
    if (v < 0 || v >= mesh.num_nodes())
      throw std::invalid_argument("tet " + std::to_string(e) + " names node " + std::to_string(v) + ", expected 0 to " +
                                  std::to_string(mesh.num_nodes() - 1));
  const TetEdges tet(mesh, e);
  Matrix3<double> edges;
  edges << tet.ab, tet.ac, tet.ad;
  const double volume = edges.determinant() / 6;
  require(volume > 0, "tet " + std::to_string(e) + " has volume " + std::to_string(volume) + " m^3, expected > 0");
  return {edges.inverse(), volume};
}

int tet_orientation(const TetMesh& mesh, Index e) {
  const TetEdges tet(mesh, e);
  const double det = tet.ab.cross(tet.ac).dot(tet.ad);
  const Point b = tet.ab.cwiseAbs(), c = tet.ac.cwiseAbs(), d = tet.ad.cwiseAbs();
  const double permanent =
      (b[1] * c[2] + b[2] * c[1]) * d[0] + (b[2] * c[0] + b[0] * c[2]) * d[1] + (b[0] * c[1] + b[1] * c[0]) * d[2];
  const double rounding = 4 * std::numeric_limits<double>::epsilon() * permanent;  // Shewchuk's (7 + 56 ε) ε, ε = 2⁻⁵³
  return det > rounding ? 1 : det < -rounding ? -1 : 0;
}

double radius_ratio(const TetMesh& mesh, Index e) {
  return radius_ratio(mesh.nodes, mesh.cells[e]);
}

double radius_ratio(const Points& nodes, const Tet& corners) {
  const TetEdges tet(nodes, corners);
  const Point bc = tet.ab.cross(tet.ac), cd = tet.ac.cross(tet.ad), db = tet.ad.cross(tet.ab);
  const double det = std::abs(bc.dot(tet.ad));  // 6 V
  if (!(det > 0)) return 0;
  const double area = (bc.norm() + cd.norm() + db.norm() + (tet.ac - tet.ab).cross(tet.ad - tet.ab).norm()) / 2;
  const double inradius = det / (2 * area);
  const double circumradius =
      (tet.ad.squaredNorm() * bc + tet.ab.squaredNorm() * cd + tet.ac.squaredNorm() * db).norm() / (2 * det);
  return 3 * inradius / circumradius;
}

}  // namespace supple
