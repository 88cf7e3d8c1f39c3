#include <core/check.hpp>
#include <io/picture/picture.hpp>
#include <io/picture/studio/captions.hpp>
#include <io/picture/studio/lighting.hpp>
#include <io/picture/studio/painter.hpp>
#include <io/picture/studio/scene.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace supple {

namespace {

// ——— Checks ———

void check(const PictureObject& object, const std::string& name) {
  const Index n = object.positions.rows();
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
}

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
    any = any || !objects[k].triangles.empty();
    check(objects[k], "object " + std::to_string(k) + " of a picture");
    range("darkness of edges", objects[k].edges, 0, 1);
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
  double middle() const { return 0.5 * (low + high); }
};

Extent extent_along(const PictureObject& object, const Point& direction) {
  Extent extent;
  for (const Points* points : {&object.positions, &object.reach})
    for (const auto& p : points->rowwise()) extent.include(p.dot(direction));
  return extent;
}

/// Calls visit(p) for the places of all that the view must hold.
template <typename Visit>
void for_each_point(std::span<const PictureObject> objects, const View& view, const Visit& visit) {
  for (std::size_t k = 0; k < objects.size(); ++k)
    for (const Points* points : {&objects[k].positions, &objects[k].reach})
      for (const auto& p : points->rowwise()) visit(Point(p.transpose() + view.offsets[k]));
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

/// Azimuth counts from the axis after the up axis: from z to x if y is up, from x to y if z is up.
void turn_camera(const Camera& camera, View& view) {
  Index up_axis;
  camera.up.cwiseAbs().maxCoeff(&up_axis);
  const Point first = (Point::Unit((up_axis + 1) % 3) - camera.up * camera.up[(up_axis + 1) % 3]).normalized();
  const double azimuth = camera.azimuth * std::numbers::pi / 180, elevation = camera.elevation * std::numbers::pi / 180;
  const Point towards_camera = std::cos(azimuth) * first + std::sin(azimuth) * camera.up.cross(first);
  view.ground_up = camera.up;
  view.right = camera.up.cross(towards_camera).normalized();
  view.forward = -(std::cos(elevation) * towards_camera + std::sin(elevation) * camera.up).normalized();
  view.up = view.right.cross(view.forward);
}

/// \param widths  the objects' extents along view.right.
void arrange(std::span<const Extent> widths, Arrangement arrangement, View& view) {
  view.offsets.assign(widths.size(), Point::Zero());
  if (arrangement != Arrangement::SideBySide || widths.size() < 2) return;
  double total = 0, at = 0;
  for (const Extent& width : widths) total += std::max(0.0, width.length());
  const double gap = 0.16 * total / static_cast<double>(widths.size());
  for (std::size_t k = 0; k < widths.size(); ++k) {
    if (widths[k].length() < 0) continue;
    view.offsets[k] = (at - widths[k].low) * view.right;
    at += widths[k].length() + gap;
  }
}

/// The ground, and the ball that holds all that is lit.
void enclose(std::span<const PictureObject> objects, View& view) {
  Extent ground;
  Eigen::AlignedBox3d box;
  for_each_point(objects, view, [&](const Point& p) {
    box.extend(p);
    ground.include(view.ground_up.dot(p));
  });
  view.centre = box.center();
  view.ground_height = ground.low;
  double radius = 0;
  for_each_point(objects, view, [&](const Point& p) { radius = std::max(radius, (p - view.centre).norm()); });
  view.radius = std::max(1.02 * radius, 1e-12);
}

/// Where the eye is, seen from the centre: along right and up, and how far back.
struct Stand {
  double right, up, distance;
};

/// The edges of the window are four planes through the eye, and the closest eye is where opposite planes touch the
/// points.
Stand fit_perspective(std::span<const PictureObject> objects, const studio::Window& window, const View& view) {
  const double r = window.right / view.pixels, l = window.left / view.pixels;
  const double t = window.top / view.pixels, b = window.bottom / view.pixels;
  double to_r = -1e300, to_l = -1e300, to_t = -1e300, to_b = -1e300, nearest = 1e300;
  for_each_point(objects, view, [&](const Point& p) {
    const Point q = p - view.centre;
    const double x = q.dot(view.right), y = q.dot(view.up), z = q.dot(view.forward);
    to_r = std::max(to_r, x - r * z);
    to_l = std::max(to_l, -x - l * z);
    to_t = std::max(to_t, y - t * z);
    to_b = std::max(to_b, -y - b * z);
    nearest = std::min(nearest, z);
  });
  const double distance = std::max({(to_r + to_l) / (r + l), (to_t + to_b) / (t + b), 0.05 * view.radius - nearest});
  return {0.5 * ((to_r - r * distance) + (l * distance - to_l)), 0.5 * ((to_t - t * distance) + (b * distance - to_b)),
          distance};
}

/// The planes of fit_perspective, but parallel. Sets view.pixels.
Stand fit_orthographic(std::span<const PictureObject> objects, const studio::Window& window, View& view) {
  Extent x, y;
  for_each_point(objects, view, [&](const Point& p) {
    x.include((p - view.centre).dot(view.right));
    y.include((p - view.centre).dot(view.up));
  });
  view.pixels = std::min(window.width() / std::max(x.length(), 1e-12), window.height() / std::max(y.length(), 1e-12));
  return {x.middle() - 0.5 * (window.right - window.left) / view.pixels,
          y.middle() - 0.5 * (window.top - window.bottom) / view.pixels, 3 * view.radius};
}

}  // namespace

View fit_view(std::span<const PictureObject> objects, const PictureOptions& options) {
  check(objects, options);
  View view;
  fit_scale(objects, options.scale, view);
  turn_camera(options.camera, view);
  std::vector<Extent> widths;
  for (const PictureObject& object : objects) widths.push_back(extent_along(object, view.right));
  arrange(widths, options.arrangement, view);
  enclose(objects, view);

  const studio::Window window = studio::free_window(objects, options);
  view.perspective = options.camera.field_of_view > 0;
  if (view.perspective)
    view.pixels = options.height / 2.0 / std::tan(options.camera.field_of_view * std::numbers::pi / 360);
  const Stand eye = view.perspective ? fit_perspective(objects, window, view) : fit_orthographic(objects, window, view);
  view.eye = view.centre + eye.right * view.right + eye.up * view.up - eye.distance * view.forward;

  for (std::size_t k = 0; k < objects.size(); ++k) {
    const Point offset = view.offsets[k] - view.centre;
    const double x = widths[k].middle() + offset.dot(view.right) - eye.right;
    view.caption_x.push_back(options.width / 2.0 + view.pixels * (view.perspective ? x / eye.distance : x));
  }
  return view;
}

Image draw_picture(std::span<const PictureObject> objects, const PictureOptions& options, const View& view) {
  check(objects, options);
  require_size("offsets of the view", static_cast<Index>(view.offsets.size()), static_cast<Index>(objects.size()));
  require_size("captions of the view", static_cast<Index>(view.caption_x.size()), static_cast<Index>(objects.size()));
  const studio::Scene scene = studio::build_scene(objects, options.scale.map, view);
  const studio::Lighting light = studio::set_up_lights(scene, view);
  Image image = studio::paint(scene, light, options, view);
  studio::draw_captions(image, objects, options.scale, view);
  return image;
}

}  // namespace supple
