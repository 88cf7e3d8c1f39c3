#pragma once
/// \file Generalised-α method: second order, and what is too fast for the step dies out.

#include <physics/time/implicit_step.hpp>

namespace supple {

struct GeneralizedAlphaParameters {
  double rho_infinity = 0.8;  ///< ρ∞ ∈ [0, 1]: what a step leaves of infinitely fast motions; 1 damps nothing, 0 all
};

/// Advances M ü + D u̇ + f(u) = f_ext with inertia balanced at a_m = (1 − α_m) a⁺ + α_m a and all other forces at
/// u_f = (1 − α_f) u⁺ + α_f u, likewise v_f and t_f, where u⁺ and v⁺ follow from a⁺ as in Newmark's method, with
///   α_m = (2 ρ∞ − 1) / (ρ∞ + 1),  α_f = ρ∞ / (ρ∞ + 1),  γ = ½ − α_m + α_f,  β = ¼ (1 − α_m + α_f)²:
/// of second order, for linear systems stable with any step, and with the least damping of slow motions for its ρ∞.
/// f is evaluated at u_f, f(u_f), not averaged over the ends of the step: so a step minimises an incremental potential in
/// u_f. \see Chung & Hulbert 1993.
template <DynamicalSystem System>
class GeneralizedAlpha : public ImplicitIntegrator<System> {
 public:
  using typename ImplicitIntegrator<System>::MatrixType;
  using State = supple::State;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  GeneralizedAlpha(const System& system, double h, const StepOptions& options = {},
                   const GeneralizedAlphaParameters& parameters = {})
      : GeneralizedAlpha(system, h, options, Coefficients(parameters.rho_infinity, h)) {}
  GeneralizedAlpha(const System&&, double, const StepOptions& = {}, const GeneralizedAlphaParameters& = {}) = delete;

  int order() const { return 2; }
  EnergyBehaviour energy_behaviour() const { return EnergyBehaviour::Bounded; }

  /// One time step under a load that is evaluated at t + (1 − α_f) h.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    const auto& [h, alpha_m, alpha_f, beta, gamma, c_m, c_d] = with_;
    const SystemLoad<MatrixType>& amid = load_at<MatrixType>(load, state.time + (1 - alpha_f) * h);
    this->check(amid, state);
    require_size("state.a", state.a.size(), this->system_.dim());
    // u⁺ = ũ + β h² a⁺, so u_f = û + (1 − α_f) β h² a⁺
    const Vector u_tilde = state.u + h * state.v + h * h * (0.5 - beta) * state.a;
    const Vector u_hat = alpha_f * state.u + (1 - alpha_f) * u_tilde;
    this->objective_.begin(amid, u_hat - alpha_m / c_m * state.a, u_hat,
                           state.v + (1 - alpha_f) * h * (1 - gamma) * state.a);
    const Vector prediction = state.u + (1 - alpha_f) * h * (state.v + 0.5 * h * state.a);
    Vector u_f;
    const StepReport report = this->solve(amid, state.u, prediction, u_f);
    if (report.status == Status::NotFinite) return report;
    const Vector a = (u_f - u_hat) / ((1 - alpha_f) * beta * h * h);
    state.u = u_tilde + beta * h * h * a;
    state.v += h * ((1 - gamma) * state.a + gamma * a);
    state.a = a;
    state.time += h;
    return report;
  }

 private:
  struct Coefficients {
    double h, alpha_m, alpha_f, beta, gamma, c_m, c_d;

    Coefficients(double rho, double step) : h(step) {
      require(rho >= 0 && rho <= 1, "rho_infinity is " + std::to_string(rho) + ", expected 0 to 1");
      alpha_m = (2 * rho - 1) / (rho + 1);
      alpha_f = rho / (rho + 1);
      gamma = 0.5 - alpha_m + alpha_f;
      beta = 0.25 * (1 - alpha_m + alpha_f) * (1 - alpha_m + alpha_f);
      c_m = (1 - alpha_m) / ((1 - alpha_f) * beta * h * h);
      c_d = gamma / (beta * h);
    }
  };

  GeneralizedAlpha(const System& system, double h, const StepOptions& options, const Coefficients& with)
      : ImplicitIntegrator<System>("generalised-alpha", system, h, options, with.c_m, with.c_d), with_(with) {}

  Coefficients with_;
};

static_assert(TimeIntegratorFor<GeneralizedAlpha<archetype::Dynamics>, archetype::Dynamics>);

}  // namespace supple
