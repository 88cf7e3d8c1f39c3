#pragma once
/// \file Scene of a picture: triangles and balls of all its objects in one list, relative to the view's centre.

#include <io/picture/picture.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace supple::studio {

using Vector3f = Eigen::Vector3f;

struct Face {
  std::array<std::uint32_t, 3> vertices;  ///< counter-clockwise from outside
  std::array<Vector3f, 3> normals;        ///< of the corners
  std::uint32_t object = 0;
  bool highlighted = false;
};

struct Ball {
  Vector3f centre;
  float radius;
  Vector3f albedo;
};

/// What marks an object's triangles.
struct Finish {
  Vector3f highlight;  ///< albedo of the highlighted ones
  double edges;        ///< how dark their edges are
};

struct Scene {
  std::vector<Vector3f> vertices;
  std::vector<Vector3f> albedo;  ///< of the vertices
  std::vector<Face> faces;
  std::vector<Ball> balls;
  std::vector<Finish> finishes;  ///< of the objects
};

Scene build_scene(std::span<const PictureObject> objects, ColourMap map, const View& view);

}  // namespace supple::studio
