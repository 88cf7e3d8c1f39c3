#pragma once
/// \file Static equilibrium f(u) + k (u − u*) = f as a smooth objective.

#include <numerics/optimize/objective.hpp>
#include <physics/system/dynamical_system.hpp>

#include <algorithm>

namespace supple {

/// φ(u) = E(u) + ½ Σ k (u − u*)² − fᵀ u of any dynamical system (Eqs. 2 and 3 of the paper), with springs k to u* and dead
/// forces f, for any NonlinearSolver; what else acts adds its potential.
///
/// Residuals are ‖f(u) + k (u − u*) − f‖ against the largest of these three: springs count by what they hold, for k u and
/// k u* are as large as the springs are stiff and tell nothing of the object. What remains by rounding alone counts as
/// converged, for a body that is moved rigidly has no other forces: 8 ε ‖(K(0) + k) u‖ of the diagonals. So in springs
/// 10¹⁵ times as stiff as the object every shape is an equilibrium.
template <DynamicalSystem System>
class Equilibrium {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the objective.  \param tolerance  the one that residuals will be compared with.
  Equilibrium(const System& system, SystemLoad<MatrixType> load, double tolerance = 1e-6)
      : system_(system),
        load_(std::move(load)),
        dead_(load_.dead_force()),
        rounding_(system.rest_stiffness().diagonal()) {
    load_.check(system.dim());
    if (load_.has_stiffness()) rounding_ += load_.stiffness.diagonal();
    rounding_ *= 8 * std::numeric_limits<double>::epsilon() / tolerance;
  }

  const SystemLoad<MatrixType>& load() const { return load_; }

  bool has_value() const { return load_.has_potential(); }
  double value(VectorIn u) const { return system_.energy(u) - dead_.dot(u) + load_.net_pull_energy(u); }
  void gradient(VectorIn u, VectorOut g) {
    system_.force(u, g);
    scale_ = std::max({g.norm(), dead_.norm(), rounding_.cwiseProduct(u).norm()});
    if (load_.has_pull()) {
      Vector pull = Vector::Zero(u.size());
      load_.add_net_pull(u, pull);
      scale_ = std::max(scale_, pull.norm());
      g += pull;
    }
    g -= dead_;
  }
  void hessian(VectorIn u, MatrixType& H) const {
    system_.stiffness(u, H);
    load_.add_stiffness(u, H);
  }
  double scale(VectorIn) const { return scale_; }
  const Vector& metric() const { return system_.mass(); }
  BlockRotations frames(VectorIn u) const { return frames_of(system_, u); }

 private:
  const System& system_;
  SystemLoad<MatrixType> load_;
  Vector dead_;      // forces
  Vector rounding_;  // of the forces, relative to the displacements and the tolerance
  double scale_ = 0;
};

}  // namespace supple
