#include <core/check.hpp>
#include <core/random.hpp>
#include <reduction/editing/handles.hpp>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>

namespace supple {

RigidMotion RigidMotion::turn(const Point& axis, double angle, const Point& centre, const Point& translation) {
  require(axis.norm() > 0 && axis.allFinite(), "the axis of a turn has no direction");
  RigidMotion motion;
  motion.rotation = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  motion.translation = centre - motion.rotation * centre + translation;
  return motion;
}

RigidMotion RigidMotion::from(const Eigen::Matrix4d& matrix, double tolerance) {
  const Eigen::Matrix3d A = matrix.topLeftCorner<3, 3>();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(A, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  require(matrix.allFinite() && (A - R).norm() < tolerance && R.determinant() > 0 &&
              (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < tolerance,
          "the matrix of a handle is no rigid motion");
  RigidMotion motion;
  motion.rotation = R;
  motion.translation = matrix.topRightCorner<3, 1>();
  return motion;
}

Eigen::Matrix4d RigidMotion::matrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation;
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

RigidMotion RigidMotion::fit(const Points& before, const Points& after) {
  require(before.rows() > 0, "there are no points to fit a motion to");
  require_size("after", after.rows(), before.rows());
  const Eigen::RowVector3d from = before.colwise().mean(), to = after.colwise().mean();
  const Eigen::Matrix3d spread = (after.rowwise() - to).transpose() * (before.rowwise() - from);
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(spread, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d U = svd.matrixU(), V = svd.matrixV();
  const Point signs(1, 1, (U * V.transpose()).determinant() < 0 ? -1 : 1);  // a rotation, no reflection
  RigidMotion motion;
  motion.rotation = U * signs.asDiagonal() * V.transpose();
  motion.translation = to.transpose() - motion.rotation * from.transpose();
  return motion;
}

RigidMotion RigidMotion::part(double s, const Point& centre) const {
  const Eigen::AngleAxisd turn(rotation);
  const Point moved = s * ((*this)(centre)-centre);
  return RigidMotion::turn(turn.axis(), s * turn.angle(), centre, moved);
}

Handle::Handle(const std::vector<Index>& nodes, Index count, double w, std::uint64_t seed) : weight(w) {
  require(!nodes.empty(), "a handle has no nodes");
  require(count >= 1, "the number of samples of a handle is " + std::to_string(count) + ", expected at least 1");
  require(std::isfinite(w) && w > 0, "the weight of a handle is " + std::to_string(w) + ", expected > 0");
  samples = Random(seed).sample(nodes, std::min(count, static_cast<Index>(nodes.size())));
  std::sort(samples.begin(), samples.end());
}

Point Handle::centre(const Points& rest_positions) const {
  return rest_positions(samples, Eigen::all).colwise().mean().transpose();
}

Loads handle_loads(const std::vector<Handle>& handles, const Points& rest_positions) {
  Loads loads;
  for (const Handle& handle : handles)
    for (const Index v : handle.samples) {
      require(v >= 0 && v < rest_positions.rows(), "a handle names node " + std::to_string(v) + ", expected 0 to " +
                                                       std::to_string(rest_positions.rows() - 1));
      const Point x = rest_positions.row(v).transpose();
      loads.springs.push_back({v, 2 * handle.weight, handle.motion(x) - x});
    }
  return loads;
}

double default_handle_stiffness(double softest_eigenvalue, double mass) {
  return 1e5 * softest_eigenvalue * mass;
}

double control_energy(const Handle& handle, const Points& rest_positions, VectorIn displacement) {
  double sum = 0;
  for (const PointSpring& spring : handle_loads({handle}, rest_positions).springs)
    sum += 0.5 * spring.stiffness * (displacement.segment<3>(3 * spring.node) - spring.displacement).squaredNorm();
  return sum;
}

double control_displacement(const std::vector<Handle>& handles, const Points& rest_positions, VectorIn displacement,
                            double softest_eigenvalue, double mass) {
  double energy = 0;
  for (const Handle& handle : handles) {
    const double stiffness = 2 * handle.weight * static_cast<double>(handle.samples.size());
    energy += control_energy(handle, rest_positions, displacement) *
              std::max(1.0, stiffness / default_handle_stiffness(softest_eigenvalue, mass));
  }
  return std::sqrt(2 * energy / (softest_eigenvalue * mass));
}

}  // namespace supple
