#pragma once
/// \file Backward differences: implicit Euler, BDF2, and the composite of trapezoidal rule and BDF2. In linear
/// systems they take energy, and what is too fast for the step dies out.

#include <physics/time/implicit_step.hpp>

#include <numbers>

namespace supple {

struct BackwardDifferenceParameters {};  ///< they have none

/// What they share: ends that follow from what is known by u⁺ = û + τ v⁺, v⁺ = v̂ + τ a⁺, all forces balanced there.
template <DynamicalSystem System>
class BackwardDifference : public ImplicitIntegrator<System> {
 public:
  using typename ImplicitIntegrator<System>::MatrixType;
  using State = supple::State;

 protected:
  BackwardDifference(const char* name, const System& system, double h, const StepOptions& options, double tau)
      : ImplicitIntegrator<System>(name, system, h, options, 1 / (tau * tau), 1 / tau), tau_(tau) {}

  /// u, v and a of the state become those of the end; its time stays.
  StepReport end_step(const SystemLoad<MatrixType>& end, State& state, const Vector& u_hat, const Vector& v_hat) {
    this->check(end, state);
    require_size("state.a", state.a.size(), this->system_.dim());
    const Vector ahead = u_hat + tau_ * v_hat;
    this->objective_.begin(end, ahead, u_hat, Vector::Zero(state.u.size()));
    Vector u;
    const StepReport report = this->solve(end, state.u, ahead + tau_ * tau_ * state.a, u);
    if (report.status == Status::NotFinite) return report;
    state.a = this->objective_.acceleration(u);
    state.v = v_hat + tau_ * state.a;
    state.u = u;
    return report;
  }

 private:
  double tau_;
};

/// Advances M ü + D u̇ + f(u) = f_ext by the implicit Euler method, u⁺ = u + h v⁺, v⁺ = v + h a⁺: of first order, so it damps
/// a lot, and the calmest there is.
template <DynamicalSystem System>
class BackwardEuler : public BackwardDifference<System> {
 public:
  using typename BackwardDifference<System>::MatrixType;
  using State = supple::State;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  BackwardEuler(const System& system, double h, const StepOptions& options = {},
                const BackwardDifferenceParameters& = {})
      : BackwardDifference<System>("backward Euler", system, h, options, h) {}
  BackwardEuler(const System&&, double, const StepOptions& = {}, const BackwardDifferenceParameters& = {}) = delete;

  int order() const { return 1; }
  EnergyBehaviour energy_behaviour() const { return EnergyBehaviour::Falls; }

  /// One time step under a load that is evaluated at its end.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    const double h = this->h_;
    const SystemLoad<MatrixType>& end = load_at<MatrixType>(load, state.time + h);
    const StepReport report = this->end_step(end, state, state.u, state.v);
    if (report.status != Status::NotFinite) state.time += h;
    return report;
  }
};

/// Advances M ü + D u̇ + f(u) = f_ext by backward differences over two steps,
///   u⁺ = (4 u − u₋ + 2 h v⁺) / 3,  v⁺ = (4 v − v₋ + 2 h a⁺) / 3:
/// of second order, with little damping of slow motions; starts with a step of backward Euler.
/// \see Hairer & Wanner 1996, Sec. V.1.
template <DynamicalSystem System>
class Bdf2 : public BackwardDifference<System> {
 public:
  using typename BackwardDifference<System>::MatrixType;
  using State = supple::State;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  Bdf2(const System& system, double h, const StepOptions& options = {}, const BackwardDifferenceParameters& = {})
      : BackwardDifference<System>("BDF2", system, h, options, 2 * h / 3), first_(system, h, options) {}
  Bdf2(const System&&, double, const StepOptions& = {}, const BackwardDifferenceParameters& = {}) = delete;

  int order() const { return 2; }
  EnergyBehaviour energy_behaviour() const { return EnergyBehaviour::Bounded; }

  /// One time step under a load that is evaluated at its end.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    const double h = this->h_;
    State::Before before{state.u, state.v, state.time};
    StepReport report;
    if (state.before && std::abs(state.time - state.before->time - h) <= 1e-6 * h) {
      const auto& [u, v, time] = *state.before;
      require_size("state.before->u", u.size(), this->system_.dim());
      require_size("state.before->v", v.size(), this->system_.dim());
      const SystemLoad<MatrixType>& end = load_at<MatrixType>(load, state.time + h);
      report = this->end_step(end, state, (4 * state.u - u) / 3, (4 * state.v - v) / 3);
      if (report.status != Status::NotFinite) state.time += h;
    } else {
      report = first_.step(load, state);
    }
    if (report.status != Status::NotFinite) state.before = std::move(before);
    return report;
  }

 private:
  BackwardEuler<System> first_;
};

/// Advances M ü + D u̇ + f(u) = f_ext by a step of the trapezoidal rule over the share γ = 2 − √2, then BDF2 over the whole
/// (TR-BDF2): of second order, remembers no step but the last, damps slow motions least of all that damp fast ones for
/// good. Two solves a step, with one matrix. \see Bank et al. 1985; Bathe 2007 with γ = ½.
template <DynamicalSystem System>
class TrBdf2 : public BackwardDifference<System> {
 public:
  using typename BackwardDifference<System>::MatrixType;
  using State = supple::State;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  TrBdf2(const System& system, double h, const StepOptions& options = {}, const BackwardDifferenceParameters& = {})
      : BackwardDifference<System>("TR-BDF2", system, h, options, 0.5 * gamma * h) {}
  TrBdf2(const System&&, double, const StepOptions& = {}, const BackwardDifferenceParameters& = {}) = delete;

  int order() const { return 2; }
  EnergyBehaviour energy_behaviour() const { return EnergyBehaviour::Falls; }

  /// One time step under a load that is evaluated at t + γ h and at t + h.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    const double h = this->h_, half = 0.5 * gamma * h;
    State middle = state;
    const StepReport first = this->end_step(load_at<MatrixType>(load, state.time + gamma * h), middle,
                                            state.u + half * state.v, state.v + half * state.a);
    if (first.status == Status::NotFinite) return first;
    constexpr double late = 1 / (gamma * (2 - gamma)), early = (1 - gamma) * (1 - gamma) * late;
    StepReport report = this->end_step(load_at<MatrixType>(load, state.time + h), middle,
                                       late * middle.u - early * state.u, late * middle.v - early * state.v);
    report.iterations += first.iterations;
    report.tangents += first.tangents;
    if (report.status == Status::NotFinite) return report;
    if (report.status == Status::Converged) report.status = first.status;
    report.residual = std::max(report.residual, first.residual);
    middle.time = state.time + h;
    state = std::move(middle);
    return report;
  }

 private:
  static constexpr double gamma = 2 - std::numbers::sqrt2;
};

static_assert(TimeIntegratorFor<BackwardEuler<archetype::Dynamics>, archetype::Dynamics>);
static_assert(TimeIntegratorFor<Bdf2<archetype::Dynamics>, archetype::Dynamics>);
static_assert(TimeIntegratorFor<TrBdf2<archetype::Dynamics>, archetype::Dynamics>);

}  // namespace supple
