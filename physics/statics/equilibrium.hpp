#pragma once
/// \file Static equilibrium f(u) + k u = f_ext as a smooth objective.

#include <numerics/optimize/objective.hpp>
#include <physics/system/dynamical_system.hpp>

#include <algorithm>

namespace supple {

/// φ(u) = E(u) + ½ uᵀ k u − f_extᵀ u of any dynamical system (Eqs. 2 and 3 of the paper), for any NonlinearSolver; what
/// else acts adds its potential. Residuals are ‖f(u) + k u − f_ext‖ against the largest of these
/// terms; what remains of them by rounding alone counts as converged, for an unloaded body has no other forces.
template <DynamicalSystem System>
class Equilibrium {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the objective.  \param tolerance  the one that residuals will be compared with.
  Equilibrium(const System& system, SystemLoad<MatrixType> load, double tolerance = 1e-6)
      : system_(system),
        load_(std::move(load)),
        rounding_(8 * std::numeric_limits<double>::epsilon() / tolerance * system.rest_stiffness().diagonal()) {
    load_.check(system.dim());
  }

  const SystemLoad<MatrixType>& load() const { return load_; }

  bool has_value() const { return load_.has_potential(); }
  double value(VectorIn u) const { return system_.energy(u) - load_.force.dot(u) + load_.pull_energy(u); }
  void gradient(VectorIn u, VectorOut g) {
    system_.force(u, g);
    scale_ = std::max({g.norm(), load_.force.norm(), rounding_.cwiseProduct(u).norm()});
    if (load_.has_pull()) {
      Vector pull = Vector::Zero(u.size());
      load_.add_pull(u, pull);
      scale_ = std::max(scale_, pull.norm());
      g += pull;
    }
    g -= load_.force;
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
  Vector rounding_;  // of the forces, relative to the displacements and the tolerance
  double scale_ = 0;
};

}  // namespace supple
