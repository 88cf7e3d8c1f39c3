#include <app/exit_guard.hpp>
#include <app/surface.hpp>

namespace supple {

Surface::Surface(const TetMesh& mesh) : triangles(boundary_faces(mesh)) {
  std::vector<Index> number(mesh.num_nodes(), -1);
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
  const ExitGuard guard;
  write_png(path, image);
}

}  // namespace supple
