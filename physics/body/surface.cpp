#include <physics/body/surface.hpp>

namespace supple {

namespace {

std::vector<Triangle> visible_triangles(const Body& body) {
  if (const Shell* shell = std::get_if<Shell>(&body)) return shell->mesh.triangles;
  return visit_solid(body, [](const auto& solid) { return boundary_faces(solid.mesh); });
}

}  // namespace

Surface::Surface(const Body& body) : triangles(visible_triangles(body)) {
  std::vector<Index> number(num_nodes(body), -1);
  for (Triangle& triangle : triangles)
    for (Index& v : triangle) {
      if (number[v] < 0) {
        number[v] = static_cast<Index>(nodes.size());
        nodes.push_back(v);
      }
      v = number[v];
    }
}

Points Surface::rows(const Points& all) const {
  return all(nodes, Eigen::all);
}

}  // namespace supple
