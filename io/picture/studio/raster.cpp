#include <io/picture/studio/raster.hpp>

#include <algorithm>
#include <cmath>

namespace supple::studio {

namespace {

/// Calls visit(sample, x, y) for the samples of the band in a rectangle of pixels; x and y are the sample's
/// place.
template <typename Visit>
void for_samples(const Band& band, float x0, float x1, float y0, float y1, const Visit& visit) {
  const float s = static_cast<float>(band.samples);
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

}  // namespace

Raster::Raster(const Scene& scene, const Lens& lens, int width, int height, int samples)
    : scene_(scene), lens_(lens), width_(width), height_(height), samples_(samples) {
  projected_.resize(scene.vertices.size());
  std::ranges::transform(scene.vertices, projected_.begin(), [this](const Vector3f& p) { return lens_.project(p); });
  faces_of_band_.resize((height + band_rows - 1) / band_rows);
  for (std::uint32_t f = 0; f < scene.faces.size(); ++f) {
    const auto& [va, vb, vc] = scene.faces[f].vertices;
    const Projection &a = projected_[va], &b = projected_[vb], &c = projected_[vc];
    if (!a.visible || !b.visible || !c.visible) continue;
    const int low = std::max(0, whole(std::min({a.y, b.y, c.y})) / band_rows);
    const int high = std::min(num_bands() - 1, whole(std::max({a.y, b.y, c.y})) / band_rows);
    for (int band = low; band <= high; ++band) faces_of_band_[band].push_back(f);
  }
}

Band Raster::draw(int index) const {
  Band band{};
  band.first_row = index * band_rows;
  band.rows = std::min(band_rows, height_ - band.first_row);
  band.columns = width_ * samples_;
  band.lines = band.rows * samples_;
  band.samples = samples_;
  const std::size_t count = static_cast<std::size_t>(band.columns) * band.lines;
  band.nearness.assign(count, nowhere);
  band.face.assign(count, Band::nothing);
  for (const std::uint32_t f : faces_of_band_[index]) draw_face(band, f);
  if (!scene_.balls.empty()) {
    band.ball_nearness.assign(count, nowhere);
    band.ball.assign(count, Band::nothing);
    for (std::uint32_t k = 0; k < scene_.balls.size(); ++k) draw_ball(band, k);
  }
  return band;
}

void Raster::draw_face(Band& band, std::uint32_t f) const {
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

void Raster::draw_ball(Band& band, std::uint32_t k) const {
  const Ball& ball = scene_.balls[k];
  const Disc disc = lens_.project_ball(ball.centre, ball.radius);
  for_samples(band, disc.x - disc.radius, disc.x + disc.radius, disc.y - disc.radius, disc.y + disc.radius,
              [&](std::size_t sample, float x, float y) {
                const Disc::Spot spot = disc.at(x, y);
                if (!(spot.height_squared >= 0)) return;
                const float z = disc.z - ball.radius * std::sqrt(spot.height_squared);
                const float nearness = lens_.nearness(std::max(lens_.near, z));
                if (nearness <= band.ball_nearness[sample]) return;
                band.ball_nearness[sample] = nearness;
                band.ball[sample] = k;
              });
}

}  // namespace supple::studio
