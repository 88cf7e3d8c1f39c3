#pragma once
/// \file Training poses: random points of the subspace, scaled by the object's own stiffness, or states observed.

#include <core/random.hpp>
#include <reduction/system/pose_sweep.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/training/pose_options.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>

namespace supple {

struct TrainingPoses {
  Matrix Q;                       ///< d × T, reduced coordinates
  Index inverted = 0;             ///< poses with an inverted component as first drawn
  Index inverted_components = 0;  ///< how many components were inverted, over all poses as first drawn
  Index redrawn = 0;              ///< draws that were thrown away
  Index shrunk = 0;               ///< poses that were scaled down
};

/// Observed states in the coordinates of the subspace: d × T as they are, n · node_dim × T displacements (temperatures)
/// by projection in the mass norm, Uᵀ M u.
template <Subspace S>
Matrix poses_in_subspace(const S& subspace, const Vector& nodal_mass, const Matrix& given) {
  require(given.allFinite(), "given_poses hold a number that is not finite");
  if (given.rows() == subspace.dim()) return given;
  require_size("given_poses.rows()", given.rows(), subspace.full_dim());
  const Index node_dim = subspace.full_dim() / nodal_mass.size();
  const Vector mass = nodal_mass.replicate(1, node_dim).transpose().reshaped();
  Matrix Q(subspace.dim(), given.cols());
  for (Index t = 0; t < given.cols(); ++t) Q.col(t) = subspace.project(mass.cwiseProduct(given.col(t)));
  return Q;
}

/// Coordinates of one random pose of unit expected rms displacement; see PoseOptions.
class PoseSampler {
 public:
  /// \param total_mass  Σ m_v; the basis is M-orthonormal, so ‖q‖² / total_mass is the mean square
  /// displacement.
  PoseSampler(const ReducedModes& modes, double omega_exponent, double total_mass);
  Vector draw(Random& random) const;

 private:
  Matrix Phi_;
  Vector deviations_;
};

/// Counts the poses with inverted components and treats them by the rule.
/// \param draw  another pose in place of pose t, for InvertedPoses::Redraw; without it such poses are shrunk.
/// \throws SolverError if a pose stays inverted however small.
template <ForceModel Model, Subspace S>
TrainingPoses treat_inverted(const std::shared_ptr<const Model>& model, const S& subspace, Matrix Q, InvertedPoses rule,
                             const std::function<Vector(Index t)>& draw = {}) {
  TrainingPoses poses{.Q = std::move(Q)};
  std::vector<Index> bad;
  const std::vector<Index> inverted = count_inverted(model, subspace, poses.Q);
  for (Index t = 0; t < poses.Q.cols(); ++t)
    if (inverted[t] > 0) {
      bad.push_back(t);
      poses.inverted_components += inverted[t];
    }
  poses.inverted = static_cast<Index>(bad.size());
  if (rule == InvertedPoses::Keep) return poses;

  const auto still_bad = [&] {
    const std::vector<Index> counts = count_inverted(model, subspace, poses.Q(Eigen::all, bad));
    std::vector<Index> rest;
    for (std::size_t k = 0; k < bad.size(); ++k)
      if (counts[k] > 0) rest.push_back(bad[k]);
    return rest;
  };
  if (rule == InvertedPoses::Redraw && draw)
    for (int attempt = 0; attempt < 20 && !bad.empty(); ++attempt) {
      for (const Index t : bad) poses.Q.col(t) = draw(t);
      poses.redrawn += static_cast<Index>(bad.size());
      bad = still_bad();
    }
  poses.shrunk = static_cast<Index>(bad.size());
  for (int attempt = 0; !bad.empty(); ++attempt) {
    if (attempt == 60)
      throw SolverError("pose " + std::to_string(bad[0]) + " has inverted components however small it is made");
    for (const Index t : bad) poses.Q.col(t) *= 0.75;
    bad = still_bad();
  }
  return poses;
}

/// \param diagonal  of the object's bounding box at rest [m].
/// \throws std::invalid_argument for options out of range; SolverError if a pose stays inverted however
/// small.
template <ForceModel Model, Subspace S>
TrainingPoses sample_poses(const std::shared_ptr<const Model>& model, const S& subspace, const ReducedModes& modes,
                           double total_mass, double diagonal, const PoseOptions& options) {
  require(options.count >= 1, "number of poses is " + std::to_string(options.count) + ", expected at least 1");
  require(!options.amplitudes.empty(), "no amplitude is given for the poses");
  for (const double a : options.amplitudes)
    require(std::isfinite(a) && a > 0, "amplitude of the poses is " + std::to_string(a) + ", expected > 0");
  const PoseSampler sampler(modes, options.omega_exponent, total_mass);
  Random random(options.seed);
  const auto draw = [&](Index t) -> Vector {
    return options.amplitudes[t % options.amplitudes.size()] * diagonal * sampler.draw(random);
  };
  Matrix Q(subspace.dim(), options.count);
  for (Index t = 0; t < options.count; ++t) Q.col(t) = draw(t);
  return treat_inverted(model, subspace, std::move(Q), options.inverted.value_or(InvertedPoses::Keep), draw);
}

}  // namespace supple
