#include <core/parallel.hpp>
#include <io/picture/studio/lighting.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace supple::studio {

namespace {

constexpr int num_sky_lights = 128, num_key_lights = 48;
constexpr int sky_map_size = 160, key_map_size = 384;  // texels along each side
constexpr float key_radius = 0.11f;                    // of the lamp, at distance 1: how soft shadows are
const Vector3f key_colour{1.04f, 1.f, 0.94f}, sky_colour{0.94f, 0.98f, 1.04f};
constexpr float key_strength = 0.92f, sky_strength = 0.62f, bounce_strength = 0.22f, rim_strength = 0.22f;
constexpr float gloss = 0.10f, gloss_exponent = 28;
constexpr float golden_angle = 2.3999632f;  // spreads the lights evenly

}  // namespace

Lamp::Lamp(const Vector3f& direction, float scene_radius, int map_size)
    : towards(direction.normalized()),
      across(towards.unitOrthogonal()),
      along(towards.cross(across)),
      radius(scene_radius),
      size(map_size) {}

Projection Lamp::to_map(const Vector3f& p) const {
  const float scale = 1 / texel(), middle = 0.5f * static_cast<float>(size);
  return {middle + scale * across.dot(p), middle + scale * along.dot(p), towards.dot(p), true};
}

void Lamp::look_at(const Scene& scene) {
  nearest.assign(static_cast<std::size_t>(size) * size, nowhere);
  std::vector<Projection> vertices(scene.vertices.size());
  std::ranges::transform(scene.vertices, vertices.begin(), [this](const Vector3f& p) { return to_map(p); });
  const auto first_texel = [](float low) { return std::max(1, whole(std::ceil(low - 0.5f))); };
  const auto last_texel = [this](float high) { return std::min(size - 2, whole(std::floor(high - 0.5f))); };
  for (const Face& face : scene.faces) {
    const Projection &a = vertices[face.vertices[0]], &b = vertices[face.vertices[1]], &c = vertices[face.vertices[2]];
    const int x0 = first_texel(std::min({a.x, b.x, c.x})), x1 = last_texel(std::max({a.x, b.x, c.x}));
    const int y0 = first_texel(std::min({a.y, b.y, c.y})), y1 = last_texel(std::max({a.y, b.y, c.y}));
    if (x0 > x1 || y0 > y1) continue;
    const Barycentric barycentric(a, b, c);
    if (barycentric.flat) continue;
    for (int j = y0; j <= y1; ++j) {
      const float y = static_cast<float>(j) + 0.5f;
      float* row = nearest.data() + static_cast<std::size_t>(j) * size;
      for (int i = x0; i <= x1; ++i) {
        const float x = static_cast<float>(i) + 0.5f;
        const float beta = barycentric.beta(x, y), gamma = barycentric.gamma(x, y);
        if (beta < 0 || gamma < 0 || beta + gamma > 1) continue;
        row[i] = std::max(row[i], a.nearness + beta * (b.nearness - a.nearness) + gamma * (c.nearness - a.nearness));
      }
    }
  }
}

void Lamp::shine_on(const SurfacePoints& points, float weight, std::vector<float>& sum) const {
  const float scale = 0.5f * static_cast<float>(size) / radius, middle = 0.5f * static_cast<float>(size) - 0.5f;
  const float off_surface = 1.8f * texel(), tolerance = 0.3f * texel(), last = static_cast<float>(size) - 1.001f;
  const float *px = points.x[0].data(), *py = points.x[1].data(), *pz = points.x[2].data();
  const float *nx = points.n[0].data(), *ny = points.n[1].data(), *nz = points.n[2].data();
  const float *texels = nearest.data(), *above = texels + size;
  float* total = sum.data();
  const int count = static_cast<int>(sum.size()), stride = size;
  const Vector3f t = towards, u = scale * across, v = scale * along;
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC ivdep
#endif
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

Lighting set_up_lights(const Scene& scene, const View& view) {
  Lighting light;
  const Vector3f up = view.ground_up.cast<float>(), right = view.right.cast<float>(), front = right.cross(up);
  const float radius = static_cast<float>(view.radius);
  light.up = up;
  light.radius = radius;
  light.ground_height = static_cast<float>(view.ground_height - view.ground_up.dot(view.centre));
  light.key_towards = (-0.62f * right + 1.0f * up + 0.62f * front).normalized();
  light.rim_towards = (0.75f * right + 0.45f * up - 0.7f * front).normalized();

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

void gather_light(const Lighting& light, std::vector<Place>& places) {
  // Lamp after lamp, so that neighbours read neighbouring texels of one map, in blocks that stay in the
  // cache.
  constexpr std::size_t block = 4096;
  for (std::size_t begin = 0; begin < places.size(); begin += block) {
    const std::size_t count = std::min(block, places.size() - begin);
    SurfacePoints points;
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

float share_on_ground(const Place& place, const Lighting& light) {
  const float free = key_strength * light.key_on_ground + sky_strength;
  return (key_strength * place.key + sky_strength * place.sky) / free;
}

}  // namespace supple::studio
