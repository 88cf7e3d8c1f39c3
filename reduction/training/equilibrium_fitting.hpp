#pragma once
/// \file Fitting problem where objects come to rest: poses in equilibrium, errors of the force as displacements.

#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/statics/static_solver.hpp>
#include <reduction/training/force_fitting.hpp>

namespace supple {

/// Equilibria of a reduced system under random loads: of those whose linear response are the columns of Q (d × T). What
/// has no energy is held by springs as stiff as the softest flexible mode.
/// \param system  a rough selection will do: the poses need not be equilibria of all components.
/// \return d × T. Poses that the solver does not finish are where it stopped, at worst the linear response.
template <DynamicalSystem System>
Matrix equilibrium_poses(const System& system, const ReducedModes& modes, MatrixIn Q) {
  const auto rigid = modes.Phi.leftCols(modes.num_zero);
  Matrix springs;
  if (modes.num_zero > 0) springs = modes.softest_stiffness() * rigid * rigid.transpose();
  Matrix poses = Q;
  parallel_for(Q.cols(), [&](Index t) {
    StaticSolver solver(system, {.tolerance = 1e-4, .max_iterations = 60});
    Vector q = Vector::Zero(Q.rows());
    const SolveReport report = solver.solve({system.rest_stiffness() * Q.col(t), springs}, q);
    if (report.status != Status::NotFinite && q.norm() > 0) poses.col(t) = q;
  });
  return poses;
}

/// Rows of how far errors of the force move an object that is in equilibrium: of component i at pose t
///   Lₜ f̄ᵢ(q_t),  Lₜ = Λ⁻¹ Vᵀ / ‖q_t‖
/// with the `rank` softest eigenpairs of the tangent there (not at rest: poses are stiffer here and softer there).
/// At rest under loads stiff modes have relaxed; forces are small, and errors that drown in those of random poses
/// displace soft modes. Equal to ‖Δq‖ / ‖q_t‖ for small errors Δf̄ = K̄(q_t) Δq along these modes. What the components are
/// to add up to are the forces of all of them, F̄(q_t), or others: those of the full object, relaxed (see Relaxation).
/// A BlockFittingProblem, FullGradientProblem and GroupedFittingProblem (groups are poses).
template <ForceModel Model, Subspace S>
class EquilibriumFitting {
  static constexpr int block = S::block;

 public:
  using Columns = DenseColumns;

  /// \param poses    d × T, none without force.
  /// \param targets  d × T, what the components are to add up to; empty: the forces of all of them.
  /// \param tangent  K̄(q), d × d: that of a rough selection will do.
  /// \param softest  the lowest eigenvalue to be told from zero, such as the softest flexible one at rest: divisors are
  /// kept above a quarter of it.
  /// \param rank     eigenpairs for each pose.
  /// \param scale    of all rows.
  EquilibriumFitting(std::shared_ptr<const Model> model, std::shared_ptr<const S> subspace, const Matrix& poses,
                     const Matrix& targets, const std::function<Matrix(VectorIn q)>& tangent, double softest,
                     Index rank, double scale = 1)
      : forces_(std::move(model), std::move(subspace), Matrix::Identity(poses.rows(), poses.rows()), poses),
        targets_(targets.size() > 0 ? targets : forces_.forces()),
        softest_(softest),
        scale_(scale),
        L_(poses.cols()) {
    require_size("targets.rows()", targets_.rows(), poses.rows());
    require_size("targets.cols()", targets_.cols(), poses.cols());
    parallel_for(poses.cols(),
                 [&](Index t) { L_[t] = displacements(tangent(poses.col(t)), t, std::min(rank, poses.rows())); });
    complete();
  }

  /// The same poses by the tangents of a fitted system. Errors of the fit couple soft modes to stiff ones, which makes
  /// the object softer than its errors along soft modes tell; its own tangents tell. Poses at which they say that it is
  /// displaced by more than `trusted` of the pose, where the response is not linear, keep their rows.
  /// \param system  of the same subspace.
  template <DynamicalSystem System>
  EquilibriumFitting with_tangents_of(const System& system, double trusted = 0.3) const {
    std::vector<Matrix> L = L_;
    parallel_for(num_groups(), [&](Index t) {
      const auto q = poses().col(t);
      const Matrix own = displacements(system.stiffness(q), t, L_[t].rows());
      if ((own * (system.force(q) - targets_.col(t))).norm() < trusted * scale_) L[t] = own;
    });
    return {forces_, targets_, std::move(L), softest_, scale_};
  }

  Index rows() const { return b_.size(); }  ///< rank · T
  Index cols() const { return forces_.cols(); }
  const Vector& rhs() const { return b_; }
  const Matrix& poses() const { return forces_.poses(); }
  double scale() const { return scale_; }  ///< of all rows

