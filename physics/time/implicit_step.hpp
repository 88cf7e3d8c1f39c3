#pragma once
/// \file Implicit step of second order as a minimisation: what Newmark's method and its relatives share.

#include <numerics/optimize/warm_solver.hpp>
#include <physics/system/damping.hpp>
#include <physics/time/time_integrator.hpp>

#include <algorithm>

namespace supple {

/// What all implicit integrators of second order are told.
struct StepOptions {
  RayleighDamping damping = {};
  NonlinearSolver solver = Newton{};
  /// ‖M a + D v + f(u) − f_ext‖ against the largest of ‖M a‖, ‖D v‖, ‖f(u)‖, the dead forces and what springs and other
  /// outside forces exert together, k (u − u*), Euclidean norms: never against k u and k u*, which stiff springs make as
  /// large as they like. What remains of all terms by rounding alone counts as converged: a body at rest somewhere has no
  /// other forces.
  double tolerance = 1e-6;
  Index max_iterations = 60;  ///< of the nonlinear solver in a step
};

/// Elastic forces and the net pull of a load, where a step ends up: at u.
template <DynamicalSystem System>
struct ForcesAtOnce {
  using MatrixType = typename System::MatrixType;

  const System& system;
  const SystemLoad<MatrixType>* load = nullptr;

  double energy(VectorIn u) const { return system.energy(u) + load->net_pull_energy(u); }
  void elastic(VectorIn u, VectorOut f) const { system.force(u, f); }
  void add_pull(VectorIn u, VectorOut pull) const { load->add_net_pull(u, pull); }
  void stiffness(VectorIn u, MatrixType& K) const {
    system.stiffness(u, K);
    load->add_stiffness(u, K);
  }
  void rest_stiffness(MatrixType& K) const { stiffness(Vector::Zero(system.dim()), K); }
};

/// M a + D v + f(u) = f_ext for accelerations and velocities that are affine in the unknown u, a = c_m (u − ũ_m) and
/// v = ṽ + c_d (u − ũ_d), as a smooth objective:
///   φ(u) = ½ c_m ‖u − ũ_m‖²_M + ½ c_d ‖u − ũ_d‖²_D + ṽᵀ D u + E(u) + ½ ‖u − u*‖²_k − f_deadᵀ u.
/// So a step is the minimiser of an incremental potential, and Newton's line search is safe.
/// \tparam Forces  what of the object's forces and the load's pull a step balances: ForcesAtOnce, or MeanForces.
template <DynamicalSystem System, typename Forces = ForcesAtOnce<System>>
class StepObjective {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the objective.
  StepObjective(const System& system, const StepOptions& options, double c_m, double c_d)
      : system_(system),
        forces_{system},
        damping_(options.damping),
        tolerance_(options.tolerance),
        c_m_(c_m),
        c_d_(c_d),
        rounding_of_system_(rounding * (c_m_ * system.mass() + system.rest_stiffness().diagonal())) {}

  Forces& forces() { return forces_; }

  /// Where the step comes from. \param load  must stay during the solve.
  void begin(const SystemLoad<MatrixType>& load, Vector u_m, Vector u_d, VectorIn v_tilde) {
    forces_.load = &load;
    dead_force_ = load.dead_force();
    rounding_ = rounding_of_system_;
    if (load.has_stiffness()) rounding_ += rounding * load.stiffness.diagonal();
    u_m_ = std::move(u_m);
    if (!damping_.acts()) return;
    u_d_ = std::move(u_d);
    damping_force_ = damp(v_tilde);
  }

  /// A constant force c [N] beside f(u), for the step that began.
  void add_force(VectorIn c) { dead_force_ -= c; }

  Vector acceleration(VectorIn u) const { return c_m_ * (u - u_m_); }  ///< a

  bool has_value() const { return forces_.load->has_potential(); }
  double value(VectorIn u) const {
    const Vector du = u - u_m_;
    const double phi = 0.5 * c_m_ * du.dot(system_.mass().cwiseProduct(du)) + forces_.energy(u) - dead_force_.dot(u);
    return damping_.acts() ? phi + damping_value(u) : phi;
  }
  void gradient(VectorIn u, VectorOut g) {
    forces_.elastic(u, g);
    scale_ = std::max(g.norm(), dead_force_.norm());
    if (forces_.load->has_pull()) {
      Vector pull = Vector::Zero(u.size());
      forces_.add_pull(u, pull);
      scale_ = std::max(scale_, pull.norm());
      g += pull;
    }
    const Vector inertia = c_m_ * system_.mass().cwiseProduct(u - u_m_);
    scale_ = std::max({scale_, inertia.norm(), rounding_.cwiseProduct(u).norm() / tolerance_});
    g += inertia - dead_force_;
    if (!damping_.acts()) return;
    const Vector damping = damping_force_ + c_d_ * damp(u - u_d_);
    scale_ = std::max(scale_, damping.norm());
    g += damping;
  }
  void hessian(VectorIn u, MatrixType& H) const {
    forces_.stiffness(u, H);
    add_inertia(H);
  }
  void rest_hessian(MatrixType& H) const {
    forces_.rest_stiffness(H);
    add_inertia(H);
  }
  double scale(VectorIn) const { return scale_; }
  const Vector& metric() const { return system_.mass(); }
  BlockRotations frames(VectorIn u) const { return frames_of(system_, u); }

