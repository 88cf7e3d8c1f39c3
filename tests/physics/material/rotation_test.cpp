#include <physics/material/rotation.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;

/// Of all kinds: close to a rotation, far from it, inverted, flat, in other units.
std::vector<Mat3> gradients() {
  std::vector<Mat3> result{Mat3::Identity(),
                           Point(0.2, 1, 1).asDiagonal(),
                           Point(-0.2, 1, 1.5).asDiagonal(),
                           Point(0, 1, 2).asDiagonal(),
                           1e-9 * random_rotation(8),
                           1e9 * random_rotation(9)};
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    result.push_back(random_rotation(seed));
    result.push_back(random_rotation(seed) * (Mat3::Identity() + Mat3(random_matrix(3, 3, 0.5, seed))));
    result.push_back(random_rotation(seed) * Point(3, 2, -1).asDiagonal() * random_rotation(seed + 99));
  }
  return result;
}

TEST(Polar, GivesTheClosestRotation) {
  for (const Mat3& F : gradients()) {
    const Polar<double> p = polar(F);
    EXPECT_TRUE(is_near(p.R * p.R.transpose(), Mat3::Identity(), 1e-13)) << F;
    EXPECT_NEAR(p.R.determinant(), 1, 1e-13) << F;
    const Eigen::JacobiSVD<Mat3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    const Mat3 closest = svd.matrixU() * Point(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
    const Point s = svd.singularValues();
    const double gap = (s[1] + sign * s[2]) / s[0];
    EXPECT_TRUE(is_near(p.R, closest, 1e-13 / gap)) << F;
    EXPECT_NEAR(p.trace, s[0] + s[1] + sign * s[2], 1e-13 * s[0]) << F;
  }
}

TEST(Polar, OfAPackIsThatOfItsLanes) {
  const std::vector<Mat3> all = gradients();
  for (std::size_t first = 0; first + Pack::size <= all.size(); first += Pack::size) {
    Matrix3<Pack> F;
    for (int lane = 0; lane < Pack::size; ++lane)
      for (int k = 0; k < 9; ++k) F.data()[k].set(lane, all[first + lane].data()[k]);
    const Polar<Pack> p = polar(F);
    for (int lane = 0; lane < Pack::size; ++lane) {
      const Polar<double> expected = polar(all[first + lane]);
      for (int k = 0; k < 9; ++k) EXPECT_NEAR(p.R.data()[k][lane], expected.R.data()[k], 1e-12);
      EXPECT_NEAR(p.trace[lane], expected.trace, 1e-13 * all[first + lane].norm());
    }
  }
}

TEST(PrincipalAxes, DiagonaliseAnySymmetricMatrix) {
  std::vector<Mat3> all{Mat3::Identity(), Mat3::Zero(), Mat3::Ones()};
  for (const Mat3& F : gradients()) all.push_back(F.transpose() * F);
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const Mat3 V = random_rotation(seed);
    all.push_back(V * Point(2, 2, 1).asDiagonal() * V.transpose());
    all.push_back(V * Point(-1, 1e-8, 1).asDiagonal() * V.transpose());
  }
  for (const Mat3& any : all) {
    const Mat3 C = (any + any.transpose()) / 2;
    const PrincipalAxes<double> axes = principal_axes(C);
    EXPECT_TRUE(is_near(axes.vectors.transpose() * axes.vectors, Mat3::Identity(), 1e-14)) << C;
    EXPECT_TRUE(is_near(axes.vectors * axes.values.asDiagonal() * axes.vectors.transpose(), C, 4e-15 * C.norm())) << C;
  }
}

}  // namespace
}  // namespace supple::test
