#include <core/check.hpp>
#include <core/parallel.hpp>
#include <io/picture/picture.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

namespace supple {

namespace {

using Vector3f = Eigen::Vector3f;

constexpr float infinity = std::numeric_limits<float>::infinity();

/// The next whole number, of any float.
int whole(float x) {
  return static_cast<int>(std::clamp(x, -1e8f, 1e8f));
}

// ——— The studio ———

constexpr unsigned background_top = 0xf7f8fa, background_bottom = 0xe9ecf0, ink = 0x2b3440;
constexpr int num_sky_lights = 128, num_key_lights = 48;
constexpr int sky_map_size = 160, key_map_size = 384;  // texels along each side
constexpr float key_radius = 0.11f;                    // of the lamp, at distance 1: how soft shadows are
constexpr float sharp_edge = 0.643f;                   // cos 50°
const Vector3f key_colour{1.04f, 1.f, 0.94f}, sky_colour{0.94f, 0.98f, 1.04f};
constexpr float key_strength = 0.92f, sky_strength = 0.62f, bounce_strength = 0.22f, rim_strength = 0.22f;
constexpr float gloss = 0.10f, gloss_exponent = 28;
constexpr float hidden_marker = 0.55f;    // opacity of a ball inside the object
constexpr float shadow_strength = 0.78f;  // of the ground

// Parts of the picture that stay free, and sizes on it, as shares of its height.
constexpr double margin = 0.05, caption_margin = 0.105, bar_margin = 0.18, caption_size = 0.0185;

// ——— Checks ———

void check(std::span<const PictureObject> objects, const PictureOptions& options) {
  const auto range = [](const char* name, double value, double low, double high) {
    require(low <= value && value <= high, std::string(name) + " of a picture is " + std::to_string(value) +
                                               ", expected " + std::to_string(low) + " to " + std::to_string(high));
  };
  range("width", options.width, 16, 10000);
  range("height", options.height, 16, 10000);
  range("samples", options.samples, 1, 8);
  range("field of view", options.camera.field_of_view, 0, 120);
  range("elevation", options.camera.elevation, -90, 90);
  range("azimuth", options.camera.azimuth, -1e6, 1e6);
  require(std::abs(options.camera.up.norm() - 1) < 1e-6, "up of a camera is not a unit vector");

  bool any = false;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const PictureObject& object = objects[k];
    const std::string name = "object " + std::to_string(k) + " of a picture";
    const Index n = object.positions.rows();
    any = any || !object.triangles.empty();
    for (const Triangle& triangle : object.triangles)
      for (const Index node : triangle)
        require(0 <= node && node < n,
                name + " has a triangle with node " + std::to_string(node) + " of " + std::to_string(n));
    for (const Index triangle : object.highlighted)
      require(
          0 <= triangle && triangle < static_cast<Index>(object.triangles.size()),
          name + " highlights triangle " + std::to_string(triangle) + " of " + std::to_string(object.triangles.size()));
    if (object.scalar.size() > 0) require_size("scalar of " + name, object.scalar.size(), n);
    require(object.positions.allFinite() && object.reach.allFinite() && object.markers.allFinite(),
            name + " has a position that is not finite");
    require(object.marker_radius >= 0 && std::isfinite(object.marker_radius), name + " has a negative marker radius");
    range("darkness of edges", object.edges, 0, 1);
  }
  require(any, "a picture has no triangle");
}

// ——— The view ———

/// Least and greatest of what the points are along a direction.
struct Extent {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  double length() const { return high - low; }
};

Extent extent_along(const PictureObject& object, const Point& direction) {
  Extent extent;
  for (const Points* points : {&object.positions, &object.reach})
    for (const auto& p : points->rowwise()) extent.include(p.dot(direction));
  return extent;
}

/// The scalars' scale: stated, or fitted; a diverging one that is fitted has zero in the middle.
void fit_scale(std::span<const PictureObject> objects, const ScalarScale& scale, View& view) {
  Extent values;
  for (const PictureObject& object : objects)
    for (const double value : object.scalar)
      if (std::isfinite(value)) values.include(value);
  if (values.length() < 0) values.include(0);
  if (scale.map == ColourMap::Diverging) values.include(-values.low), values.include(-values.high);
  view.scalar_low = scale.low.value_or(values.low);
  view.scalar_high = scale.high.value_or(values.high);
  require(std::isfinite(view.scalar_low) && std::isfinite(view.scalar_high) && view.scalar_low <= view.scalar_high,
          "the scale of a picture's scalars is empty");
}

bool has_bar(std::span<const PictureObject> objects, const ScalarScale& scale) {
  return !scale.label.empty() &&
         std::ranges::any_of(objects, [](const auto& object) { return object.scalar.size() > 0; });
}

}  // namespace

