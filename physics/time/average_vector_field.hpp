#pragma once
/// \file Average vector field method: energy stays in large deformations, too.

#include <physics/system/mean_force.hpp>
#include <physics/time/energy_account.hpp>
#include <physics/time/implicit_step.hpp>

#include <cmath>
#include <optional>
#include <utility>

namespace supple {

/// Elastic forces and the net pull of a load, averaged over the straight way of a step from its start to u: see mean_force().
template <DynamicalSystem System>
struct MeanForces {
  using MatrixType = typename System::MatrixType;

  const System& system;
  const SystemLoad<MatrixType>* load = nullptr;
  Vector start = {};  ///< of the way

  double energy(VectorIn u) const {
    double sum = mean_force_potential(system, start, u);
    if (load->has_pull())
      for (const double tau : gauss_points) sum += 0.5 / tau * load->net_pull_energy(at(tau, u));
    return sum;
  }
  /// What forces change by from the first Gauss point to the second.
  Vector change(VectorIn u) const {
    Vector first(u.size()), second(u.size());
    for (const auto& [tau, f] : {std::pair{gauss_points[0], &first}, std::pair{gauss_points[1], &second}}) {
      system.force(at(tau, u), *f);
      load->add_net_pull(at(tau, u), *f);
    }
    return second - first;
  }
  void elastic(VectorIn u, VectorOut f) const { mean_force(system, start, u, f); }
  void add_pull(VectorIn u, VectorOut pull) const {
    Vector sum = Vector::Zero(u.size());
    for (const double tau : gauss_points) load->add_net_pull(at(tau, u), sum);
    pull += 0.5 * sum;
  }
  void stiffness(VectorIn u, MatrixType& K) const {
    mean_stiffness(system, start, u, K);
    if (!load->has_pull()) return;
    for (const double tau : gauss_points) {  // loads add to a matrix without a factor
      K *= 2 / tau;
      load->add_stiffness(at(tau, u), K);
      K *= tau / 2;
    }
  }
  void rest_stiffness(MatrixType& K) const {
    system.stiffness(Vector::Zero(system.dim()), K);
    load->add_stiffness(Vector::Zero(system.dim()), K);
    K *= 0.5;
  }

 private:
  Vector at(double tau, VectorIn u) const { return start + tau * (u - start); }
};

struct AverageVectorFieldParameters {};  ///< it has none

/// Advances M ü + D u̇ + f(u) = f_ext with f averaged over the straight way of a step, which keeps the energy:
///   M (v⁺ − v) / h + D (u⁺ − u) / h + ∫₀¹ f(u + τ (u⁺ − u)) dτ = f_ext(t + h/2),  (u⁺ − u) / h = (v + v⁺) / 2.
/// The integral is Gauss's of two points, so for undamped St. Venant–Kirchhoff objects, and all others whose energy is a
/// polynomial of degree four, kinetic plus elastic energy changes by the work of the load alone, whatever the step. For
/// others there is a defect of O(h⁵) a step; where it exceeds a hundred-thousandth of the energy, the step is solved again
/// with weights of the two points that leave less. Linear momentum is kept, angular momentum but for O(h³) a step. For
/// linear forces this is average acceleration. A step minimises an incremental potential. \see Quispel & McLaren 2008.
///
///     AverageVectorField integrator(system, 0.005);
///     State state = integrator.at_rest();
///     integrator.balance(load, state);
///     for (int step = 0; step < 200; ++step) (void)integrator.step(load, state);
template <DynamicalSystem System>
class AverageVectorField : public ImplicitIntegrator<System, MeanForces<System>> {
  using Base = ImplicitIntegrator<System, MeanForces<System>>;

 public:
  using typename Base::MatrixType;
  using State = supple::State;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  AverageVectorField(const System& system, double h, const StepOptions& options = {},
                     const AverageVectorFieldParameters& = {})
      : Base("average vector field", system, h, options, 2 / (h * h), 1 / h) {}
  AverageVectorField(const System&&, double, const StepOptions& = {},
                     const AverageVectorFieldParameters& = {}) = delete;  // it would dangle

  int order() const { return 2; }
  EnergyBehaviour energy_behaviour() const { return EnergyBehaviour::Conserved; }

  /// One time step under a load that is evaluated amid it.
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    const double h = this->h_;
    const SystemLoad<MatrixType>& amid = load_at<MatrixType>(load, state.time + h / 2);
    this->check(amid, state);
    require_size("state.a", state.a.size(), this->system_.dim());
    this->objective_.forces().start = state.u;
    if (!account_ || last_.u.size() != state.u.size() || last_.u != state.u || last_.v != state.v) {
      account_.emplace(this->system_, this->options_.damping, state);
      last_ = state;
    }
    const double made_before = account_->now().made();
    State next = state;
    StepReport report =
        advance(amid, state, state.u + h * state.v + 0.5 * h * h * state.a, Vector::Zero(state.u.size()), next);
    if (report.status == Status::NotFinite) return report;
    EnergyAccount<System> account = *account_;
    account.add_step(amid, state, next);
    if (amid.has_potential()) correct(amid, state, made_before, next, account, report);
    account_ = account;
    state = last_ = std::move(next);
    return report;
  }

 private:
  static constexpr double negligible = 1e-5;  // energy made in a step, over what there is
  static constexpr int most_corrections = 3;

  /// The end of a step, from a guess, with a constant force c beside the mean forces.
  StepReport advance(const SystemLoad<MatrixType>& amid, const State& state, Vector guess, VectorIn c, State& next) {
    const double h = this->h_;
    this->objective_.begin(amid, state.u + h * state.v, state.u, Vector::Zero(state.u.size()));
    this->objective_.add_force(c);
    Vector u;
    const StepReport report = this->solve(amid, state.u, std::move(guess), u);
    if (report.status == Status::NotFinite) return report;
    next.u = u;
    next.v = 2 / h * (u - state.u) - state.v;
    next.a = (next.v - state.v) / h;
    next.time = state.time + h;
    return report;
  }

  /// Where two Gauss points leave a defect in the energy, weighs them a little differently: by a force along their
  /// difference, whose work makes up for it.
  void correct(const SystemLoad<MatrixType>& amid, const State& state, double made_before, State& next,
               EnergyAccount<System>& account, StepReport& report) {
    Vector c = Vector::Zero(state.u.size());
    for (int k = 0; k < most_corrections; ++k) {
      const double made = account.now().made() - made_before;
      if (!(std::abs(made) > negligible * (account.now().kinetic + account.now().elastic))) return;
      const Vector change = this->objective_.forces().change(next.u);
      const double work = change.dot(next.u - state.u);
      if (!(std::abs(made) < 0.1 * std::abs(work))) return;  // not a small matter of weights
      c += made / work * change;
      State corrected = state;
      const StepReport again = advance(amid, state, next.u, c, corrected);
      report.iterations += again.iterations;
      report.tangents += again.tangents;
      if (again.status != Status::Converged) return;
      EnergyAccount<System> then = *account_;
      then.add_step(amid, state, corrected);
      if (!(std::abs(then.now().made() - made_before) < std::abs(made))) return;
      report.status = again.status;
      report.residual = again.residual;
      next = std::move(corrected);
      account = then;
    }
  }

  std::optional<EnergyAccount<System>> account_;  // of the steps so far, while the state is the last one
  State last_;
};

static_assert(TimeIntegratorFor<AverageVectorField<archetype::Dynamics>, archetype::Dynamics>);

}  // namespace supple
