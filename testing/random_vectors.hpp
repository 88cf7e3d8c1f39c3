#pragma once
/// \file Random vectors, matrices and rotations from a seed.

#include <core/random.hpp>
#include <core/types.hpp>

#include <Eigen/Geometry>

namespace supple::test {

/// Entries uniform in [−amplitude, amplitude].
inline Matrix random_matrix(Index rows, Index cols, double amplitude, std::uint64_t seed) {
  Random random(seed);
  return Matrix::NullaryExpr(rows, cols, [&](Index, Index) { return amplitude * (2 * random.uniform() - 1); });
}
inline Vector random_vector(Index size, double amplitude, std::uint64_t seed) {
  return random_matrix(size, 1, amplitude, seed);
}
/// Uniformly distributed in SO(3) (Shoemake 1992: a normalised Gaussian quaternion).
inline Matrix3<double> random_rotation(std::uint64_t seed) {
  Random random(seed);
  const double w = random.normal(), x = random.normal(), y = random.normal(), z = random.normal();
  return Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
}

}  // namespace supple::test
