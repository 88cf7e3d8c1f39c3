#include <io/builtin/octopus.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {
namespace {

/// The smaller of two distances, rounded off within k of where they are equal (Quilez' quadratic smooth
/// minimum).
double smooth_min(double a, double b, double k) {
  const double h = std::max(k - std::abs(a - b), 0.0) / k;
  return std::min(a, b) - h * h * k / 4;
}

/// Distance to an ellipsoid, to first order near its surface.
double ellipsoid_distance(const Point& x, const Point& centre, const Point& radii) {
  const Point y = (x - centre).cwiseQuotient(radii);
  const double length = y.norm();
  return length < 1e-9 ? -radii.minCoeff() : length * (length - 1) / y.cwiseQuotient(radii).norm();
}

/// A point of the Catmull–Rom spline through the controls, t ∈ [0, 1].
template <std::size_t n>
Point spline(const std::array<Point, n>& controls, double t) {
  const double scaled = t * static_cast<double>(n - 1);
  const auto k = std::min(static_cast<std::size_t>(scaled), n - 2);
  const double s = scaled - static_cast<double>(k);
  const Point &p1 = controls[k], &p2 = controls[k + 1];
  const Point p0 = k > 0 ? controls[k - 1] : Point(2 * p1 - p2);
  const Point p3 = k + 2 < n ? controls[k + 2] : Point(2 * p2 - p1);
  return p1 + s / 2 * ((p2 - p0) + s * ((2 * p0 - 5 * p1 + 4 * p2 - p3) + s * (3 * (p1 - p2) + p3 - p0)));
}

}  // namespace

Octopus::Octopus() {
  constexpr int num_arms = 8, num_segments = 14;
  for (int k = 0; k < num_arms; ++k) {
    const double angle = 2 * std::numbers::pi * (k + 0.5) / num_arms;
    const double lift = k % 2 == 0 ? 0.0 : 0.07, reach = k % 2 == 0 ? 1.0 : 0.86;
    const double sway = (k % 4 < 2 ? 1 : -1) * 0.05;
    const Point outward(std::sin(angle), 0, std::cos(angle)), sideways(outward[2], 0, -outward[0]);
    const auto at = [&](double r, double y, double s) -> Point {
      return reach * r * outward + Point(0, y, 0) + s * sway * sideways;
    };
    const std::array<Point, 7> controls{at(0.05, 0.225, 0),
                                        at(0.18, 0.19, 0),
                                        at(0.30, 0.12 + lift / 2, 0.3),
                                        at(0.42, 0.13 + lift, 0.8),
                                        at(0.485, 0.235 + lift, 1.2),
                                        at(0.44, 0.325 + lift, 1.6),
                                        at(0.365, 0.30 + lift, 1.8)};
    const auto radius = [](double t) { return 0.068 - 0.040 * t; };
    Arm arm;
    for (int j = 0; j < num_segments; ++j) {
      const double t = static_cast<double>(j) / num_segments, t_next = static_cast<double>(j + 1) / num_segments;
      arm.segments.push_back({spline(controls, t), spline(controls, t_next), radius(t), radius(t_next)});
    }
    arm.centre = (controls.front() + controls[4]) / 2;
    arm.radius = 0;
    for (const Segment& s : arm.segments)
      arm.radius = std::max({arm.radius, (s.a - arm.centre).norm() + s.r_a, (s.b - arm.centre).norm() + s.r_b});
    arms_.push_back(std::move(arm));
  }
}

double Octopus::depth(const Point& x) const {
  constexpr double blend = 0.05;
  double distance = ellipsoid_distance(x, {0, 0.50, -0.02}, {0.185, 0.225, 0.185});
  distance = smooth_min(distance, ellipsoid_distance(x, {0, 0.245, 0}, {0.13, 0.13, 0.13}), 0.12);
  // The foot: a disc with a round rim under a short stem.
  const double from_axis = std::hypot(x[0], x[2]);
  const double foot = std::hypot(std::max(from_axis - 0.12, 0.0), x[1] - 0.03) - 0.03;
  const double stem = std::hypot(from_axis, std::max({0.03 - x[1], x[1] - 0.2, 0.0})) - 0.09;
  distance = smooth_min(distance, smooth_min(foot, stem, 0.08), 0.08);
  double arms = 1e9;
  for (const Arm& arm : arms_) {
    const double far = (x - arm.centre).norm() - arm.radius;
    if (far > std::min(arms, distance) + blend) continue;  // too far to be felt
    double nearest = 1e9;
    for (const Segment& s : arm.segments) {
      const Point axis = s.b - s.a;
      const double t = std::clamp((x - s.a).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
      nearest = std::min(nearest, (x - s.a - t * axis).norm() - (s.r_a + t * (s.r_b - s.r_a)));
    }
    arms = smooth_min(arms, nearest, 0.03);
  }
  distance = smooth_min(distance, arms, blend);
  for (const double side : {-1, 1})
    distance = smooth_min(distance, (x - Point(side * 0.088, 0.462, 0.138)).norm() - 0.06, 0.015);
  return -std::max(distance, -x[1]);
}

BoundingBox Octopus::box() const {
  return {Point(-0.56, 0, -0.56), Point(0.56, 0.74, 0.56)};
}

}  // namespace supple