View fit_view(std::span<const PictureObject> objects, const PictureOptions& options) {
  check(objects, options);
  const Camera& camera = options.camera;
  View view;
  view.ground_up = camera.up;
  fit_scale(objects, options.scale, view);

  // Azimuth counts from the axis after the up axis: from z to x if y is up, from x to y if z is up.
  Index up_axis;
  camera.up.cwiseAbs().maxCoeff(&up_axis);
  const Point first = (Point::Unit((up_axis + 1) % 3) - camera.up * camera.up[(up_axis + 1) % 3]).normalized();
  const double azimuth = camera.azimuth * std::numbers::pi / 180, elevation = camera.elevation * std::numbers::pi / 180;
  const Point towards_camera = std::cos(azimuth) * first + std::sin(azimuth) * camera.up.cross(first);
  view.right = camera.up.cross(towards_camera).normalized();
  view.forward = -(std::cos(elevation) * towards_camera + std::sin(elevation) * camera.up).normalized();
  view.up = view.right.cross(view.forward);

  std::vector<Extent> widths;
  for (const PictureObject& object : objects) widths.push_back(extent_along(object, view.right));
  view.offsets.assign(objects.size(), Point::Zero());
  if (options.arrangement == Arrangement::SideBySide && objects.size() > 1) {
    double total = 0, at = 0;
    for (const Extent& width : widths) total += std::max(0.0, width.length());
    const double gap = 0.16 * total / static_cast<double>(objects.size());
    for (std::size_t k = 0; k < objects.size(); ++k) {
      if (widths[k].length() < 0) continue;
      view.offsets[k] = (at - widths[k].low) * view.right;
      at += widths[k].length() + gap;
    }
  }

  Extent ground;
  Eigen::AlignedBox3d box;
  const auto for_each_point = [&](const auto& visit) {
    for (std::size_t k = 0; k < objects.size(); ++k)
      for (const Points* points : {&objects[k].positions, &objects[k].reach})
        for (const auto& p : points->rowwise()) visit(Point(p.transpose() + view.offsets[k]));
  };
  for_each_point([&](const Point& p) {
    box.extend(p);
    ground.include(camera.up.dot(p));
  });
  view.centre = box.center();
  view.ground_height = ground.low;
  double radius = 0;
  for_each_point([&](const Point& p) { radius = std::max(radius, (p - view.centre).norm()); });
  view.radius = std::max(1.02 * radius, 1e-12);

  // The free parts of the picture leave a window; its edges are four planes through the eye (or parallel
  // ones), and the closest eye is where opposite planes touch the points.
  const double W = options.width, H = options.height;
  const bool captions = std::ranges::any_of(objects, [](const auto& object) { return !object.caption.empty(); });
  const double left = W / 2 - margin * H, right = left - (has_bar(objects, options.scale) ? bar_margin * H : 0);
  const double top = H / 2 - margin * H, bottom = H / 2 - (captions ? caption_margin : margin) * H;
  require(left + right > 0, "a picture is too narrow for its colour bar");
  view.perspective = camera.field_of_view > 0;
  double distance = 3 * view.radius;
  Point eye = Point::Zero();  // along right and up
  if (view.perspective) {
    view.pixels = H / 2 / std::tan(camera.field_of_view * std::numbers::pi / 360);
    const double r = right / view.pixels, l = left / view.pixels, t = top / view.pixels, b = bottom / view.pixels;
    double to_r = -1e300, to_l = -1e300, to_t = -1e300, to_b = -1e300, nearest = 1e300;
    for_each_point([&](const Point& p) {
      const Point q = p - view.centre;
      const double x = q.dot(view.right), y = q.dot(view.up), z = q.dot(view.forward);
      to_r = std::max(to_r, x - r * z);
      to_l = std::max(to_l, -x - l * z);
      to_t = std::max(to_t, y - t * z);
      to_b = std::max(to_b, -y - b * z);
      nearest = std::min(nearest, z);
    });
    distance = std::max({(to_r + to_l) / (r + l), (to_t + to_b) / (t + b), 0.05 * view.radius - nearest});
    eye.x() = 0.5 * ((to_r - r * distance) + (l * distance - to_l));
    eye.y() = 0.5 * ((to_t - t * distance) + (b * distance - to_b));
  } else {
    Extent x, y;
    for_each_point([&](const Point& p) {
      x.include((p - view.centre).dot(view.right));
      y.include((p - view.centre).dot(view.up));
    });
    view.pixels = std::min((left + right) / std::max(x.length(), 1e-12), (top + bottom) / std::max(y.length(), 1e-12));
    eye.x() = 0.5 * (x.low + x.high) - 0.5 * (right - left) / view.pixels;
    eye.y() = 0.5 * (y.low + y.high) - 0.5 * (top - bottom) / view.pixels;
  }
  view.eye = view.centre + eye.x() * view.right + eye.y() * view.up - distance * view.forward;

  for (std::size_t k = 0; k < objects.size(); ++k) {
    const Point offset = view.offsets[k] - view.centre;
    const double x = 0.5 * (widths[k].low + widths[k].high) + offset.dot(view.right) - eye.x();
    view.caption_x.push_back(W / 2 + view.pixels * (view.perspective ? x / distance : x));
  }
  return view;
}

