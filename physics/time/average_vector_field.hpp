#pragma once
/// \file Average vector field method: energy stays in large deformations, too.

#include <physics/system/mean_force.hpp>
#include <physics/time/implicit_step.hpp>

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
/// polynomial of degree four, kinetic plus elastic energy changes by the work of the load alone, whatever the step; for
/// others but for O(h⁵) a step. Linear momentum is kept; angular momentum but for O(h³) a step. For linear forces this is
/// average acceleration. A step minimises an incremental potential. \see Quispel & McLaren 2008.
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
    this->objective_.begin(amid, state.u + h * state.v, state.u, Vector::Zero(state.u.size()));
    Vector u;
    const StepReport report = this->solve(amid, state.u, state.u + h * state.v + 0.5 * h * h * state.a, u);
    if (report.status == Status::NotFinite) return report;
    const Vector v = 2 / h * (u - state.u) - state.v;
    state.a = (v - state.v) / h;
    state.v = v;
    state.u = u;
    state.time += h;
    return report;
  }
};

static_assert(TimeIntegratorFor<AverageVectorField<archetype::Dynamics>, archetype::Dynamics>);

}  // namespace supple
