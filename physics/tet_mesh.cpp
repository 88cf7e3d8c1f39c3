#include <core/check.hpp>
#include <physics/equal_keys.hpp>
#include <physics/tet_mesh.hpp>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <limits>

namespace supple {

namespace {

/// Corner triples opposite to each corner, outward for a positively oriented tet.
constexpr std::array<std::array<int, 3>, 4> tet_faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// Face 4 e + a is the one of tet e opposite to its corner a.
Triangle face_nodes(const TetMesh& mesh, Index face) {
  const Tet& tet = mesh.tets[face / 4];
  const auto& corner = tet_faces[face % 4];
  return {tet[corner[0]], tet[corner[1]], tet[corner[2]]};
}

/// Whether an odd number of swaps sorts the triangle: differs between the two sides of a face.
bool is_odd(const Triangle& t) {
  return ((t[0] > t[1]) + (t[0] > t[2]) + (t[1] > t[2])) % 2 == 1;
}

template <typename Visit>
void visit_faces(const TetMesh& mesh, const Visit& visit) {
  std::vector<Triangle> keys(4 * mesh.tets.size());
  for (Index face = 0; face < 4 * mesh.num_tets(); ++face) {
    keys[face] = face_nodes(mesh, face);
    std::sort(keys[face].begin(), keys[face].end());
  }
  visit_equal(keys, mesh.num_nodes(), visit);
}

struct EdgeVectors {
  Point ab, ac, ad;
  EdgeVectors(const Points& nodes, const Tet& tet) {
    const Point a = nodes.row(tet[0]);
    ab = nodes.row(tet[1]).transpose() - a;
    ac = nodes.row(tet[2]).transpose() - a;
    ad = nodes.row(tet[3]).transpose() - a;
  }
  EdgeVectors(const TetMesh& mesh, Index e) : EdgeVectors(mesh.nodes, mesh.tets[e]) {}
};

}  // namespace

double tet_volume(const TetMesh& mesh, Index e) {
  const EdgeVectors tet(mesh, e);
  return tet.ab.cross(tet.ac).dot(tet.ad) / 6;
}

TetShape tet_shape(const TetMesh& mesh, Index e) {
  for (const Index v : mesh.tets[e])
    if (v < 0 || v >= mesh.num_nodes())
      throw std::invalid_argument("tet " + std::to_string(e) + " names node " + std::to_string(v) +
                                  ", expected 0 to " + std::to_string(mesh.num_nodes() - 1));
  const EdgeVectors tet(mesh, e);
  Matrix3<double> edges;
  edges << tet.ab, tet.ac, tet.ad;
  const double volume = edges.determinant() / 6;
  require(volume > 0, "tet " + std::to_string(e) + " has volume " + std::to_string(volume) + " m^3, expected > 0");
  return {edges.inverse(), volume};
}

int tet_orientation(const TetMesh& mesh, Index e) {
  const EdgeVectors tet(mesh, e);
  const double det = tet.ab.cross(tet.ac).dot(tet.ad);
  const Point b = tet.ab.cwiseAbs(), c = tet.ac.cwiseAbs(), d = tet.ad.cwiseAbs();
  const double permanent = (b[1] * c[2] + b[2] * c[1]) * d[0] + (b[2] * c[0] + b[0] * c[2]) * d[1] +
                           (b[0] * c[1] + b[1] * c[0]) * d[2];
  const double rounding =
      4 * std::numeric_limits<double>::epsilon() * permanent;  // Shewchuk's (7 + 56 ε) ε, ε = 2⁻⁵³
  return det > rounding ? 1 : det < -rounding ? -1 : 0;
}

double radius_ratio(const TetMesh& mesh, Index e) {
  return radius_ratio(mesh.nodes, mesh.tets[e]);
}

double radius_ratio(const Points& nodes, const Tet& corners) {
  const EdgeVectors tet(nodes, corners);
  const Point bc = tet.ab.cross(tet.ac), cd = tet.ac.cross(tet.ad), db = tet.ad.cross(tet.ab);
  const double det = std::abs(bc.dot(tet.ad));  // 6 V
  if (!(det > 0)) return 0;
  const double area =
      (bc.norm() + cd.norm() + db.norm() + (tet.ac - tet.ab).cross(tet.ad - tet.ab).norm()) / 2;
  const double inradius = det / (2 * area);
  const double circumradius =
      (tet.ad.squaredNorm() * bc + tet.ab.squaredNorm() * cd + tet.ac.squaredNorm() * db).norm() / (2 * det);
  return 3 * inradius / circumradius;
}

void check_mesh(const TetMesh& mesh, const MeshNumbers& numbers) {
  const auto name = [](const std::vector<std::int64_t>& number, Index k) {
    return std::to_string(number.empty() ? k : number[k]);
  };
  const auto tet_name = [&](Index e) { return "tet " + name(numbers.cell, e); };
  const auto node_name = [&](Index v) { return "node " + name(numbers.node, v); };

  require(mesh.num_tets() > 0, "mesh has no tets");
  if (!mesh.region.empty())
    require_size("mesh.region", static_cast<Index>(mesh.region.size()), mesh.num_tets());
  std::vector<char> used(mesh.num_nodes(), false);
  for (Index e = 0; e < mesh.num_tets(); ++e) {
    const Tet& tet = mesh.tets[e];
    for (int a = 0; a < 4; ++a) {
      const Index v = tet[a];
      if (v < 0 || v >= mesh.num_nodes())
        throw std::invalid_argument(tet_name(e) + " names node " + std::to_string(v) +
                                    ", which does not exist");
      if (std::find(tet.begin(), tet.begin() + a, v) != tet.begin() + a)
        throw std::invalid_argument(tet_name(e) + " names " + node_name(v) + " twice");
      used[v] = true;
    }
  }
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    if (!used[v]) throw std::invalid_argument(node_name(v) + " belongs to no tet");
    if (!mesh.nodes.row(v).allFinite())
      throw std::invalid_argument(node_name(v) + " has a coordinate that is not finite");
  }
  for (Index e = 0; e < mesh.num_tets(); ++e) {
    const int orientation = tet_orientation(mesh, e);
    const double volume = tet_volume(mesh, e);
    if (!std::isfinite(volume) || (orientation == 1 && !(volume > 0)))
      throw std::invalid_argument("the volume of " + tet_name(e) + " is beyond the range of numbers");
    if (orientation == 0)
      throw std::invalid_argument(tet_name(e) + " has zero volume: its nodes lie in a plane");
    if (orientation < 0) throw std::invalid_argument(tet_name(e) + " is reversed: its volume is negative");
  }
  visit_faces(mesh, [&](std::span<const Index> faces) {
    if (faces.size() == 1) return;
    const Triangle t = face_nodes(mesh, faces[0]), s = face_nodes(mesh, faces[1]);
    if (faces.size() == 2 && is_odd(t) != is_odd(s)) return;
    const auto apex = [&](Index k) { return mesh.tets[faces[k] / 4][faces[k] % 4]; };
    const std::string face = "face (" + name(numbers.node, t[0]) + ", " + name(numbers.node, t[1]) + ", " +
                             name(numbers.node, t[2]) + ")";
    const std::string pair = tet_name(faces[0] / 4) + " and " + tet_name(faces[1] / 4);
    if (apex(0) == apex(1)) throw std::invalid_argument(pair + " have the same four nodes");
    if (is_odd(t) == is_odd(s))
      throw std::invalid_argument(pair + " overlap: they lie on the same side of their common " + face +
                                  ", so the mesh is tangled");
    throw std::invalid_argument(pair + " share their " + face + " with " + tet_name(faces[2] / 4) +
                                ": at most two tets can meet at a face");
  });
}

BoundingBox bounding_box(const Points& nodes) {
  return {nodes.colwise().minCoeff().transpose(), nodes.colwise().maxCoeff().transpose()};
}

std::vector<Triangle> boundary_faces(const TetMesh& mesh) {
  std::vector<char> outside(4 * mesh.tets.size(), false);
  visit_faces(mesh, [&](std::span<const Index> faces) { outside[faces[0]] = faces.size() == 1; });
  std::vector<Triangle> result;
  for (Index face = 0; face < 4 * mesh.num_tets(); ++face)
    if (outside[face]) result.push_back(face_nodes(mesh, face));
  return result;
}

Hinges boundary_hinges(const TetMesh& mesh) {
  return surface_hinges(boundary_faces(mesh), mesh.num_nodes());
}

NodeComponents connected_components(const TetMesh& mesh) {
  static_assert(sizeof(Tet) == 4 * sizeof(Index));
  return connected_components({mesh.tets.empty() ? nullptr : mesh.tets.front().data(), 4 * mesh.tets.size()},
                              4, mesh.num_nodes());
}

}  // namespace supple
