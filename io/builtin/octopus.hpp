#pragma once
/// \file Octopus to play with, as an implicit solid: soft limbs about a foot to hold it by.

#include <physics/mesh/tet_mesh.hpp>

namespace supple {

/// An octopus as an implicit solid: round head with eyes, eight arms that curl up, and a foot on the ground,
/// y = 0, which alone reaches below y = 0.04. About 1 m wide, y is up, it looks along +z.
class Octopus {
 public:
  Octopus();
  /// Distance to the surface [m], about: > 0 inside. Smooth but for hairlines; safe from several threads.
  double depth(const Point& x) const;
  BoundingBox box() const;

 private:
  /// A round cone: from a ball of radius r_a about a to one of r_b about b.
  struct Segment {
    Point a, b;
    double r_a, r_b;
  };
  struct Arm {
    std::vector<Segment> segments;
    Point centre;  // of a ball that holds the arm
    double radius;
  };
  std::vector<Arm> arms_;
};

}  // namespace supple
