#pragma once
/// \file What integrators and static solvers see: the full system (sparse) and the reduced system (dense)
/// alike.

#include <core/types.hpp>
#include <physics/loads.hpp>

#include <concepts>

namespace supple {

/// M ü + D u̇ + f(u) = f_ext with f = ∂E/∂u and K = ∂f/∂u, in `dim` unknowns.
///
/// A system also promises: mass() > 0; f(0) = 0; energy, force and stiffness agree by differentiation; const
/// calls safe from several threads.
template <typename S>
concept DynamicalSystem = requires(const S& system, VectorIn u, VectorOut f, typename S::MatrixType& K,
                                   const Loads& loads) {
  { system.dim() } -> std::convertible_to<Index>;
  { system.mass() } -> std::convertible_to<const Vector&>;  // diagonal of M (lumped) [kg]
  { system.energy(u) } -> std::convertible_to<double>;      // E [J]
  system.force(u, f);                                       // f [N]
  system.stiffness(u, K);                                   // K [N/m], symmetric
  {
    system.rest_stiffness()
    } -> std::convertible_to<const typename S::MatrixType&>;  // K(0), for Rayleigh damping
  {
    system.project(loads)
    } -> std::same_as<AffineLoad<typename S::MatrixType>>;  // loads on nodes → on unknowns
};

}  // namespace supple
