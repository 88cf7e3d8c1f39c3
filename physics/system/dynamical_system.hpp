#pragma once
/// \file Systems as integrators and static solvers see them: full (sparse) and reduced (dense)
/// alike.

#include <core/types.hpp>
#include <numerics/linear/block_rotations.hpp>
#include <physics/load/loads.hpp>
#include <physics/load/system_load.hpp>
#include <physics/model/force_model.hpp>

#include <concepts>
#include <utility>

namespace supple {

/// Masses M and forces f(u) with K = ∂f/∂u, in `dim` unknowns: what is left to integrate in time when an object is
/// discretised in space. FirstOrderIntegrator asks for no more.
///
/// A system also promises: mass() > 0; f(0) = 0; stiffness is the derivative of force, symmetric unless
/// has_symmetric_tangent<S>() is false; const calls safe from several threads.
template <typename S>
concept SemidiscreteSystem = requires(const S& system, VectorIn u, VectorOut f, typename S::MatrixType& K) {
  { system.dim() } -> std::convertible_to<Index>;
  { system.mass() } -> std::convertible_to<const Vector&>;                            // diagonal of M (lumped) [kg]
  system.force(u, f);                                                                 // f [N]
  system.stiffness(u, K);                                                             // K [N/m]
  { system.rest_stiffness() } -> std::convertible_to<const typename S::MatrixType&>;  // K(0), symmetric
};

/// M ü + D u̇ + f(u) = f_ext of an object in ℝ³ with f = ∂E/∂u, so K is symmetric: what Newmark and static solvers see.
///
/// A system also promises that energy and force agree by differentiation.
template <typename S>
concept DynamicalSystem = SemidiscreteSystem<S> && has_symmetric_tangent<S>() &&
    requires(const S& system, VectorIn u, const Loads& loads) {
  { system.energy(u) } -> std::convertible_to<double>;                            // E [J]
  { system.project(loads) } -> std::same_as<SystemLoad<typename S::MatrixType>>;  // loads on nodes → on unknowns
};

/// How the unknowns of a state have turned since rest, in blocks of three, where a system tells by frames(): the tangent
/// there is near R K(0) Rᵀ. Nothing has turned where it does not.
template <DynamicalSystem S>
BlockRotations frames_of(const S& system, VectorIn u) {
  if constexpr (requires { system.frames(u); })
    return std::move(system.frames(u).front());
  else
    return {};
}

}  // namespace supple