namespace {

// ——— What is drawn: all objects in one list, relative to the view's centre ———

struct Face {
  std::array<std::uint32_t, 3> vertices;
  std::array<Vector3f, 3> normals;  // of the corners
  std::uint32_t object = 0;
  bool highlighted = false;
};

struct Ball {
  Vector3f centre;
  float radius;
  Vector3f albedo;
};

struct Scene {
  std::vector<Vector3f> vertices;
  std::vector<Vector3f> albedo;  // of the vertices
  std::vector<Face> faces;
  std::vector<Ball> balls;
};

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

Scene build_scene(std::span<const PictureObject> objects, const PictureOptions& options, const View& view) {
  Scene scene;
  std::array<Vector3f, 257> colours;
  for (std::size_t k = 0; k < 256; ++k)
    colours[k] = to_linear(map_colour(options.scale.map, static_cast<double>(k) / 255));
  colours[256] = to_linear(map_colour(options.scale.map, std::nan("")));
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const PictureObject& object = objects[k];
    const Point shift = view.offsets[k] - view.centre;
    const auto first = static_cast<std::uint32_t>(scene.vertices.size());
    const Vector3f colour = to_linear(object.colour);
    for (Index v = 0; v < object.positions.rows(); ++v) {
      scene.vertices.push_back((object.positions.row(v).transpose() + shift).cast<float>());
      if (object.scalar.size() == 0) {
        scene.albedo.push_back(colour);
      } else {
        const double share =
            (object.scalar[v] - view.scalar_low) / std::max(view.scalar_high - view.scalar_low, 1e-300);
        scene.albedo.push_back(std::isnan(share) ? colours[256]
                                                 : colours[std::lround(255 * std::clamp(share, 0.0, 1.0))]);
      }
    }
    const std::size_t first_face = scene.faces.size();
    double volume = 0;  // six times; negative if the triangles are wound clockwise
    const Point middle = object.positions.rows() > 0 ? Point(object.positions.colwise().mean()) : Point::Zero();
    const auto corner = [&](Index node) -> Point { return object.positions.row(node).transpose() - middle; };
    for (const Triangle& t : object.triangles) volume += corner(t[0]).dot(corner(t[1]).cross(corner(t[2])));
    for (const Triangle& triangle : object.triangles) {
      Face& face = scene.faces.emplace_back();
      face.object = static_cast<std::uint32_t>(k);
      for (std::size_t c = 0; c < 3; ++c) face.vertices[c] = first + static_cast<std::uint32_t>(triangle[c]);
      if (volume < 0) std::swap(face.vertices[1], face.vertices[2]);
    }
    for (const Index triangle : object.highlighted) scene.faces[first_face + triangle].highlighted = true;
    const double radius =
        object.marker_radius > 0 ? object.marker_radius : 0.012 * bounding_box(object.positions).diagonal();
    for (const auto& marker : object.markers.rowwise())
      scene.balls.push_back(
          {(marker.transpose() + shift).cast<float>(), static_cast<float>(radius), to_linear(object.highlight)});
  }
  set_normals(scene);
  return scene;
}

// ——— Light: many far lamps, each with a map of what it meets first ———

/// Points of surfaces with their normals, coordinate by coordinate.
struct Surface {
  std::array<std::vector<float>, 3> x, n;
};

/// A lamp infinitely far away in direction `towards`.
struct Lamp {
  Vector3f towards, across, along;
  float radius;  // of the scene around the origin
  int size;
  std::vector<float> nearest;  // per texel, how far towards the lamp the scene reaches; nothing in the outermost ones

  Lamp(const Vector3f& direction, float scene_radius, int map_size)
      : towards(direction.normalized()),
        across(towards.unitOrthogonal()),
        along(towards.cross(across)),
        radius(scene_radius),
        size(map_size) {}

  float texel() const { return 2 * radius / static_cast<float>(size - 2); }

  Vector3f to_map(const Vector3f& p) const {
    const float scale = 1 / texel(), middle = 0.5f * static_cast<float>(size);
    return {middle + scale * across.dot(p), middle + scale * along.dot(p), towards.dot(p)};
  }

  void look_at(const Scene& scene) {
    nearest.assign(static_cast<std::size_t>(size) * size, -infinity);
    std::vector<Vector3f> vertices(scene.vertices.size());
    std::ranges::transform(scene.vertices, vertices.begin(), [this](const Vector3f& p) { return to_map(p); });
    for (const Face& face : scene.faces) {
      const Vector3f &a = vertices[face.vertices[0]], &b = vertices[face.vertices[1]], &c = vertices[face.vertices[2]];
      const Vector3f low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
      const int x0 = std::max(1, whole(std::ceil(low.x() - 0.5f))),
                x1 = std::min(size - 2, whole(std::floor(high.x() - 0.5f)));
      const int y0 = std::max(1, whole(std::ceil(low.y() - 0.5f))),
                y1 = std::min(size - 2, whole(std::floor(high.y() - 0.5f)));
      if (x0 > x1 || y0 > y1) continue;
      const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
      if (area == 0) continue;
      const float dbx = (c.y() - a.y()) / area,
                  dby = -(c.x() - a.x()) / area;  // slopes of b's and c's coordinates
      const float dcx = -(b.y() - a.y()) / area, dcy = (b.x() - a.x()) / area;
      for (int y = y0; y <= y1; ++y) {
        const float dy = static_cast<float>(y) + 0.5f - a.y();
        float* row = nearest.data() + static_cast<std::size_t>(y) * size;
        for (int x = x0; x <= x1; ++x) {
          const float dx = static_cast<float>(x) + 0.5f - a.x();
          const float beta = dbx * dx + dby * dy, gamma = dcx * dx + dcy * dy;
          if (beta < 0 || gamma < 0 || beta + gamma > 1) continue;
          row[x] = std::max(row[x], a.z() + beta * (b.z() - a.z()) + gamma * (c.z() - a.z()));
        }
      }
    }
  }

  /// Adds weight · cosine · share of light that reaches each point, by the four texels around it.
  void shine_on(const Surface& points, float weight, std::vector<float>& sum) const {
    const float scale = 0.5f * static_cast<float>(size) / radius, middle = 0.5f * static_cast<float>(size) - 0.5f;
    const float off_surface = 1.8f * texel(), tolerance = 0.3f * texel(), last = static_cast<float>(size) - 1.001f;
    const float *px = points.x[0].data(), *py = points.x[1].data(), *pz = points.x[2].data();
    const float *nx = points.n[0].data(), *ny = points.n[1].data(), *nz = points.n[2].data();
    const float *texels = nearest.data(), *above = texels + size;
    float* total = sum.data();
    const int count = static_cast<int>(sum.size()), stride = size;
    const Vector3f t = towards, u = scale * across, v = scale * along;
#pragma GCC ivdep
    for (int k = 0; k < count; ++k) {  // without branches, for the sake of vector instructions
      const float cosine = nx[k] * t[0] + ny[k] * t[1] + nz[k] * t[2];
      const float qx = px[k] + off_surface * nx[k], qy = py[k] + off_surface * ny[k], qz = pz[k] + off_surface * nz[k];
      const float x = middle + u[0] * qx + u[1] * qy + u[2] * qz, y = middle + v[0] * qx + v[1] * qy + v[2] * qz;
      const float depth = t[0] * qx + t[1] * qy + t[2] * qz + tolerance;
      const float x0 = x > 0 ? x : 0.f, xc = x0 < last ? x0 : last, y0 = y > 0 ? y : 0.f, yc = y0 < last ? y0 : last;
      const int i = static_cast<int>(xc), j = static_cast<int>(yc), texel = j * stride + i;
      const float right = xc - static_cast<float>(i), left = 1 - right, up = yc - static_cast<float>(j);
      const float t00 = texels[texel], t01 = texels[texel + 1], t10 = above[texel], t11 = above[texel + 1];
      const float lower = (t00 <= depth ? left : 0.f) + (t01 <= depth ? right : 0.f);
      const float upper = (t10 <= depth ? left : 0.f) + (t11 <= depth ? right : 0.f);
      total[k] += weight * (cosine > 0 ? cosine : 0.f) * (lower + up * (upper - lower));
    }
  }
};

