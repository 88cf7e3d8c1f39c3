#include <core/parallel.hpp>
#include <io/picture/studio/scene.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace supple::studio {

namespace {

constexpr float sharp_edge = 0.643f;  // cos 50°

/// Normals of the corners: the mean of the faces around the vertex that meet this face at no sharp edge.
void set_normals(Scene& scene) {
  const auto area_vector = [&](const Face& face) -> Vector3f {
    const auto& [a, b, c] = face.vertices;
    return (scene.vertices[b] - scene.vertices[a]).cross(scene.vertices[c] - scene.vertices[a]);
  };
  std::vector<std::uint32_t> first(scene.vertices.size() + 1, 0), around(3 * scene.faces.size());
  for (const Face& face : scene.faces)
    for (const std::uint32_t v : face.vertices) ++first[v + 1];
  for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::uint32_t f = 0; f < scene.faces.size(); ++f)
    for (const std::uint32_t v : scene.faces[f].vertices) around[next[v]++] = f;

  parallel_ranges(static_cast<Index>(scene.faces.size()), 1024, [&](Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      Face& face = scene.faces[f];
      const Vector3f own = area_vector(face);
      for (std::size_t corner = 0; corner < 3; ++corner) {
        Vector3f sum = Vector3f::Zero();
        const std::uint32_t v = face.vertices[corner];
        for (std::uint32_t k = first[v]; k < first[v + 1]; ++k) {
          const Vector3f other = area_vector(scene.faces[around[k]]);
          if (other.dot(own) >= sharp_edge * other.norm() * own.norm()) sum += other;
        }
        face.normals[corner] = sum.stableNormalized();
      }
    }
  });
}

/// Colours of scalars, in steps.
class ScalarColours {
 public:
  ScalarColours(ColourMap map, const View& view)
      : low_(view.scalar_low), range_(std::max(view.scalar_high - view.scalar_low, 1e-300)) {
    for (std::size_t k = 0; k < steps_.size(); ++k)
      steps_[k] = to_linear(map_colour(map, static_cast<double>(k) / last_step));
    not_a_number_ = to_linear(map_colour(map, std::nan("")));
  }

  const Vector3f& operator()(double value) const {
    const double share = (value - low_) / range_;
    return std::isnan(share) ? not_a_number_ : steps_[std::lround(last_step * std::clamp(share, 0.0, 1.0))];
  }

 private:
  static constexpr int last_step = 255;
  double low_, range_;
  std::array<Vector3f, last_step + 1> steps_;
  Vector3f not_a_number_;
};

void add_vertices(const PictureObject& object, const Point& shift, const ScalarColours& colours, Scene& scene) {
  const Vector3f colour = to_linear(object.colour);
  for (Index v = 0; v < object.positions.rows(); ++v) {
    scene.vertices.push_back((object.positions.row(v).transpose() + shift).cast<float>());
    scene.albedo.push_back(object.scalar.size() == 0 ? colour : colours(object.scalar[v]));
  }
}

bool is_wound_clockwise(const PictureObject& object) {
  double volume = 0;  // six times
  const Point middle = object.positions.rows() > 0 ? Point(object.positions.colwise().mean()) : Point::Zero();
  const auto corner = [&](Index node) -> Point { return object.positions.row(node).transpose() - middle; };
  for (const Triangle& t : object.triangles) volume += corner(t[0]).dot(corner(t[1]).cross(corner(t[2])));
  return volume < 0;
}

/// \param first_vertex  the object's own in the scene.
void add_faces(const PictureObject& object, std::uint32_t first_vertex, Scene& scene) {
  const std::size_t first_face = scene.faces.size();
  const bool clockwise = is_wound_clockwise(object);
  for (const Triangle& triangle : object.triangles) {
    Face& face = scene.faces.emplace_back();
    face.object = static_cast<std::uint32_t>(scene.finishes.size());
    for (std::size_t c = 0; c < 3; ++c) face.vertices[c] = first_vertex + static_cast<std::uint32_t>(triangle[c]);
    if (clockwise) std::swap(face.vertices[1], face.vertices[2]);
  }
  for (const Index triangle : object.highlighted) scene.faces[first_face + triangle].highlighted = true;
  scene.finishes.push_back({to_linear(object.highlight), object.edges});
}

void add_balls(const PictureObject& object, const Point& shift, Scene& scene) {
  const double radius =
      object.marker_radius > 0 ? object.marker_radius : 0.012 * bounding_box(object.positions).diagonal();
  for (const auto& marker : object.markers.rowwise())
    scene.balls.push_back(
        {(marker.transpose() + shift).cast<float>(), static_cast<float>(radius), to_linear(object.highlight)});
}

}  // namespace

Scene build_scene(std::span<const PictureObject> objects, ColourMap map, const View& view) {
  Scene scene;
  const ScalarColours colours(map, view);
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const Point shift = view.offsets[k] - view.centre;
    const auto first_vertex = static_cast<std::uint32_t>(scene.vertices.size());
    add_vertices(objects[k], shift, colours, scene);
    add_faces(objects[k], first_vertex, scene);
    add_balls(objects[k], shift, scene);
  }
  set_normals(scene);
  return scene;
}

}  // namespace supple::studio
