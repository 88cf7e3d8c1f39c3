#include <physics/system/nodal_frames.hpp>
#include <testing/near.hpp>
#include <tests/support/bars.hpp>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

Matrix3<double> turn(double angle) {
  return Eigen::AngleAxisd(angle, Point(1, -2, 0.5).normalized()).toRotationMatrix();
}

/// What turning an object as a whole is as displacements of its free nodes.
Vector displacement_of(const StvkBar& bar, const Matrix3<double>& R) {
  const Points& X = bar.model().rest_positions();
  const Points u = X * R.transpose() - X;
  return bar.restrict(Eigen::Map<const Vector>(u.data(), u.size()));
}

TEST(NodalFrames, AreTheRotationOfAnObjectThatTurnsAsAWhole) {
  const StvkBar bar = free_bar();
  const Matrix3<double> R = turn(2.5);
  const BlockRotations frames = bar.frames(displacement_of(bar, R)).front();
  for (const Point& e : {Point(1, 0, 0), Point(0, 1, 0), Point(0, 0, 1)}) {
    Vector x = e.replicate(bar.dim() / 3, 1);
    frames.turn(x);
    EXPECT_TRUE(is_near(x, Vector(Point(R * e).replicate(bar.dim() / 3, 1)), 1e-12));
  }
  const Vector x = Vector::LinSpaced(bar.dim(), 0, 1);
  Vector y = x;
  bar.frames(Vector::Zero(bar.dim())).front().turn(y);
  EXPECT_TRUE(is_near(y, x, 1e-13)) << "at rest";
}

// The tangent of an object that has turned as a whole is that of rest between the frames.
TEST(NodalFrames, LeadFromTheStiffnessAtRestToThatOfATurnedObject) {
  const StvkBar bar = free_bar();
  const Vector u = displacement_of(bar, turn(1.3)), x = Vector::LinSpaced(bar.dim(), -1, 2);
  const BlockRotations frames = bar.frames(u).front();
  Vector Kx = x;
  frames.turn_back(Kx);
  Kx = bar.rest_stiffness() * Kx;
  frames.turn(Kx);
  EXPECT_TRUE(is_near(Kx, Vector(bar.stiffness(u) * x), 1e-10 * Kx.norm()));
}

TEST(BlockRotations, TurnBackWhatTheyTurned) {
  const BlockRotations rotations({turn(0.3), turn(-2)});
  const Vector x = Vector::LinSpaced(6, -1, 2);
  Vector y = x;
  rotations.turn(y);
  EXPECT_NEAR(y.norm(), x.norm(), 1e-15);
  EXPECT_GT((y - x).norm(), 0.1);
  rotations.turn_back(y);
  EXPECT_TRUE(is_near(y, x, 1e-14));
  Vector five = Vector::Zero(5);
  EXPECT_THROW(rotations.turn(five), std::invalid_argument);
  BlockRotations().turn(five);  // the identity has any size
}

}  // namespace
}  // namespace supple::test
