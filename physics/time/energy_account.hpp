#pragma once
/// \file Energies of a motion, accounted for: what there is against what loads brought and damping took.

#include <core/check.hpp>
#include <physics/system/damping.hpp>
#include <physics/system/dynamical_system.hpp>
#include <physics/time/state.hpp>

#include <algorithm>

namespace supple {

/// Energies of a motion at one time [J].
struct EnergyBalance {
  double start = 0;                 ///< kinetic plus elastic energy at the beginning
  double kinetic = 0, elastic = 0;  ///< now
  double work = 0;                  ///< of loads and springs, since
  double damped = 0;                ///< what Rayleigh damping took, since
  double turnover = 0;              ///< the most that start and work have come to, the measure of what is made

  /// What the time integrator made (> 0) or took (< 0), since: nothing, if it were exact.
  double made() const { return kinetic + elastic - start - work + damped; }
  /// That over the turnover; 0 where nothing has happened.
  double made_share() const { return turnover > 0 ? made() / turnover : 0; }
};

/// Keeps the EnergyBalance of a motion from step to step. The work of a step is that of the load amid it: exact for loads
/// that stay or change linearly and for springs, of second order in the step for others.
template <DynamicalSystem System>
class EnergyAccount {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the account.
  EnergyAccount(const System& system, const RayleighDamping& damping, const State& start)
      : system_(&system), damping_(damping) {
    at_ = {.kinetic = kinetic_energy(start.v), .elastic = system.energy(start.u)};
    at_.start = at_.turnover = at_.kinetic + at_.elastic;
  }

  const EnergyBalance& now() const { return at_; }

  /// \param load  amid the step.  \param before, after  its ends.
  void add_step(const SystemLoad<MatrixType>& load, const State& before, const State& after) {
    const Vector du = after.u - before.u;
    at_.work += load.dead_force().dot(du) - pull_work(load, before.u, after.u);
    at_.damped += damping_work(du, after.time - before.time);
    at_.kinetic = kinetic_energy(after.v);
    at_.elastic = system_->energy(after.u);
    at_.turnover = std::max(at_.turnover, at_.start + std::abs(at_.work));
  }

 private:
  double kinetic_energy(VectorIn v) const { return 0.5 * v.dot(system_->mass().cwiseProduct(v)); }

  /// Of what springs and other forces hold against a step.
  static double pull_work(const SystemLoad<MatrixType>& load, VectorIn u_0, VectorIn u_1) {
    if (!load.has_pull()) return 0;
    if (load.has_potential()) return load.net_pull_energy(u_1) - load.net_pull_energy(u_0);
    Vector pull = Vector::Zero(u_0.size());
    load.add_net_pull(0.5 * (u_0 + u_1), pull);
    return pull.dot(u_1 - u_0);
  }
  /// v̄ᵀ D v̄ h at the mean velocity v̄ = Δu / h.
  double damping_work(const Vector& du, double h) const {
    return damping_.acts() ? du.dot(damping_force(*system_, damping_, du)) / h : 0;
  }

  const System* system_;
  RayleighDamping damping_;
  EnergyBalance at_;
};

}  // namespace supple
