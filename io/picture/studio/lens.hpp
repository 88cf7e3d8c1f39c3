#pragma once
/// \file Projection of points, balls and triangles onto a raster, as the camera sees them.

#include <io/picture/picture.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::studio {

using Vector3f = Eigen::Vector3f;

/// The nearness of what is not there.
constexpr float nowhere = -std::numeric_limits<float>::infinity();

/// The whole part of any float, also of one beyond the range of int.
inline int whole(float x) {
  return static_cast<int>(std::clamp(x, -1e8f, 1e8f));
}

/// A point on a raster, and how near: a number that grows towards who looks and is linear on the raster.
struct Projection {
  float x, y, nearness;
  bool visible;
};

/// Barycentric coordinates of a projected triangle, as functions that are linear in x and y.
struct Barycentric {
  float ax, ay, bx, by, cx, cy;
  bool flat;  ///< has no area, hence no coordinates

  Barycentric(const Projection& a, const Projection& b, const Projection& c) : ax(a.x), ay(a.y) {
    const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    flat = area == 0;
    bx = (c.y - a.y) / area, by = -(c.x - a.x) / area;
    cx = -(b.y - a.y) / area, cy = (b.x - a.x) / area;
  }

  /// Shares of b and c; that of a is what they leave of 1.
  float beta(float x, float y) const { return bx * (x - ax) + by * (y - ay); }
  float gamma(float x, float y) const { return cx * (x - ax) + cy * (y - ay); }
  Vector3f at(float x, float y) const {
    const float b = beta(x, y), c = gamma(x, y);
    return {1 - b - c, b, c};
  }

  /// Distance in pixels to the nearest edge.
  float to_edge(const Vector3f& at) const {
    return std::min({at[0] / std::hypot(bx + cx, by + cy), at[1] / std::hypot(bx, by), at[2] / std::hypot(cx, cy)});
  }
};

/// What a ball shows as; without radius if it is not seen.
struct Disc {
  float x, y, radius;
  float z;  ///< of the ball's centre, along the view

  /// A place on the disc: across and down [radii], and the square of the ball's height there, negative outside.
  struct Spot {
    float across, down, height_squared;
  };
  Spot at(float px, float py) const {
    const float across = (px - x) / radius, down = (py - y) / radius;
    return {across, down, 1 - across * across - down * down};
  }
};

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

  float nearness(float z) const { return perspective ? 1 / z : -z; }
  float magnification(float z) const { return perspective ? pixels / z : pixels; }

  Projection project(const Vector3f& p) const {
    const Vector3f q = p - eye;
    const float z = forward.dot(q);
    if (z < near) return {0, 0, 0, false};
    const float scale = magnification(z);
    return {middle_x + scale * right.dot(q), middle_y - scale * up.dot(q), nearness(z), true};
  }
  Disc project_ball(const Vector3f& centre, float radius) const {
    const Projection middle = project(centre);
    const float z = forward.dot(centre - eye);
    return {middle.x, middle.y, middle.visible ? radius * magnification(z) : 0, z};
  }

  Vector3f to_eye(const Vector3f& p) const { return perspective ? (eye - p).normalized() : Vector3f(-forward); }
};

}  // namespace supple::studio
