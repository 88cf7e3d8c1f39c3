#include <physics/body/surface_shares.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

namespace supple {

namespace {

/// A point of a rule on a reference face: its weight, N and ∂N/∂ξ of the nodes.
template <int n>
struct FacePoint {
  double weight;
  Eigen::Matrix<double, n, 1> N;
  Eigen::Matrix<double, n, 2> dN;
};

/// Faces of three nodes: ξ, η and 1 − ξ − η; one point is exact.
std::vector<FacePoint<3>> rule(std::integral_constant<int, 3>) {
  FacePoint<3> middle{0.5, Eigen::Vector3d::Constant(1.0 / 3), {}};
  middle.dN << -1, -1, 1, 0, 0, 1;
  return {middle};
}

/// Faces of four: bilinear, 2 × 2 Gauss points.
std::vector<FacePoint<4>> rule(std::integral_constant<int, 4>) {
  const double near = 0.5 - 0.5 / std::sqrt(3.0);
  std::vector<FacePoint<4>> points;
  for (const double x : {near, 1 - near})
    for (const double y : {near, 1 - near}) {
      FacePoint<4> point{0.25, {}, {}};
      point.N << (1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y;
      point.dN << y - 1, x - 1, 1 - y, -x, y, x, -y, 1 - x;
      points.push_back(point);
    }
  return points;
}

/// Faces of six: corners, then the nodes amid their sides; the six points of degree 4, exact for N n of curved faces.
/// \see Dunavant 1985.
std::vector<FacePoint<6>> rule(std::integral_constant<int, 6>) {
  std::vector<FacePoint<6>> points;
  for (const auto& [at, weight] :
       {std::pair{0.445948490915965, 0.223381589678011}, std::pair{0.091576213509771, 0.109951743655322}})
    for (int corner = 0; corner < 3; ++corner) {
      std::array<double, 3> L{at, at, at};
      L[static_cast<std::size_t>(corner)] = 1 - 2 * at;
      const std::array<std::array<double, 2>, 3> dL{{{-1, -1}, {1, 0}, {0, 1}}};
      FacePoint<6> point{weight / 2, {}, {}};
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t b = (a + 1) % 3;
        const Index row = static_cast<Index>(a);
        point.N[row] = L[a] * (2 * L[a] - 1);
        point.N[3 + row] = 4 * L[a] * L[b];
        for (std::size_t j = 0; j < 2; ++j) {
          point.dN(row, static_cast<Index>(j)) = (4 * L[a] - 1) * dL[a][j];
          point.dN(3 + row, static_cast<Index>(j)) = 4 * (L[a] * dL[b][j] + L[b] * dL[a][j]);
        }
      }
      points.push_back(point);
    }
  return points;
}

class Shares {
 public:
  explicit Shares(const Points& nodes) : nodes_(nodes) {}

  template <std::size_t n>
  void add(const std::array<Index, n>& face) {
    static const auto points = rule(std::integral_constant<int, static_cast<int>(n)>{});
    Eigen::Matrix<double, 3, static_cast<int>(n)> X;
    for (std::size_t a = 0; a < n; ++a) X.col(static_cast<Index>(a)) = nodes_.row(face[a]).transpose();
    for (const auto& point : points) {
      const Eigen::Matrix<double, 3, 2> tangents = X * point.dN;
      const Point normal = point.weight * tangents.col(0).cross(tangents.col(1));
      for (std::size_t a = 0; a < n; ++a) {
        SurfaceShare& share = shares_[face[a]];
        share.area += point.N[static_cast<Index>(a)] * normal.norm();
        share.normal += point.N[static_cast<Index>(a)] * normal;
      }
    }
  }

  std::vector<SurfaceShare> all() const {
    std::vector<SurfaceShare> result;
    for (auto [node, share] : shares_) {
      share.node = node;
      result.push_back(share);
    }
    return result;
  }

 private:
  const Points& nodes_;
  std::map<Index, SurfaceShare> shares_;
};

/// Whether faces are of a part.
class IsIn {
 public:
  IsIn(const NodeGroup& part, Index num_nodes) : part_(part), is_node_(static_cast<std::size_t>(num_nodes), false) {
    for (const Index v : part.nodes) is_node_[static_cast<std::size_t>(v)] = true;
  }
  /// \param face  all of its nodes, corners first.
  template <std::size_t n>
  bool operator()(const std::array<Index, n>& face) const {
    if (part_.faces.empty())
      return std::ranges::all_of(face, [&](Index v) { return is_node_[static_cast<std::size_t>(v)]; });
    constexpr std::size_t num_corners = n == 4 ? 4 : 3;
    return std::ranges::binary_search(part_.faces, face_corners(std::span(face).template first<num_corners>()));
  }

 private:
  const NodeGroup& part_;
  std::vector<char> is_node_;
};

/// Calls visit(face, triangles) for each face of a part, with its nodes and what it is cut into.
template <typename Visit>
void visit_faces(const Body& body, const NodeGroup& part, const Visit& visit) {
  const IsIn is_in(part, num_nodes(body));
  const auto take = [&](const auto& face, std::span<const Triangle> cut) {
    if (is_in(face)) visit(face, cut);
  };
  if (const Shell* shell = std::get_if<Shell>(&body)) {
    for (const Triangle& triangle : shell->mesh.triangles) take(triangle, std::span(&triangle, 1));
    return;
  }
  visit_solid(
      body, [&]<typename Mesh>(const SolidOf<Mesh>& solid) {  // faces, from the triangles that they are cut into
        const std::vector<Triangle> cut = boundary_faces(solid.mesh);
        for (std::size_t k = 0; k < cut.size(); k += triangles_per_face<Mesh>) {
          const std::span<const Triangle> of_face(&cut[k], triangles_per_face<Mesh>);
          if constexpr (Mesh::nodes_per_cell == 4)
            take(of_face[0], of_face);
          else if constexpr (Mesh::nodes_per_cell == 8)
            take(std::array{of_face[0][0], of_face[0][1], of_face[0][2], of_face[1][2]}, of_face);
          else
            take(std::array{of_face[0][0], of_face[1][1], of_face[2][2], of_face[0][1], of_face[1][2], of_face[0][2]},
                 of_face);
        }
      });
}

}  // namespace

std::vector<SurfaceShare> surface_shares(const Body& body, const NodeGroup& part) {
  Shares shares(node_positions(body));
  visit_faces(body, part, [&](const auto& face, std::span<const Triangle>) { shares.add(face); });
  return shares.all();
}

std::vector<Triangle> surface_triangles(const Body& body, const NodeGroup& part) {
  std::vector<Triangle> triangles;
  visit_faces(body, part, [&](const auto&, std::span<const Triangle> cut) {
    triangles.insert(triangles.end(), cut.begin(), cut.end());
  });
  return triangles;
}

}  // namespace supple