struct Lighting {
  std::vector<Lamp> sky, key;
  std::vector<float> sky_radiance;
  float sky_on_ground = 0, key_on_ground = 0;  // unobstructed
  Vector3f up, key_towards, rim_towards;
  float ground_height, radius;
};

Lighting set_up_lights(const Scene& scene, const View& view) {
  Lighting light;
  const Vector3f up = view.ground_up.cast<float>(), right = view.right.cast<float>(), front = right.cross(up);
  const float radius = static_cast<float>(view.radius);
  light.up = up;
  light.radius = radius;
  light.ground_height = static_cast<float>(view.ground_height - view.ground_up.dot(view.centre));
  light.key_towards = (-0.62f * right + 1.0f * up + 0.62f * front).normalized();
  light.rim_towards = (0.75f * right + 0.45f * up - 0.7f * front).normalized();

  constexpr float golden_angle = 2.3999632f;
  for (int k = 0; k < num_sky_lights; ++k) {
    const float height = 0.06f + 0.94f * (static_cast<float>(k) + 0.5f) / num_sky_lights;
    const float reach = std::sqrt(1 - height * height), angle = golden_angle * static_cast<float>(k);
    const Vector3f towards = height * up + reach * (std::cos(angle) * right + std::sin(angle) * front);
    light.sky.emplace_back(towards, radius, sky_map_size);
    light.sky_radiance.push_back(0.6f + 0.4f * height + 0.25f * towards.dot(front));
    light.sky_on_ground += light.sky_radiance.back() * height;
  }
  const Vector3f across = light.key_towards.unitOrthogonal(), along = light.key_towards.cross(across);
  for (int k = 0; k < num_key_lights; ++k) {
    const float r = key_radius * std::sqrt((static_cast<float>(k) + 0.5f) / num_key_lights),
                angle = golden_angle * static_cast<float>(k);
    light.key.emplace_back(light.key_towards + r * (std::cos(angle) * across + std::sin(angle) * along), radius,
                           key_map_size);
  }
  light.key_on_ground = light.key_towards.dot(up);
  parallel_for(num_sky_lights + num_key_lights,
               [&](Index k) { (k < num_sky_lights ? light.sky[k] : light.key[k - num_sky_lights]).look_at(scene); });
  return light;
}

/// A place whose light is wanted: a piece of surface in a pixel.
struct Place {
  Vector3f position = Vector3f::Zero(), normal = Vector3f::Zero(), albedo = Vector3f::Zero();
  float weight = 1;  // of its colour in the pixel
  std::uint32_t pixel = 0;
  bool shaded = true;  // markers are signs: no shadow falls on them
  float sky = 0, key = 0;
};

void gather_light(const Lighting& light, std::vector<Place>& places) {
  // Lamp after lamp, so that neighbours read neighbouring texels of one map, in blocks that stay in the
  // cache.
  constexpr std::size_t block = 4096;
  for (std::size_t begin = 0; begin < places.size(); begin += block) {
    const std::size_t count = std::min(block, places.size() - begin);
    Surface points;
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (std::size_t k = 0; k < count; ++k) {
        points.x[axis].push_back(places[begin + k].position[axis]);
        points.n[axis].push_back(places[begin + k].normal[axis]);
      }
    std::vector<float> sky(count, 0.f), key(count, 0.f);
    for (std::size_t k = 0; k < light.sky.size(); ++k)
      light.sky[k].shine_on(points, light.sky_radiance[k] / light.sky_on_ground, sky);
    for (const Lamp& lamp : light.key) lamp.shine_on(points, 1 / static_cast<float>(light.key.size()), key);
    for (std::size_t k = 0; k < count; ++k) {
      Place& place = places[begin + k];
      place.sky = place.shaded ? sky[k] : 0.5f + 0.5f * place.normal.dot(light.up);
      place.key = place.shaded ? key[k] : std::max(0.f, place.normal.dot(light.key_towards));
    }
  }
}

/// What the camera sees of a lit place: matt, with some gloss and a bright rim, then the shoulder of a film.
Vector3f seen(const Place& place, const Lighting& light, const Vector3f& to_eye) {
  const Vector3f& n = place.normal;
  const float height = std::max(0.f, light.up.dot(place.position) - light.ground_height);
  const float bounce = bounce_strength * 0.5f * (1 - n.dot(light.up)) * std::min(1.f, 0.35f + height / light.radius);
  const Vector3f half = (light.key_towards + to_eye).normalized();
  const float lit = place.key / std::max(0.05f, n.dot(light.key_towards));
  const float glint = gloss * std::pow(std::max(0.f, n.dot(half)), gloss_exponent) * std::min(1.f, lit);
  const float grazing = std::pow(1 - std::clamp(n.dot(to_eye), 0.f, 1.f), 3.f);
  const float rim =
      rim_strength * grazing * (0.25f + std::max(0.f, n.dot(light.rim_towards))) * std::min(1.f, 2 * place.sky);
  const Vector3f colour =
      place.albedo.cwiseProduct(key_strength * place.key * key_colour + sky_strength * place.sky * sky_colour +
                                Vector3f::Constant(bounce)) +
      Vector3f::Constant(glint + rim);
  return colour.unaryExpr([](float c) { return c / std::pow(1 + c * c * c * c, 0.25f); });
}

