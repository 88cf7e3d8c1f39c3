#pragma once
/// \file Static equilibrium f(u) + k u = f_ext as a smooth objective.

#include <numerics/optimize/newton.hpp>
#include <physics/system/dynamical_system.hpp>

#include <algorithm>

namespace supple {

/// φ(u) = E(u) + ½ uᵀ k u − f_extᵀ u of any dynamical system (Eqs. 2 and 3 of the paper), for newton_minimize,
/// bfgs_minimize, quasi_newton_solve and minimize_by_nlopt. Residuals are ‖f(u) + k u − f_ext‖ against the largest of these
/// terms; what remains of them by rounding alone counts as converged, for an unloaded body has no other forces.
template <DynamicalSystem System>
class Equilibrium {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the objective.  \param tolerance  the one that residuals will be compared with.
  Equilibrium(const System& system, AffineLoad<MatrixType> load, double tolerance = 1e-6)
      : system_(system),
        load_(std::move(load)),
        rounding_(8 * std::numeric_limits<double>::epsilon() / tolerance * system.rest_stiffness().diagonal()) {
    require_size("load.force", load_.force.size(), system.dim());
    if (load_.has_stiffness()) require_size("load.stiffness", load_.stiffness.rows(), system.dim());
  }

  const AffineLoad<MatrixType>& load() const { return load_; }

  double value(VectorIn u) const {
    double phi = system_.energy(u) - load_.force.dot(u);
    if (load_.has_stiffness()) phi += 0.5 * u.dot(load_.stiffness * u);
    return phi;
  }
  void gradient(VectorIn u, VectorOut g) {
    system_.force(u, g);
    scale_ = std::max({g.norm(), load_.force.norm(), rounding_.cwiseProduct(u).norm()});
    if (load_.has_stiffness()) {
      const Vector pull = load_.stiffness * u;
      scale_ = std::max(scale_, pull.norm());
      g += pull;
    }
    g -= load_.force;
  }
  void hessian(VectorIn u, MatrixType& H) const {
    system_.stiffness(u, H);
    if (load_.has_stiffness()) add_few(H, load_.stiffness);
  }
  double scale(VectorIn) const { return scale_; }
  const Vector& metric() const { return system_.mass(); }

 private:
  const System& system_;
  AffineLoad<MatrixType> load_;
  Vector rounding_;  // of the forces, relative to the displacements and the tolerance
  double scale_ = 0;
};

}  // namespace supple
