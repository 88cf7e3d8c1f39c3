#pragma once
/// \file Implicit time integration of systems of first order, such as heat conduction, full or reduced.

#include <numerics/linear/lu_solver.hpp>
#include <numerics/optimize/newton.hpp>
#include <physics/time/time_integrator.hpp>

#include <algorithm>
#include <type_traits>

namespace supple {

/// Unknowns u, their rates u̇ and the time [s]; and, for Bdf2, where the step before started.
struct FirstOrderState {
  Vector u, u_dot;
  double time = 0;
  Vector u_before = {};  ///< empty at the start of a trajectory, and after setting u by hand
  double time_before = 0;

  static FirstOrderState at_rest(Index dim) { return {Vector::Zero(dim), Vector::Zero(dim)}; }
};

enum class FirstOrderMethod {
  BackwardEuler,  ///< first order; damps what is fast, for good
  Trapezoidal,    ///< second order (Crank–Nicolson); what is much faster than a step swings on. Starts from u̇:
                  ///< balance()
  Bdf2,           ///< second order, and damps what is fast; starts with a step of backward Euler
};

struct FirstOrderOptions {
  FirstOrderMethod method = FirstOrderMethod::Bdf2;
  /// ‖M u̇ + f(u) − q‖ against the largest of these terms, Euclidean norms. What remains of these terms by rounding
  /// alone counts as converged.
  double tolerance = 1e-6;
  Index max_iterations = 30;  ///< of Newton's method in a step
};

/// Solves with the tangents of a system.
template <SemidiscreteSystem System>
using TangentSolver = std::conditional_t<has_symmetric_tangent<System>(), SpdSolver<typename System::MatrixType>,
                                         LuSolver<typename System::MatrixType>>;

namespace detail {

/// r(u) = M c (u − ũ) + f(u) + k u − q: a step, or with c = 0 the steady state.
template <SemidiscreteSystem System>
struct BalanceOfRates {
  using MatrixType = typename System::MatrixType;

  BalanceOfRates(const System& some, double tolerance)
      : system(some), rounding(8 * std::numeric_limits<double>::epsilon() / tolerance) {}

  void residual(VectorIn u, VectorOut r) {
    system.force(u, r);
    load->add_pull(u, r);
    const Vector storage = c * system.mass().cwiseProduct(u - u_tilde);
    const Vector terms = (c * system.mass() + system.rest_stiffness().diagonal()).cwiseProduct(u);
    scale_ = std::max({r.norm(), load->force.norm(), storage.norm(), rounding * terms.norm()});
    r += storage - load->force;
  }
  void jacobian(VectorIn u, MatrixType& J) const {
    system.stiffness(u, J);
    add_diagonal(J, c * system.mass());
    load->add_stiffness(u, J);
  }
  double scale(VectorIn) const { return scale_; }

  const System& system;
  double rounding;  // of the terms, relative to the tolerance
  const SystemLoad<MatrixType>* load = nullptr;
  double c = 0;
  Vector u_tilde = Vector::Zero(system.dim());

 private:
  double scale_ = 0;
};

}  // namespace detail

/// Advances M u̇ + f(u) = q; for heat, M are capacities [J/K], f heat flows out of nodes and q into them [W]. Each
/// method ends a step with u̇⁺ = c (u⁺ − ũ), so M c (u⁺ − ũ) + f(u⁺) = q⁺ is solved by Newton's method with line
/// search; no potential is asked for. \see Hairer & Wanner 1996, Secs. IV.3 and V.1.
template <SemidiscreteSystem System>
class FirstOrderIntegrator {
 public:
  using MatrixType = typename System::MatrixType;
  using State = FirstOrderState;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  FirstOrderIntegrator(const System& system, double h, const FirstOrderOptions& options = {})
      : system_(system), h_(h), options_(options), step_(system, options.tolerance) {
    require(std::isfinite(h) && h > 0, "time step is " + std::to_string(h) + " s, expected > 0");
    require(options.tolerance > 0, "tolerance is " + std::to_string(options.tolerance) + ", expected > 0");
  }

  double step_size() const { return h_; }  ///< [s]
  int order() const { return options_.method == FirstOrderMethod::BackwardEuler ? 1 : 2; }
  /// Of ½ uᵀ M u in a linear system.
  EnergyBehaviour energy_behaviour() const {
    return options_.method == FirstOrderMethod::Bdf2 ? EnergyBehaviour::Bounded : EnergyBehaviour::Falls;
  }
  FirstOrderState at_rest() const { return FirstOrderState::at_rest(system_.dim()); }

  /// The rate that u implies under this load; call it after setting a state by hand.
  void balance(const SystemLoad<MatrixType>& load, FirstOrderState& state) const {
    check(load, state);
    Vector f(system_.dim());
    system_.force(state.u, f);
    load.add_pull(state.u, f);
    state.u_dot = (load.force - f).cwiseQuotient(system_.mass());
    state.u_before.resize(0);
  }

  /// One time step under a load that is evaluated at its end. Not converging is reported and the best iterate kept; a
  /// state that is NotFinite stays as it was.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, FirstOrderState& state) {
    const SystemLoad<MatrixType>& end = load_at<MatrixType>(load, state.time + h_);
    check(end, state);
    begin(state);
    step_.load = &end;
    Vector u = state.u;
    const StepReport report = Newton{}(step_, solver_, u, {options_.tolerance, options_.max_iterations});
    if (report.status == Status::NotFinite) return report;
    state.u_dot = step_.c * (u - step_.u_tilde);
    state.u_before = std::move(state.u);
    state.time_before = state.time;
    state.u = std::move(u);
    state.time += h_;
    return report;
  }

 private:
  /// c and ũ of a step from this state.
  void begin(const FirstOrderState& state) {
    if (options_.method == FirstOrderMethod::Trapezoidal) {
      step_.c = 2 / h_;
      step_.u_tilde = state.u + 0.5 * h_ * state.u_dot;
    } else if (options_.method == FirstOrderMethod::Bdf2 && state.u_before.size() > 0) {
      const double ratio = h_ / (state.time - state.time_before), twice = 1 + 2 * ratio;
      step_.c = twice / ((1 + ratio) * h_);
      step_.u_tilde = ((1 + ratio) * (1 + ratio) * state.u - ratio * ratio * state.u_before) / twice;
    } else {
      step_.c = 1 / h_;
      step_.u_tilde = state.u;
    }
  }

  void check(const SystemLoad<MatrixType>& load, const FirstOrderState& state) const {
    load.check(system_.dim());
    require_size("state.u", state.u.size(), system_.dim());
    require_size("state.u_dot", state.u_dot.size(), system_.dim());
    if (state.u_before.size() > 0) {
      require_size("state.u_before", state.u_before.size(), system_.dim());
      require(state.time_before < state.time, "the step before does not start earlier than this one");
    }
  }

  const System& system_;
  double h_;
  FirstOrderOptions options_;
  detail::BalanceOfRates<System> step_;
  TangentSolver<System> solver_;
};

/// The steady state, f(u) = q, from a guess u by Newton's method with line search.
/// \return as Newton does; Stagnated if no steady state is determined, as nothing fixes the unknowns.
template <SemidiscreteSystem System>
SolveReport solve_steady(const System& system, const SystemLoad<typename System::MatrixType>& load, Vector& u,
                         const SolveLimits& limits = {}) {
  load.check(system.dim());
  require_size("u", u.size(), system.dim());
  detail::BalanceOfRates<System> balance(system, limits.tolerance);
  balance.load = &load;
  TangentSolver<System> solver;
  return Newton{}(balance, solver, u, limits);
}

}  // namespace supple