/// to_screen for many pixels.
Colour encode(const Vector3f& linear) {
  constexpr int steps = 8191;  // more than two for each step of a byte, also in the dark
  static const std::vector<float> table = [] {
    std::vector<float> encoded(steps + 1);
    for (int k = 0; k <= steps; ++k)
      encoded[k] = static_cast<float>(to_screen(Vector3f::Constant(static_cast<float>(k) / steps)).r);
    return encoded;
  }();
  const auto look_up = [](float c) { return table[std::lrint(std::clamp(c, 0.f, 1.f) * steps)]; };
  return {look_up(linear[0]), look_up(linear[1]), look_up(linear[2])};
}

// ——— The camera ———

/// Sees positions relative to the view's centre.
struct Lens {
  Vector3f eye, right, up, forward;
  float pixels, middle_x, middle_y, near;
  bool perspective;

  Lens(const View& view, int width, int height)
      : eye((view.eye - view.centre).cast<float>()),
        right(view.right.cast<float>()),
        up(view.up.cast<float>()),
        forward(view.forward.cast<float>()),
        pixels(static_cast<float>(view.pixels)),
        middle_x(0.5f * static_cast<float>(width)),
        middle_y(0.5f * static_cast<float>(height)),
        near(0.01f * static_cast<float>(view.radius)),
        perspective(view.perspective) {}

  /// On the screen, and how near: a number that grows towards the camera and is linear on the screen.
  struct Projection {
    float x, y, nearness;
    bool visible;
  };
  float nearness(float z) const { return perspective ? 1 / z : -z; }
  float magnification(float z) const { return perspective ? pixels / z : pixels; }
  Projection project(const Vector3f& p) const {
    const Vector3f q = p - eye;
    const float z = forward.dot(q);
    if (z < near) return {0, 0, 0, false};
    const float scale = magnification(z);
    return {middle_x + scale * right.dot(q), middle_y - scale * up.dot(q), nearness(z), true};
  }
  Vector3f to_eye(const Vector3f& p) const { return perspective ? (eye - p).normalized() : Vector3f(-forward); }
};

/// Pixels are drawn in bands of rows, each by one thread in buffers that stay in the cache.
class Painter {
 public:
  Painter(const Scene& scene, const Lighting& lighting, std::span<const PictureObject> objects,
          const PictureOptions& options, const View& view)
      : scene_(scene),
        light_(lighting),
        objects_(objects),
        lens_(view, options.width, options.height),
        width_(options.width),
        height_(options.height),
        samples_(options.samples),
        ground_(options.ground),
        image_(options.width, options.height) {
    projected_.resize(scene.vertices.size());
    std::ranges::transform(scene.vertices, projected_.begin(), [this](const Vector3f& p) { return lens_.project(p); });
    num_bands_ = (height_ + band_rows - 1) / band_rows;
    faces_of_band_.resize(num_bands_);
    for (std::uint32_t f = 0; f < scene.faces.size(); ++f) {
      const auto& [a, b, c] = scene.faces[f].vertices;
      const Projection &pa = projected_[a], &pb = projected_[b], &pc = projected_[c];
      if (!pa.visible || !pb.visible || !pc.visible) continue;
      const int low = std::max(0, whole(std::min({pa.y, pb.y, pc.y})) / band_rows);
      const int high = std::min(num_bands_ - 1, whole(std::max({pa.y, pb.y, pc.y})) / band_rows);
      for (int band = low; band <= high; ++band) faces_of_band_[band].push_back(f);
    }
  }

  Image paint() {
    parallel_for(num_bands_, [this](Index band) { paint_band(static_cast<int>(band)); });
    return std::move(image_);
  }

 private:
  using Projection = Lens::Projection;
  static constexpr int band_rows = 18, ground_step = 3;  // the grid on the ground goes on from band to band
  static constexpr std::uint32_t nothing = ~0u;

  /// What stands in the samples of a band.
  struct Band {
    int first_row, rows, columns, lines;  // rows in pixels; columns and lines in samples
    std::vector<float> nearness, ball_nearness;
    std::vector<std::uint32_t> face, ball;
  };

  void paint_band(int index) {
    Band band{};
    band.first_row = index * band_rows;
    band.rows = std::min(band_rows, height_ - band.first_row);
    band.columns = width_ * samples_;
    band.lines = band.rows * samples_;
    const std::size_t count = static_cast<std::size_t>(band.columns) * band.lines;
    band.nearness.assign(count, -infinity);
    band.face.assign(count, nothing);
    for (const std::uint32_t f : faces_of_band_[index]) draw_face(band, f);
    if (!scene_.balls.empty()) {
      band.ball_nearness.assign(count, -infinity);
      band.ball.assign(count, nothing);
      for (std::uint32_t k = 0; k < scene_.balls.size(); ++k) draw_ball(band, k);
    }

    std::vector<Place> places;
    std::vector<float> uncovered(static_cast<std::size_t>(width_) * band.rows, 0.f);
    for (int y = 0; y < band.rows; ++y)
      for (int x = 0; x < width_; ++x)
        collect_places(band, x, y, places, uncovered[static_cast<std::size_t>(y) * width_ + x]);
    gather_light(light_, places);

    std::vector<Vector3f> colours(uncovered.size(), Vector3f::Zero());
    for (const Place& place : places)
      colours[place.pixel] += place.weight * seen(place, light_, lens_.to_eye(place.position));
    add_background(band, uncovered, colours);
    for (int y = 0; y < band.rows; ++y)
      for (int x = 0; x < width_; ++x)
        image_.set(x, band.first_row + y, encode(colours[static_cast<std::size_t>(y) * width_ + x]));
  }

