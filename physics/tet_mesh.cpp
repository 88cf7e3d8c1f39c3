#include <physics/tet_mesh.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <numeric>

namespace supple {

double tet_volume(const TetMesh& mesh, Index e) {
  const Tet& tet = mesh.tets[e];
  const Point a = mesh.nodes.row(tet[0]);
  const Point ab = mesh.nodes.row(tet[1]).transpose() - a;
  const Point ac = mesh.nodes.row(tet[2]).transpose() - a;
  const Point ad = mesh.nodes.row(tet[3]).transpose() - a;
  return ab.cross(ac).dot(ad) / 6;
}

BoundingBox bounding_box(const Points& nodes) {
  return {nodes.colwise().minCoeff().transpose(), nodes.colwise().maxCoeff().transpose()};
}

std::vector<Triangle> boundary_faces(const TetMesh& mesh) {
  // Corner triples opposite to each corner, outward for a positively oriented tet.
  static constexpr std::array<std::array<int, 3>, 4> faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  struct Face {
    Triangle sorted;
    Index id;
  };
  std::vector<Face> all;
  all.reserve(4 * mesh.tets.size());
  const auto corners = [&](Index id) {
    const Tet& tet = mesh.tets[id / 4];
    const auto& f = faces[id % 4];
    return Triangle{tet[f[0]], tet[f[1]], tet[f[2]]};
  };
  for (Index id = 0; id < 4 * mesh.num_tets(); ++id) {
    Triangle sorted = corners(id);
    std::sort(sorted.begin(), sorted.end());
    all.push_back({sorted, id});
  }
  std::sort(all.begin(), all.end(), [](const Face& a, const Face& b) {
    return a.sorted != b.sorted ? a.sorted < b.sorted : a.id < b.id;
  });
  std::vector<Index> once;
  for (std::size_t k = 0; k < all.size();) {
    std::size_t end = k + 1;
    while (end < all.size() && all[end].sorted == all[k].sorted) ++end;
    if (end == k + 1) once.push_back(all[k].id);
    k = end;
  }
  std::sort(once.begin(), once.end());
  std::vector<Triangle> result;
  result.reserve(once.size());
  for (const Index id : once) result.push_back(corners(id));
  return result;
}

NodeComponents connected_components(const TetMesh& mesh) {
  std::vector<Index> parent(mesh.num_nodes());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const Tet& tet : mesh.tets)
    for (int a = 1; a < 4; ++a) {
      const Index r = root(tet[0]), s = root(tet[a]);
      parent[std::max(r, s)] = std::min(r, s);
    }
  NodeComponents components;
  components.of_node.assign(mesh.num_nodes(), -1);
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    const Index r = root(v);  // the smallest node of its component, so numbered before v
    components.of_node[v] = r == v ? components.count++ : components.of_node[r];
  }
  return components;
}

}  // namespace supple
