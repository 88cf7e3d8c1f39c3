#include <core/parallel.hpp>
#include <io/picture/studio/painter.hpp>
#include <io/picture/studio/raster.hpp>

#include <algorithm>
#include <cmath>

namespace supple::studio {

namespace {

constexpr unsigned background_top = 0xf7f8fa, background_bottom = 0xe9ecf0;
constexpr float hidden_marker = 0.55f;    // opacity of a ball inside the object
constexpr float shadow_strength = 0.78f;  // of the ground
constexpr int ground_step = 3;            // between nodes of the ground's shade [pixels]
static_assert(Raster::band_rows % ground_step == 0, "the grid on the ground goes on from band to band");

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

class Painter {
 public:
  Painter(const Scene& scene, const Lighting& light, const PictureOptions& options, const View& view)
      : scene_(scene),
        light_(light),
        lens_(view, options.width, options.height),
        raster_(scene, lens_, options.width, options.height, options.samples),
        ground_(options.ground),
        image_(options.width, options.height) {}

  Image paint() {
    parallel_for(raster_.num_bands(), [this](Index index) { paint_band(raster_.draw(static_cast<int>(index))); });
    return std::move(image_);
  }

 private:
  void paint_band(const Band& band) {
    const int width = image_.width;
    std::vector<Place> places;
    std::vector<float> uncovered(static_cast<std::size_t>(width) * band.rows, 0.f);
    for (int y = 0; y < band.rows; ++y)
      for (int x = 0; x < width; ++x)
        collect_places(band, x, y, places, uncovered[static_cast<std::size_t>(y) * width + x]);
    gather_light(light_, places);

    std::vector<Vector3f> colours(uncovered.size(), Vector3f::Zero());
    for (const Place& place : places)
      colours[place.pixel] += place.weight * seen(place, light_, lens_.to_eye(place.position));
    add_background(band, uncovered, colours);
    for (int y = 0; y < band.rows; ++y)
      for (int x = 0; x < width; ++x)
        image_.set(x, band.first_row + y, encode(colours[static_cast<std::size_t>(y) * width + x]));
  }

  Place place_on_face(std::uint32_t f, float x, float y) const {
    const Face& face = scene_.faces[f];
    const auto& [va, vb, vc] = face.vertices;
    const Projection &a = raster_.projected(va), &b = raster_.projected(vb), &c = raster_.projected(vc);
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
    const Finish& finish = scene_.finishes[face.object];
    place.albedo =
        face.highlighted
            ? finish.highlight
            : Vector3f(share[0] * scene_.albedo[va] + share[1] * scene_.albedo[vb] + share[2] * scene_.albedo[vc]);
    if (finish.edges > 0) {
      constexpr float line = 0.55f;  // half its width in pixels
      const float covered = std::clamp(line + 0.5f - barycentric.to_edge(at), 0.f, 1.f);
      place.albedo *= 1 - static_cast<float>(finish.edges) * covered;
    }
    return place;
  }

  Place place_on_ball(std::uint32_t k, float x, float y) const {
    const Ball& ball = scene_.balls[k];
    const Disc::Spot spot = lens_.project_ball(ball.centre, ball.radius).at(x, y);
    Place place;
    place.normal = (spot.across * lens_.right - spot.down * lens_.up -
                    std::sqrt(std::max(0.f, spot.height_squared)) * lens_.forward)
                       .normalized();
    place.position = ball.centre + ball.radius * place.normal;
    place.albedo = ball.albedo;
    place.shaded = false;
    return place;
  }

  /// Adds the pieces of surface in a pixel: one if they belong together, more at the edges.
  void collect_places(const Band& band, int x, int y, std::vector<Place>& places, float& uncovered) const {
    const auto pixel = static_cast<std::uint32_t>(y * image_.width + x);
    const float left = static_cast<float>(x), top = static_cast<float>(band.first_row + y);
    if (!is_uniform(band, x, y)) {
      const std::size_t before = places.size();
      collect_samples(band, x, y, places, uncovered);
      for (std::size_t k = before; k < places.size(); ++k) places[k].pixel = pixel;
    } else if (const std::uint32_t face = band.face[band.sample(x, y, 0, 0)]; face == Band::nothing) {
      uncovered = 1;
    } else {
      places.push_back(place_on_face(face, left + 0.5f, top + 0.5f));
      places.back().pixel = pixel;
    }
  }

  /// Whether all samples of a pixel show one face, or nothing.
  static bool is_uniform(const Band& band, int x, int y) {
    const std::uint32_t first = band.face[band.sample(x, y, 0, 0)];
    bool uniform = true;
    for (int j = 0; j < band.samples; ++j)
      for (int i = 0; i < band.samples; ++i) {
        const std::size_t sample = band.sample(x, y, i, j);
        uniform = uniform && band.face[sample] == first && !band.has_ball(sample);
      }
    return uniform;
  }