  void column(Index j, VectorOut out) const { out = columns(std::span<const Index>(&j, 1)).values().col(0); }

  DenseColumns columns(std::span<const Index> js) const {
    const auto count = static_cast<Index>(js.size());
    const Index d = poses().rows(), T = num_groups(), r = rows() / T;
    const auto local = forces_.columns(js);
    Matrix A(rows(), count);
    constexpr Index at_once = 48, poses_at_once = 16;  // their forces fit into a core's own cache
    parallel_ranges(count, at_once, [&](Index begin, Index end) {
      Matrix f(d, at_once * poses_at_once);
      for (Index first = 0; first < T; first += poses_at_once) {
        const Index some = std::min(poses_at_once, T - first);
        for (Index k = begin; k < end; ++k)
          local.forces_by_axis(k, first, f.middleCols((k - begin) * poses_at_once, some));
        for (Index t = 0; t < some; ++t) {
          const Eigen::Map<const Matrix, 0, Eigen::OuterStride<>> f_t(f.col(t).data(), d, end - begin,
                                                                      Eigen::OuterStride<>(d * poses_at_once));
          A.block((first + t) * r, begin, r, end - begin) = (f_t.transpose() * L_by_axis_[first + t]).transpose();
        }
      }
    });
    return DenseColumns({js.begin(), js.end()}, std::move(A));
  }

  /// Root mean square over the poses of ‖Δq‖ / ‖q_t‖.
  double error(std::span<const Index> indices, VectorIn weights) const {
    return (columns(indices).times(weights) - b_).norm() / (scale_ * std::sqrt(static_cast<double>(num_groups())));
  }

  Vector transpose_times(VectorIn r) const {
    require_size("r", r.size(), rows());
    const Index rank = rows() / num_groups();
    Matrix pulled(poses().rows(), num_groups());
    for (Index t = 0; t < num_groups(); ++t) {
      const Vector by_axis = L_by_axis_[t] * r.segment(t * rank, rank);
      pulled.col(t) = by_axis.reshaped(pulled.rows() / block, block).transpose().reshaped();
    }
    return forces_.transpose_times(pulled.reshaped());
  }
  Vector squared_norms() const {
    Vector result(cols());
    constexpr Index at_once = 2048;
    for (Index begin = 0; begin < cols(); begin += at_once) {
      std::vector<Index> js(std::min(at_once, cols() - begin));
      for (std::size_t k = 0; k < js.size(); ++k) js[k] = begin + static_cast<Index>(k);
      result.segment(begin, js.size()) = columns(js).squared_norms();
    }
    return result;
  }

  Index num_groups() const { return static_cast<Index>(L_.size()); }  ///< T
  EquilibriumFitting restricted_to(std::span<const Index> poses) const {
    std::vector<Matrix> L;
    for (const Index t : poses) L.push_back(L_[t]);
    return {forces_.restricted_to(poses), targets_(Eigen::all, poses), std::move(L), softest_, scale_};
  }

 private:
  EquilibriumFitting(ForceFitting<Model, S> forces, Matrix targets, std::vector<Matrix> L, double softest, double scale)
      : forces_(std::move(forces)), targets_(std::move(targets)), softest_(softest), scale_(scale), L_(std::move(L)) {
    complete();
  }

  /// Lₜ of a tangent at pose t, times the scale (rank × d).
  Matrix displacements(const Matrix& tangent, Index t, Index rank) const {
    const SymmetricEigen pairs = symmetric_eigen(tangent);
    const Vector divisors = pairs.values.head(rank).cwiseAbs().cwiseMax(0.25 * softest_);
    return scale_ / poses().col(t).norm() * divisors.cwiseInverse().asDiagonal() *
           pairs.vectors.leftCols(rank).transpose();
  }

  void complete() {
    const Index r = L_.front().rows();
    b_.resize(r * num_groups());
    for (Index t = 0; t < num_groups(); ++t) {
      L_by_axis_.push_back(forces_.forces().col(t).norm() * rows_by_axis<block>(L_[t].transpose()));
      b_.segment(t * r, r) = L_[t] * targets_.col(t);
    }
  }

  ForceFitting<Model, S> forces_;  // in the norm I: local forces over ‖F̄(q_t)‖
  Matrix targets_;                 // d × T
  double softest_, scale_;
  std::vector<Matrix> L_;          // rank × d for each pose
  std::vector<Matrix> L_by_axis_;  // their transposes times ‖F̄(q_t)‖, rows ordered by axes
  Vector b_;
};

}  // namespace supple
