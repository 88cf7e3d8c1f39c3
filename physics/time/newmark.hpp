#pragma once
/// \file Implicit Newmark time integration of any dynamical system.

#include <physics/time/implicit_step.hpp>

namespace supple {

struct NewmarkParameters {
  /// Average acceleration; γ > ½, β = ¼ (γ + ½)² damps, at first order. γ ≥ ½; where 2 β < γ, steps must stay short.
  double beta = 0.25, gamma = 0.5;
};

/// Advances M ü + D u̇ + f(u) = f_ext by the Newmark family (Newmark 1959; Hughes 2000, Sec. 9.1):
///   u⁺ = u + h v + h² ((½ − β) a + β a⁺),  v⁺ = v + h ((1 − γ) a + γ a⁺).
///
///     Newmark newmark(system, /*h=*/0.005, {.damping = {.beta = 0.002}, .solver = Bfgs{}});
///     State state = newmark.at_rest();
///     newmark.balance(load, state);
///     for (int step = 0; step < 200; ++step) (void)newmark.step(load, state);
template <DynamicalSystem System>
class Newmark : public ImplicitIntegrator<System> {
 public:
  using typename ImplicitIntegrator<System>::MatrixType;
  using State = supple::State;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  Newmark(const System& system, double h, const StepOptions& options = {}, const NewmarkParameters& parameters = {})
      : ImplicitIntegrator<System>("Newmark", system, h, options, 1 / (parameters.beta * h * h),
                                   parameters.gamma / (parameters.beta * h)),
        beta_(parameters.beta),
        gamma_(parameters.gamma) {
    require(beta_ > 0, "Newmark's beta is " + std::to_string(beta_) + ", expected > 0 (implicit)");
    require(gamma_ >= 0.5, "Newmark's gamma is " + std::to_string(gamma_) +
                               ", expected at least 0.5: below, every motion grows, however short the step");
  }
  Newmark(const System&&, double, const StepOptions& = {}, const NewmarkParameters& = {}) = delete;  // it would dangle

  int order() const { return gamma_ == 0.5 ? 2 : 1; }
  EnergyBehaviour energy_behaviour() const {
    if (2 * beta_ < gamma_) return EnergyBehaviour::BoundedForShortSteps;
    return beta_ == 0.25 && gamma_ == 0.5 ? EnergyBehaviour::Conserved : EnergyBehaviour::Bounded;
  }

  /// One time step under a load that is evaluated at its end.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    const double h = this->h_;
    const SystemLoad<MatrixType>& end = load_at<MatrixType>(load, state.time + h);
    this->check(end, state);
    require_size("state.a", state.a.size(), this->system_.dim());
    const Vector u_tilde = state.u + h * state.v + h * h * (0.5 - beta_) * state.a;
    this->objective_.begin(end, u_tilde, u_tilde, state.v + h * (1 - gamma_) * state.a);
    Vector u;
    const StepReport report = this->solve(end, state.u, state.u + h * state.v + 0.5 * h * h * state.a, u);
    if (report.status == Status::NotFinite) return report;
    const Vector a = this->objective_.acceleration(u);
    state.v += h * ((1 - gamma_) * state.a + gamma_ * a);
    state.u = u;
    state.a = a;
    state.time += h;
    return report;
  }

 private:
  double beta_, gamma_;
};

static_assert(TimeIntegratorFor<Newmark<archetype::Dynamics>, archetype::Dynamics>);

}  // namespace supple
