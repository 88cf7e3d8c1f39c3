#pragma once
/// \file Light of a picture: many far lamps, each with a map of what it meets first, hence soft shadows and darkness in
/// hollows.

#include <io/picture/studio/lens.hpp>
#include <io/picture/studio/scene.hpp>

#include <array>
#include <cstdint>
#include <vector>

namespace supple::studio {

/// Points of surfaces with their normals, coordinate by coordinate.
struct SurfacePoints {
  std::array<std::vector<float>, 3> x, n;
};

/// A lamp infinitely far away in direction `towards`.
struct Lamp {
  Vector3f towards, across, along;
  float radius;                ///< of the scene around the origin
  int size;                    ///< of the map along each side [texels]
  std::vector<float> nearest;  ///< per texel, how far towards the lamp the scene reaches; nowhere in the outermost ones

  Lamp(const Vector3f& direction, float scene_radius, int map_size);
  /// Draws the map.
  void look_at(const Scene& scene);
  /// Adds weight · cosine · share of light that reaches each point, by the four texels around it.
  void shine_on(const SurfacePoints& points, float weight, std::vector<float>& sum) const;

 private:
  float texel() const { return 2 * radius / static_cast<float>(size - 2); }
  Projection to_map(const Vector3f& p) const;
};

/// A bright sky, and a key lamp in front of it that is wide enough for soft shadows.
struct Lighting {
  std::vector<Lamp> sky, key;
  std::vector<float> sky_radiance;
  float sky_on_ground = 0, key_on_ground = 0;  ///< unobstructed
  Vector3f up, key_towards, rim_towards;
  float ground_height, radius;
};
Lighting set_up_lights(const Scene& scene, const View& view);

/// A place whose light is wanted: a piece of surface in a pixel.
struct Place {
  Vector3f position = Vector3f::Zero(), normal = Vector3f::Zero(), albedo = Vector3f::Zero();
  float weight = 1;  ///< of its colour in the pixel
  std::uint32_t pixel = 0;
  bool shaded = true;  ///< markers are signs: no shadow falls on them
  float sky = 0, key = 0;
};

/// Sets the places' light from sky and key.
void gather_light(const Lighting& light, std::vector<Place>& places);

/// What the camera sees of a lit place: matt, with some gloss and a bright rim, then the shoulder of a film.
Vector3f seen(const Place& place, const Lighting& light, const Vector3f& to_eye);

/// Light on a place of the ground, as a share of what nothing in the way would leave.
float share_on_ground(const Place& place, const Lighting& light);

}  // namespace supple::studio