  /// Calls visit(sample, x, y) for the samples of the band in a rectangle of pixels; x and y are the sample's
  /// place.
  template <typename Visit>
  void for_samples(const Band& band, float x0, float x1, float y0, float y1, const Visit& visit) const {
    const float s = static_cast<float>(samples_);
    const int i0 = std::max(0, whole(std::ceil(std::max(x0, -1.f) * s - 0.5f)));
    const int i1 = whole(std::floor(std::min(x1 * s - 0.5f, static_cast<float>(band.columns - 1))));
    const float top = static_cast<float>(band.first_row);
    const int j0 = std::max(0, whole(std::ceil(std::max(y0 - top, -1.f) * s - 0.5f)));
    const int j1 = whole(std::floor(std::min((y1 - top) * s - 0.5f, static_cast<float>(band.lines - 1))));
    for (int j = j0; j <= j1; ++j)
      for (int i = i0; i <= i1; ++i)
        visit(static_cast<std::size_t>(j) * band.columns + i, (static_cast<float>(i) + 0.5f) / s,
              top + (static_cast<float>(j) + 0.5f) / s);
  }

  /// Barycentric coordinates on the screen, as functions that are linear in x and y.
  struct Barycentric {
    float ax, ay, bx, by, cx, cy;
    bool flat;

    Barycentric(const Projection& a, const Projection& b, const Projection& c) : ax(a.x), ay(a.y) {
      const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      flat = area == 0;
      bx = (c.y - a.y) / area, by = -(c.x - a.x) / area;
      cx = -(b.y - a.y) / area, cy = (b.x - a.x) / area;
    }
    Vector3f at(float x, float y) const {
      const float beta = bx * (x - ax) + by * (y - ay), gamma = cx * (x - ax) + cy * (y - ay);
      return {1 - beta - gamma, beta, gamma};
    }
    /// Distance in pixels to the nearest edge.
    float to_edge(const Vector3f& at) const {
      return std::min({at[0] / std::hypot(bx + cx, by + cy), at[1] / std::hypot(bx, by), at[2] / std::hypot(cx, cy)});
    }
  };

  void draw_face(Band& band, std::uint32_t f) const {
    const auto& [va, vb, vc] = scene_.faces[f].vertices;
    const Projection &a = projected_[va], &b = projected_[vb], &c = projected_[vc];
    const Barycentric barycentric(a, b, c);
    if (barycentric.flat) return;
    for_samples(band, std::min({a.x, b.x, c.x}), std::max({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}),
                std::max({a.y, b.y, c.y}), [&](std::size_t sample, float x, float y) {
                  const Vector3f at = barycentric.at(x, y);
                  if (at.minCoeff() < 0) return;
                  const float nearness = at[0] * a.nearness + at[1] * b.nearness + at[2] * c.nearness;
                  if (nearness <= band.nearness[sample]) return;
                  band.nearness[sample] = nearness;
                  band.face[sample] = f;
                });
  }

  struct BallOnScreen {
    float x, y, radius, z;
  };
  BallOnScreen on_screen(const Ball& ball) const {
    const Projection centre = lens_.project(ball.centre);
    const float z = lens_.forward.dot(ball.centre - lens_.eye);
    return {centre.x, centre.y, centre.visible ? ball.radius * lens_.magnification(z) : 0, z};
  }

  void draw_ball(Band& band, std::uint32_t k) const {
    const Ball& ball = scene_.balls[k];
    const BallOnScreen disc = on_screen(ball);
    for_samples(band, disc.x - disc.radius, disc.x + disc.radius, disc.y - disc.radius, disc.y + disc.radius,
                [&](std::size_t sample, float x, float y) {
                  const float dx = (x - disc.x) / disc.radius, dy = (y - disc.y) / disc.radius,
                              rest = 1 - dx * dx - dy * dy;
                  if (!(rest >= 0)) return;
                  const float nearness = lens_.nearness(std::max(lens_.near, disc.z - ball.radius * std::sqrt(rest)));
                  if (nearness <= band.ball_nearness[sample]) return;
                  band.ball_nearness[sample] = nearness;
                  band.ball[sample] = k;
                });
  }

  Place place_on_face(std::uint32_t f, float x, float y) const {
    const Face& face = scene_.faces[f];
    const auto& [va, vb, vc] = face.vertices;
    const Projection &a = projected_[va], &b = projected_[vb], &c = projected_[vc];
    const Barycentric barycentric(a, b, c);
    const Vector3f at = barycentric.at(x, y).cwiseMax(0.f);
    // On the screen, what is linear in space is linear after division by depth.
    Vector3f share = lens_.perspective ? Vector3f(at[0] * a.nearness, at[1] * b.nearness, at[2] * c.nearness) : at;
    share /= share.sum();
    Place place;
    place.position = share[0] * scene_.vertices[va] + share[1] * scene_.vertices[vb] + share[2] * scene_.vertices[vc];
    place.normal = share[0] * face.normals[0] + share[1] * face.normals[1] + share[2] * face.normals[2];
    place.normal = place.normal.stableNormalized();
    // A normal that turns away belongs to the other side of a sheet, or was smoothed around the edge of what
    // is seen.
    const Vector3f to_eye = lens_.to_eye(place.position);
    if (place.normal.dot(to_eye) < -0.25f) place.normal = -place.normal;
    if (const float facing = place.normal.dot(to_eye); facing < 0)
      place.normal = (place.normal - facing * to_eye).normalized();
    const PictureObject& object = objects_[face.object];
    place.albedo =
        face.highlighted
            ? to_linear(object.highlight)
            : Vector3f(share[0] * scene_.albedo[va] + share[1] * scene_.albedo[vb] + share[2] * scene_.albedo[vc]);
    if (object.edges > 0) {
      constexpr float line = 0.55f;  // half its width in pixels
      const float covered = std::clamp(line + 0.5f - barycentric.to_edge(at), 0.f, 1.f);
      place.albedo *= 1 - static_cast<float>(object.edges) * covered;
    }
    return place;
  }