 private:
  void add_inertia(MatrixType& H) const {
    if (damping_.beta != 0) add_scaled(H, c_d_ * damping_.beta, system_.rest_stiffness());
    add_diagonal(H, (c_m_ + c_d_ * damping_.alpha) * system_.mass());
  }
  Vector damp(VectorIn v) const { return damping_force(system_, damping_, v); }
  double damping_value(VectorIn u) const {
    const Vector du = u - u_d_;
    return 0.5 * c_d_ * du.dot(damp(du)) + damping_force_.dot(u);
  }

  const System& system_;
  Forces forces_;
  RayleighDamping damping_;
  double tolerance_, c_m_, c_d_;
  static constexpr double rounding = 8 * std::numeric_limits<double>::epsilon();
  Vector rounding_of_system_, rounding_;  // of the forces, relative to the displacements; with springs
  Vector dead_force_, u_m_, u_d_, damping_force_;
  double scale_ = 0;
};

/// What integrators of second order that solve one StepObjective a step have in common: checks, balance, energies and the
/// nonlinear solver. The integrator itself says where a step comes from and where its solution leads.
template <DynamicalSystem System, typename Forces = ForcesAtOnce<System>>
class ImplicitIntegrator {
 public:
  using MatrixType = typename System::MatrixType;
  using State = supple::State;

  double step_size() const { return h_; }  ///< [s]
  State at_rest() const { return State::at_rest(system_.dim()); }

  /// The acceleration that u and v imply under this load; call it after setting a state by hand.
  void balance(const SystemLoad<MatrixType>& load, State& state) const {
    check(load, state);
    Vector r(system_.dim());
    system_.force(state.u, r);
    load.add_pull(state.u, r);
    if (options_.damping.acts()) r += damping_force(system_, options_.damping, state.v);
    state.a = (load.force - r).cwiseQuotient(system_.mass());
    state.before.reset();
  }

  /// Kinetic plus elastic energy [J].
  double energy(const State& state) const { return kinetic_energy(state) + system_.energy(state.u); }
  double kinetic_energy(const State& state) const { return 0.5 * state.v.dot(system_.mass().cwiseProduct(state.v)); }

 protected:
  /// \param name  of the method, for messages.  \param c_m, c_d  see StepObjective.
  ImplicitIntegrator(const char* name, const System& system, double h, const StepOptions& options, double c_m,
                     double c_d)
      : system_(system), h_(h), options_(options), objective_(system, options, c_m, c_d), solver_(options.solver) {
    require(std::isfinite(h) && h > 0, "time step is " + std::to_string(h) + " s, expected > 0");
    require(options.tolerance > 0,
            std::string(name) + "'s tolerance is " + std::to_string(options.tolerance) + ", expected > 0");
  }

  void check(const SystemLoad<MatrixType>& load, const State& state) const {
    load.check(system_.dim());
    require_size("state.u", state.u.size(), system_.dim());
    require_size("state.v", state.v.size(), system_.dim());
  }

  /// The solution of the objective, found from `prediction`, or from `last` where that leaves the domain of the energy.
  StepReport solve(const SystemLoad<MatrixType>& load, VectorIn last, Vector prediction, Vector& u) {
    if (!load.has_same_pull(prepared_for_)) {
      solver_.forget();
      prepared_for_ = {{}, load.stiffness, load.others};
    }
    u = std::move(prediction);
    StepReport report = solver_(objective_, u, {options_.tolerance, options_.max_iterations});
    if (!solver_.was_definite_at_rest()) throw SolverError("the system matrix at rest is not positive definite");
    if (report.status == Status::NotFinite) {
      u = last;
      report = solver_(objective_, u, {options_.tolerance, options_.max_iterations});
    }
    return report;
  }

  const System& system_;
  const double h_;
  StepOptions options_;
  StepObjective<System, Forces> objective_;

 private:
  WarmSolver<MatrixType> solver_;
  SystemLoad<MatrixType> prepared_for_;
};

}  // namespace supple
