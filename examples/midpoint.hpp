#pragma once
// An integrator of one's own: the implicit midpoint rule.

#include <physics/time/implicit_step.hpp>

struct MidpointParameters {};  // it has none

/// Balances all forces amid the step, at u_m = u + h/2 v_m: M (v⁺ − v) / h + D v_m + f(u_m) = f_ext with v_m = (v + v⁺) / 2.
/// In the unknown u_m, which ImplicitIntegrator solves for, that is inertia 4/h² M (u_m − ũ) with ũ = u + h/2 v, and
/// damping 2/h D (u_m − u).
template <supple::DynamicalSystem System>
class Midpoint : public supple::ImplicitIntegrator<System> {
 public:
  using typename supple::ImplicitIntegrator<System>::MatrixType;
  using State = supple::State;

  Midpoint(const System& system, double h, const supple::StepOptions& options = {}, const MidpointParameters& = {})
      : supple::ImplicitIntegrator<System>("midpoint", system, h, options, 4 / (h * h), 2 / h) {}

  int order() const { return 2; }
  supple::EnergyBehaviour energy_behaviour() const { return supple::EnergyBehaviour::Conserved; }

  template <supple::LoadOverTime<MatrixType> Load>
  supple::StepReport step(const Load& load, State& state) {
    const double h = this->step_size();
    const supple::SystemLoad<MatrixType>& amid = supple::load_at<MatrixType>(load, state.time + h / 2);
    this->check(amid, state);
    const supple::Vector ahead = state.u + h / 2 * state.v;
    this->objective_.begin(amid, ahead, state.u, supple::Vector::Zero(state.u.size()));
    supple::Vector u_m;
    const supple::StepReport report = this->solve(amid, state.u, ahead, u_m);
    if (report.status == supple::Status::NotFinite) return report;  // the state stays
    const supple::Vector v = 4 / h * (u_m - state.u) - state.v;
    state.a = (v - state.v) / h;
    state.u = 2 * u_m - state.u;
    state.v = v;
    state.time += h;
    return report;
  }
};
static_assert(supple::TimeIntegratorFor<Midpoint<supple::archetype::Dynamics>, supple::archetype::Dynamics>);
