#pragma once
/// \file Handles: parts of an object that a user grasps and moves rigidly.

#include <core/check.hpp>
#include <core/types.hpp>
#include <physics/load/loads.hpp>

#include <Eigen/Geometry>

#include <cstdint>
#include <vector>

namespace supple {

/// x ↦ R x + t of points in space.
struct RigidMotion {
  Matrix3<double> rotation = Matrix3<double>::Identity();
  Point translation = Point::Zero();  ///< [m]

  Point operator()(const Point& x) const { return rotation * x + translation; }

  /// First `first`, then this.
  RigidMotion after(const RigidMotion& first) const { return {rotation * first.rotation, (*this)(first.translation)}; }
  Eigen::Matrix4d matrix() const;  ///< acting on (x, 1), what from() takes
  RigidMotion inverse() const { return {rotation.transpose(), -(rotation.transpose() * translation)}; }

  /// A turn by `angle` [rad] about an axis through a centre [m], then a translation [m].
  static RigidMotion turn(const Point& axis, double angle, const Point& centre,
                          const Point& translation = Point::Zero());
  /// \param matrix  4 × 4, acting on (x, 1). \throws std::invalid_argument unless it is a rigid motion to `tolerance`; its
  /// rotation is the nearest proper one.
  static RigidMotion from(const Eigen::Matrix4d& matrix, double tolerance = 1e-4);
  /// The motion that takes some points nearest to where they have gone, least squares. \see Kabsch 1976.
  static RigidMotion fit(const Points& before, const Points& after);
  /// The share s ∈ [0, 1] of the motion of a body about `centre`: its rotation at constant speed about a fixed axis,
  /// its translation along a line.
  RigidMotion part(double s, const Point& centre) const;
};

/// One handle: nodes of which a random sample C is pulled to where a rigid motion takes them, with the energy
/// w Σ_{i ∈ C} ‖v_i − v'_i‖² (Sec. 6).
struct Handle {
  std::vector<Index> samples;  ///< C, ascending
  double weight = 0;           ///< w [N/m]
  RigidMotion motion = {};

  /// \param nodes   of the handle region; \param count  |C| at most.  \param weight  w [N/m], > 0.
  Handle(const std::vector<Index>& nodes, Index count, double weight, std::uint64_t seed = 1);

  Point centre(const Points& rest_positions) const;  ///< mean of the samples at rest [m]
};

/// The control energy of some handles as springs of stiffness 2 w to the prescribed positions.
/// \throws std::invalid_argument for a sample that is no node.
Loads handle_loads(const std::vector<Handle>& handles, const Points& rest_positions);

/// How stiff the springs of a handle are together where nobody states it: 10⁵ times as stiff as the object against a
/// translation along its softest mode, 10⁵ λ₁ M [N/m]. \param softest_eigenvalue  λ₁ [1/s²]. \param mass  M [kg].
double default_handle_stiffness(double softest_eigenvalue, double mass);

/// E^C of a handle on an object with these displacements of all nodes, w Σ ‖v − v'‖² [J].
double control_energy(const Handle& handle, const Points& rest_positions, VectorIn displacement);

/// What handles hold, as a length [m]: √(2 E / (λ₁ M)), how far the energy E of their springs would displace the object along
/// its softest mode (rms). The springs of a full object hold next to nothing; those of a subspace that cannot follow its
/// handles hold the energy by which its shape lies above the full one, so this bounds, roughly, how far off the shape is. In
/// springs stiffer than default_handle_stiffness() the same forces hold less: E is what they would hold in those.
double control_displacement(const std::vector<Handle>& handles, const Points& rest_positions, VectorIn displacement,
                            double softest_eigenvalue, double mass);

/// From here on the shapes of a subspace are off (docs/decisions): so much may handles hold, as a share of the diagonal.
inline constexpr double held_over_diagonal_at_most = 0.01;

}  // namespace supple
