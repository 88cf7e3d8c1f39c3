#pragma once
/// \file Static equilibrium f(u) = f_ext as a smooth objective.

#include <physics/newton.hpp>

namespace supple::test {

/// φ(u) = E(u) − f_extᵀ u of any dynamical system; residuals are relative to the larger of ‖f‖ and ‖f_ext‖.
template <typename System>
class StaticProblem {
 public:
  using MatrixType = typename System::MatrixType;

  StaticProblem(const System& system, Vector f_ext) : system_(system), f_ext_(std::move(f_ext)) {}

  double value(VectorIn u) const { return system_.energy(u) - f_ext_.dot(u); }
  void gradient(VectorIn u, VectorOut g) {
    system_.force(u, g);
    scale_ = std::max(g.norm(), f_ext_.norm());
    g -= f_ext_;
  }
  void hessian(VectorIn u, MatrixType& H) const { system_.stiffness(u, H); }
  double scale(VectorIn) const { return scale_; }
  const Vector& metric() const { return system_.mass(); }

 private:
  const System& system_;
  Vector f_ext_;
  double scale_ = 0;
};

}  // namespace supple::test
