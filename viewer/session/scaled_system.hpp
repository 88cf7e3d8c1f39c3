#pragma once
/// \file System with elastic forces that are stiffer or softer by a factor.

#include <core/check.hpp>
#include <core/text.hpp>
#include <physics/system/any_system.hpp>

#include <cmath>
#include <memory>

namespace supple {

/// Another system with energy, forces and stiffness times a factor, as if every weight of its selection were scaled: all
/// frequencies change by its square root, at no cost. An ObjectSystem.
class ScaledSystem {
 public:
  using MatrixType = Matrix;
  static constexpr bool symmetric_tangent = true;

  ScaledSystem(AnySystem<Matrix> system, double factor)
      : system_(std::move(system)), factor_(factor), rest_stiffness_(factor * system_.rest_stiffness()) {
    require(std::isfinite(factor) && factor > 0, "the factor on the stiffness is " + shown(factor) + ", expected > 0");
  }

  Index dim() const { return system_.dim(); }
  const Vector& mass() const { return system_.mass(); }
  const Matrix& rest_stiffness() const { return rest_stiffness_; }
  double energy(VectorIn u) const { return factor_ * system_.energy(u); }
  void force(VectorIn u, VectorOut f) const {
    system_.force(u, f);
    f *= factor_;
  }
  void stiffness(VectorIn u, Matrix& K) const {
    system_.stiffness(u, K);
    K *= factor_;
  }
  void mean_force(VectorIn u_0, VectorIn u_1, VectorOut f) const {
    system_.mean_force(u_0, u_1, f);
    f *= factor_;
  }
  void mean_stiffness(VectorIn u_0, VectorIn u_1, Matrix& K) const {
    system_.mean_stiffness(u_0, u_1, K);
    K *= factor_;
  }
  SystemLoad<Matrix> project(const Loads& loads) const { return system_.project(loads); }
  Index num_nodes() const { return system_.num_nodes(); }
  Vector expand(VectorIn u) const { return system_.expand(u); }
  Point displacement(VectorIn u, Index node) const { return system_.displacement(u, node); }

 private:
  AnySystem<Matrix> system_;
  double factor_;
  Matrix rest_stiffness_;
};

static_assert(ObjectSystem<ScaledSystem>);

/// The system itself for factor 1.
inline AnySystem<Matrix> scaled(const AnySystem<Matrix>& system, double factor) {
  return factor == 1 ? system : AnySystem<Matrix>(std::make_shared<const ScaledSystem>(system, factor));
}

}  // namespace supple