  Place place_on_ball(std::uint32_t k, float x, float y) const {
    const Ball& ball = scene_.balls[k];
    const BallOnScreen disc = on_screen(ball);
    const float dx = (x - disc.x) / disc.radius, dy = (y - disc.y) / disc.radius;
    Place place;
    place.normal = (dx * lens_.right - dy * lens_.up - std::sqrt(std::max(0.f, 1 - dx * dx - dy * dy)) * lens_.forward)
                       .normalized();
    place.position = ball.centre + ball.radius * place.normal;
    place.albedo = ball.albedo;
    place.shaded = false;
    return place;
  }

  /// Adds the pieces of surface in a pixel: one if they belong together, more at the edges.
  void collect_places(const Band& band, int x, int y, std::vector<Place>& places, float& uncovered) const {
    const std::size_t corner =
        static_cast<std::size_t>(y) * samples_ * band.columns + static_cast<std::size_t>(x) * samples_;
    const auto pixel = static_cast<std::uint32_t>(y * width_ + x);
    const std::uint32_t first = band.face[corner];
    bool uniform = true;
    for (int j = 0; j < samples_; ++j)
      for (int i = 0; i < samples_; ++i) {
        const std::size_t sample = corner + static_cast<std::size_t>(j) * band.columns + i;
        uniform = uniform && band.face[sample] == first && (band.ball.empty() || band.ball[sample] == nothing);
      }
    if (uniform) {
      if (first == nothing) {
        uncovered = 1;
        return;
      }
      places.push_back(
          place_on_face(first, static_cast<float>(x) + 0.5f, static_cast<float>(band.first_row + y) + 0.5f));
      places.back().weight = 1;
      places.back().pixel = pixel;
      return;
    }

    const std::size_t before = places.size();
    const float weight = 1 / static_cast<float>(samples_ * samples_);
    const auto add = [&](const Place& place, float share) {
      // Samples of one surface share a place: the mean of theirs.
      for (std::size_t k = before; k < places.size(); ++k) {
        Place& same = places[k];
        if (same.shaded != place.shaded ||
            (same.position / same.weight - place.position).squaredNorm() > std::pow(0.02f * light_.radius, 2.f) ||
            same.normal.dot(place.normal) < 0.8f * same.normal.norm())
          continue;
        same.position += share * place.position;
        same.normal += share * place.normal;
        same.albedo += share * place.albedo;
        same.weight += share;
        return;
      }
      Place sum = place;
      sum.position *= share;
      sum.normal *= share;
      sum.albedo *= share;
      sum.weight = share;
      sum.pixel = pixel;
      places.push_back(sum);
    };
    for (int j = 0; j < samples_; ++j)
      for (int i = 0; i < samples_; ++i) {
        const std::size_t sample = corner + static_cast<std::size_t>(j) * band.columns + i;
        const float sx = static_cast<float>(x) + (static_cast<float>(i) + 0.5f) / static_cast<float>(samples_);
        const float sy =
            static_cast<float>(band.first_row + y) + (static_cast<float>(j) + 0.5f) / static_cast<float>(samples_);
        float rest = weight;
        if (!band.ball.empty() && band.ball[sample] != nothing) {
          const float opacity = band.ball_nearness[sample] > band.nearness[sample] ? 1 : hidden_marker;
          add(place_on_ball(band.ball[sample], sx, sy), opacity * weight);
          rest -= opacity * weight;
        }
        if (rest <= 0) continue;
        if (band.face[sample] == nothing)
          uncovered += rest;
        else
          add(place_on_face(band.face[sample], sx, sy), rest);
      }
    for (std::size_t k = before; k < places.size(); ++k) {
      Place& place = places[k];
      place.position /= place.weight;
      place.albedo /= place.weight;
      place.normal = place.normal.stableNormalized();
    }
  }

  /// The ground that a pixel shows, if it shows any.
  bool find_ground(float x, float y, Vector3f& position) const {
    const Vector3f aside =
        (x - lens_.middle_x) / lens_.pixels * lens_.right - (y - lens_.middle_y) / lens_.pixels * lens_.up;
    const Vector3f from = lens_.perspective ? lens_.eye : Vector3f(lens_.eye + aside);
    const Vector3f towards = lens_.perspective ? Vector3f(lens_.forward + aside) : lens_.forward;
    const float fall = light_.up.dot(towards), distance = (light_.ground_height - light_.up.dot(from)) / fall;
    if (!(fall < 0) || !(distance > 0)) return false;
    position = from + distance * towards;
    return position.squaredNorm() < std::pow(12 * light_.radius, 2.f);
  }

