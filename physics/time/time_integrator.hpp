#pragma once
/// \file Time integrators as a seam: how a system moves.

#include <physics/load/system_load.hpp>
#include <physics/system/dynamical_system.hpp>
#include <physics/time/state.hpp>

#include <concepts>

namespace supple {

/// What becomes of the energy of an undamped linear oscillator.
enum class EnergyBehaviour {
  Conserved,             ///< kinetic plus elastic energy stays, for any step
  Falls,                 ///< it never rises from one step to the next, for any step
  Bounded,               ///< it swings or falls, and neither is promised
  BoundedForShortSteps,  ///< and grows without bound where steps are long against the fastest motion
};

/// An object that advances a system by steps of one length. A state has displacements `u` and a `time`, and what else
/// the integrator keeps from step to step.
///
/// An integrator also promises, and supple::testing checks: errors fall with order() as steps get shorter; a body at
/// rest in equilibrium stays; the energy of a linear oscillator behaves as energy_behaviour() says; a step that is
/// NotFinite leaves the state as it was; any other ends at time + step_size().
template <typename I, typename System>
concept TimeIntegratorFor = SemidiscreteSystem<System> &&
    requires(I& integrator, const I& settled, typename I::State& state,
             const SystemLoad<typename System::MatrixType>& load) {
  { settled.step_size() } -> std::convertible_to<double>;  // h [s]
  { settled.order() } -> std::convertible_to<int>;         // of the global error, in h
  { settled.energy_behaviour() } -> std::convertible_to<EnergyBehaviour>;
  { settled.at_rest() } -> std::same_as<typename I::State>;             // u = 0, time 0
  settled.balance(load, state);                                         // rates that u implies; after setting u by hand
  { integrator.step(load, state) } -> std::convertible_to<StepReport>;  // also takes a load over time, LoadOverTime
  { state.u } -> std::convertible_to<Vector&>;
  { state.time } -> std::convertible_to<double&>;
};

namespace archetype {
/// The least that integrators of second order ask for; declared only.
struct Dynamics {
  using MatrixType = Matrix;
  Index dim() const;
  const Vector& mass() const;
  double energy(VectorIn u) const;
  void force(VectorIn u, VectorOut f) const;
  void stiffness(VectorIn u, Matrix& K) const;
  const Matrix& rest_stiffness() const;
  SystemLoad<Matrix> project(const Loads& loads) const;
};
static_assert(DynamicalSystem<Dynamics>);
}  // namespace archetype

/// The load at a time [s], whether it changes or not.
template <typename MatrixType, LoadOverTime<MatrixType> L>
decltype(auto) load_at(const L& load, double t) {
  if constexpr (std::invocable<const L&, double>)
    return load(t);
  else
    return static_cast<const SystemLoad<MatrixType>&>(load);
}

}  // namespace supple