  void collect_samples(const Band& band, int x, int y, std::vector<Place>& places, float& uncovered) const {
    const std::size_t before = places.size();
    const float weight = 1 / static_cast<float>(band.samples * band.samples),
                samples = static_cast<float>(band.samples);
    for (int j = 0; j < band.samples; ++j)
      for (int i = 0; i < band.samples; ++i) {
        const std::size_t sample = band.sample(x, y, i, j);
        const float sx = static_cast<float>(x) + (static_cast<float>(i) + 0.5f) / samples;
        const float sy = static_cast<float>(band.first_row + y) + (static_cast<float>(j) + 0.5f) / samples;
        float rest = weight;
        if (band.has_ball(sample)) {
          const float opacity = band.ball_nearness[sample] > band.nearness[sample] ? 1 : hidden_marker;
          add_share(place_on_ball(band.ball[sample], sx, sy), opacity * weight, before, places);
          rest -= opacity * weight;
        }
        if (rest <= 0) continue;
        if (band.face[sample] == Band::nothing)
          uncovered += rest;
        else
          add_share(place_on_face(band.face[sample], sx, sy), rest, before, places);
      }
    for (std::size_t k = before; k < places.size(); ++k) {
      Place& place = places[k];
      place.position /= place.weight;
      place.albedo /= place.weight;
      place.normal = place.normal.stableNormalized();
    }
  }

  /// Samples of one surface share a place from `first` on: the weighted sum of theirs.
  void add_share(const Place& place, float share, std::size_t first, std::vector<Place>& places) const {
    for (std::size_t k = first; k < places.size(); ++k) {
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
    places.push_back(sum);
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

  /// What shadows leave of the ground's light at the nodes of a grid over a band; shadows are soft, so every
  /// ground_step-th pixel suffices.
  struct GroundShade {
    int columns;
    std::vector<float> nodes;

    std::size_t node(int i, int j) const { return static_cast<std::size_t>(j) * columns + i; }
    float at(float x, float y) const {
      const float u = x / ground_step, v = y / ground_step;
      const int i = static_cast<int>(u), j = static_cast<int>(v);
      const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
      const float* corner = nodes.data() + node(i, j);
      return (1 - t) * ((1 - s) * corner[0] + s * corner[1]) +
             t * ((1 - s) * corner[columns] + s * corner[columns + 1]);
    }
  };

  GroundShade shade_ground(const Band& band, const std::vector<float>& uncovered) const {
    const int columns = image_.width / ground_step + 2, rows = band.rows / ground_step + 2;
    GroundShade shade{columns, std::vector<float>(static_cast<std::size_t>(columns) * rows, 1.f)};
    if (!ground_) return shade;
    std::vector<bool> wanted(shade.nodes.size(), false);
    for (int y = 0; y < band.rows; ++y)
      for (int x = 0; x < image_.width; ++x)
        if (uncovered[static_cast<std::size_t>(y) * image_.width + x] > 0) {
          const std::size_t corner = shade.node(x / ground_step, y / ground_step);
          wanted[corner] = wanted[corner + 1] = wanted[corner + columns] = wanted[corner + columns + 1] = true;
        }
    std::vector<Place> places;
    Place node;
    node.normal = light_.up;
    for (std::size_t k = 0; k < shade.nodes.size(); ++k) {
      const int x = static_cast<int>(k) % columns * ground_step,
                y = band.first_row + static_cast<int>(k) / columns * ground_step;
      node.pixel = static_cast<std::uint32_t>(k);
      if (wanted[k] && find_ground(static_cast<float>(x), static_cast<float>(y), node.position)) places.push_back(node);
    }
    gather_light(light_, places);
    for (const Place& place : places)
      shade.nodes[place.pixel] = 1 - shadow_strength * (1 - std::min(1.f, share_on_ground(place, light_)));
    return shade;
  }

  /// The background, darkened by what the ground lacks of light.
  void add_background(const Band& band, const std::vector<float>& uncovered, std::vector<Vector3f>& colours) const {
    const GroundShade shade = shade_ground(band, uncovered);
    const Vector3f top = to_linear(rgb(background_top)), bottom = to_linear(rgb(background_bottom));
    for (int y = 0; y < band.rows; ++y) {
      const float down = (static_cast<float>(band.first_row + y) + 0.5f) / static_cast<float>(image_.height);
      const Vector3f background = top + down * down * (bottom - top);
      for (int x = 0; x < image_.width; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * image_.width + x;
        if (uncovered[pixel] == 0) continue;
        const float here = shade.at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f);
        const Vector3f tint(std::pow(here, 1.06f), here, std::pow(here, 0.94f));  // shadows are a little blue
        colours[pixel] += uncovered[pixel] * background.cwiseProduct(tint);
      }
    }
  }

  const Scene& scene_;
  const Lighting& light_;
  Lens lens_;
  Raster raster_;
  bool ground_;
  Image image_;
};

}  // namespace

Image paint(const Scene& scene, const Lighting& light, const PictureOptions& options, const View& view) {
  return Painter(scene, light, options, view).paint();
}

}  // namespace supple::studio