  /// The background, darkened by what the ground lacks of light; shadows are soft, so every other pixel
  /// suffices.
  void add_background(const Band& band, const std::vector<float>& uncovered, std::vector<Vector3f>& colours) const {
    const int columns = width_ / ground_step + 2, rows = band.rows / ground_step + 2;
    std::vector<float> shade(static_cast<std::size_t>(columns) * rows, 1.f);
    if (ground_) {
      std::vector<bool> wanted(shade.size(), false);
      for (int y = 0; y < band.rows; ++y)
        for (int x = 0; x < width_; ++x)
          if (uncovered[static_cast<std::size_t>(y) * width_ + x] > 0) {
            const std::size_t corner = static_cast<std::size_t>(y / ground_step) * columns + x / ground_step;
            wanted[corner] = wanted[corner + 1] = wanted[corner + columns] = wanted[corner + columns + 1] = true;
          }
      std::vector<Place> places;
      Place node;
      node.normal = light_.up;
      for (std::size_t k = 0; k < shade.size(); ++k) {
        const int x = static_cast<int>(k) % columns * ground_step,
                  y = band.first_row + static_cast<int>(k) / columns * ground_step;
        node.pixel = static_cast<std::uint32_t>(k);
        if (wanted[k] && find_ground(static_cast<float>(x), static_cast<float>(y), node.position))
          places.push_back(node);
      }
      gather_light(light_, places);
      const float free = key_strength * light_.key_on_ground + sky_strength;
      for (const Place& place : places) {
        const float lit = (key_strength * place.key + sky_strength * place.sky) / free;
        shade[place.pixel] = 1 - shadow_strength * (1 - std::min(1.f, lit));
      }
    }
    const Vector3f top = to_linear(rgb(background_top)), bottom = to_linear(rgb(background_bottom));
    for (int y = 0; y < band.rows; ++y) {
      const float down = (static_cast<float>(band.first_row + y) + 0.5f) / static_cast<float>(height_);
      const Vector3f background = top + down * down * (bottom - top);
      for (int x = 0; x < width_; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * width_ + x;
        if (uncovered[pixel] == 0) continue;
        const float u = (static_cast<float>(x) + 0.5f) / ground_step, v = (static_cast<float>(y) + 0.5f) / ground_step;
        const int i = static_cast<int>(u), j = static_cast<int>(v);
        const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
        const float* corner = shade.data() + static_cast<std::size_t>(j) * columns + i;
        const float here =
            (1 - t) * ((1 - s) * corner[0] + s * corner[1]) + t * ((1 - s) * corner[columns] + s * corner[columns + 1]);
        const Vector3f tint(std::pow(here, 1.06f), here, std::pow(here, 0.94f));  // shadows are a little blue
        colours[pixel] += uncovered[pixel] * background.cwiseProduct(tint);
      }
    }
  }

  const Scene& scene_;
  const Lighting& light_;
  std::span<const PictureObject> objects_;
  Lens lens_;
  int width_, height_, samples_, num_bands_ = 0;
  bool ground_;
  std::vector<Projection> projected_;
  std::vector<std::vector<std::uint32_t>> faces_of_band_;
  Image image_;
};

// ——— Text ———

void draw_captions(Image& image, std::span<const PictureObject> objects, const View& view) {
  double size = caption_size * image.height;
  const double edge = 0.4 * margin * image.height;
  // All captions are as small as the tightest one needs.
  const auto count = objects.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (objects[k].caption.empty()) continue;
    double room = 2 * std::min(view.caption_x[k] - edge, image.width - edge - view.caption_x[k]);
    for (std::size_t other = 0; other < count; ++other)
      if (other != k && !objects[other].caption.empty())
        room = std::min(room, std::abs(view.caption_x[other] - view.caption_x[k]) - size);
    const double width = text_width(objects[k].caption, size);
    if (width > room) size *= std::max(0.4, room / width);
  }
  for (std::size_t k = 0; k < count; ++k)
    draw_text(image, view.caption_x[k], image.height * (1 - 0.45 * caption_margin), objects[k].caption, size, rgb(ink),
              TextAlign::Centre);
}

void draw_bar(Image& image, const ScalarScale& scale, const View& view) {
  const double H = image.height, size = 0.85 * caption_size * H;
  const int top = static_cast<int>(0.27 * H), bottom = static_cast<int>(0.73 * H);
  const int left = static_cast<int>(image.width - 0.16 * H), right = left + std::max(4, static_cast<int>(0.02 * H));
  for (int y = top; y < bottom; ++y)
    for (int x = std::max(0, left); x < right; ++x)
      image.set(x, y, map_colour(scale.map, 1 - (y + 0.5 - top) / (bottom - top)));
  for (const double share : {0.0, 0.5, 1.0}) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", view.scalar_low + share * (view.scalar_high - view.scalar_low));
    std::string text(number);
    if (text.starts_with('-')) text.replace(0, 1, "−");
    draw_text(image, right + 0.6 * size, bottom + share * (top - bottom) + 0.5 * size, text, size, rgb(ink));
  }
  const double end = image.width - 0.5 * margin * H, width = text_width(scale.label, size);
  draw_text(image, std::min(end - width, static_cast<double>(left)), top - 1.8 * size, scale.label, size, rgb(ink));
}

}  // namespace

Image draw_picture(std::span<const PictureObject> objects, const PictureOptions& options, const View& view) {
  check(objects, options);
  require_size("offsets of the view", static_cast<Index>(view.offsets.size()), static_cast<Index>(objects.size()));
  require_size("captions of the view", static_cast<Index>(view.caption_x.size()), static_cast<Index>(objects.size()));
  const Scene scene = build_scene(objects, options, view);
  const Lighting light = set_up_lights(scene, view);
  Image image = Painter(scene, light, objects, options, view).paint();
  draw_captions(image, objects, view);
  if (has_bar(objects, options.scale)) draw_bar(image, options.scale, view);
  return image;
}

}  // namespace supple
