#include <app/report/exit_guard.hpp>
#include <app/scene/surface.hpp>

#include <cmath>

namespace supple {

namespace {

std::vector<Triangle> visible_triangles(const Body& body) {
  if (const Shell* shell = std::get_if<Shell>(&body)) return shell->mesh.triangles;
  return visit_solid(body, [](const auto& solid) { return boundary_faces(solid.mesh); });
}

/// The end of a scale that holds all scalars of the objects: their largest, rounded up to two digits.
double scale_end(const std::vector<PictureObject>& objects) {
  double largest = 0;
  for (const PictureObject& object : objects)
    if (object.scalar.size() > 0) largest = std::max(largest, object.scalar.maxCoeff());
  if (!(largest > 0)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(largest)) - 1);
  return std::ceil(largest / unit * (1 - 1e-12)) * unit;
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

void write_picture(const std::filesystem::path& path, const std::vector<PictureObject>& objects,
                   PictureOptions options) {
  const Image image = draw_picture(objects, options);
  const ExitGuard guard(path);
  write_png(path, image);
}

void write_coloured_picture(const std::filesystem::path& path, const std::vector<PictureObject>& objects,
                            const std::string& label, int width, int height) {
  PictureOptions options;
  options.width = width;
  options.height = height;
  options.scale.label = label;
  options.scale.low = 0.0;
  options.scale.high = scale_end(objects);
  write_picture(path, objects, options);
}

}  // namespace supple
