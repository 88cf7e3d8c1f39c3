#pragma once
/// \file Implicit Newmark time integration of any dynamical system.

#include <numerics/optimize/quasi_newton.hpp>
#include <physics/system/damping.hpp>
#include <physics/system/dynamical_system.hpp>

#include <algorithm>

namespace supple {

/// Displacements u [m], velocities v [m/s], accelerations a [m/s²] of the unknowns at one time [s].
struct State {
  Vector u, v, a;
  double time = 0;

  static State at_rest(Index dim) { return {Vector::Zero(dim), Vector::Zero(dim), Vector::Zero(dim), 0}; }
};

enum class NonlinearSolver {
  Newton,   ///< tangent and factorisation at every iteration; for the full system and for violent motions
  Bfgs,     ///< quasi-Newton from the Jacobian at rest, refreshed on demand, which learns from step to step: the
            ///< fastest for reduced systems
  Broyden,  ///< quasi-Newton likewise, which begins each step anew (the paper's choice for reduced systems)
};

struct NewmarkOptions {
  double beta = 0.25, gamma = 0.5;  ///< average acceleration; γ > ½ adds numerical damping, at first order
  RayleighDamping damping = {};
  NonlinearSolver solver = NonlinearSolver::Newton;
  /// ‖M a + D v + f(u) − f_ext‖ against the largest of these terms, Euclidean norms; the pull −k u of springs
  /// counts with f(u), the pull k u* of their targets with f_ext. What remains of these terms by rounding
  /// alone counts as converged: a body at rest somewhere has no other forces.
  double tolerance = 1e-6;
  Index max_iterations = 60;  ///< of the nonlinear solver in a step
};

/// What a step took. Not converging is reported here and the last iterate kept; the caller decides.
struct StepReport : Report {
  Index refreshes = 0;  ///< tangents computed and factorised
};

/// Advances M ü + D u̇ + f(u) = f_ext by the Newmark family (Newmark 1959; Hughes 2000, Sec. 9.1):
///   u⁺ = u + h v + h² ((½ − β) a + β a⁺),  v⁺ = v + h ((1 − γ) a + γ a⁺).
/// A step is the minimiser of an incremental potential, so Newton's line search is safe.
template <DynamicalSystem System>
class Newmark {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the integrator.  \param h  time step [s], > 0.
  Newmark(const System& system, double h, const NewmarkOptions& options = {})
      : system_(system), h_(h), options_(options), step_(system, h, options) {
    require(std::isfinite(h) && h > 0, "time step is " + std::to_string(h) + " s, expected > 0");
    require(options.beta > 0 && options.gamma > 0, "Newmark's beta and gamma have to be > 0 (implicit)");
    require(options.tolerance > 0, "Newmark's tolerance is " + std::to_string(options.tolerance) + ", expected > 0");
  }

  /// The acceleration that u and v imply under this load; call it after setting a state by hand.
  void balance(const AffineLoad<MatrixType>& load, State& state) const {
    check(load, state.u, state.v);
    Vector r(system_.dim());
    system_.force(state.u, r);
    if (load.has_stiffness()) r += load.stiffness * state.u;
    if (damped()) r += step_.damp(state.v);
    state.a = (load.force - r).cwiseQuotient(system_.mass());
  }

  /// One time step under a load that is evaluated at its end.
  StepReport step(const AffineLoad<MatrixType>& load, State& state) {
    check(load, state.u, state.v);
    require_size("state.a", state.a.size(), system_.dim());
    step_.begin(state, load);
    Vector u = state.u + h_ * state.v + 0.5 * h_ * h_ * state.a;
    StepReport report = solve(load, u);
    if (report.status == Status::NotFinite) {  // the prediction may leave the domain of the energy
      u = state.u;
      report = solve(load, u);
    }
    if (report.status == Status::NotFinite) return report;
    const Vector a = step_.acceleration(u);
    state.v += h_ * ((1 - options_.gamma) * state.a + options_.gamma * a);
    state.u = u;
    state.a = a;
    state.time += h_;
    return report;
  }

  /// Kinetic plus elastic energy [J].
  double energy(const State& state) const { return kinetic_energy(state) + system_.energy(state.u); }
  double kinetic_energy(const State& state) const { return 0.5 * state.v.dot(system_.mass().cwiseProduct(state.v)); }

 private:
  /// φ(u) = ½ c_m ‖u − ũ‖²_M + ½ c_d ‖u − ũ‖²_D + ṽᵀ D u + E(u) + ½ uᵀ k u − f_extᵀ u with ∂φ/∂u = M a + D v
  /// + f − f_ext.
  class Step {
   public:
    using MatrixType = typename System::MatrixType;

    Step(const System& system, double h, const NewmarkOptions& options)
        : system_(system),
          h_(h),
          options_(options),
          c_m_(1 / (options.beta * h * h)),
          c_d_(options.gamma / (options.beta * h)),
          rounding_(8 * std::numeric_limits<double>::epsilon() *
                    (c_m_ * system.mass() + system.rest_stiffness().diagonal())) {}

    void begin(const State& state, const AffineLoad<MatrixType>& load) {
      load_ = &load;
      u_tilde_ = state.u + h_ * state.v + h_ * h_ * (0.5 - options_.beta) * state.a;
      v_tilde_ = state.v + h_ * (1 - options_.gamma) * state.a;
      if (damped()) damping_force_ = damp(v_tilde_);
    }

    Vector acceleration(VectorIn u) const { return c_m_ * (u - u_tilde_); }

    double value(VectorIn u) const {
      const Vector du = u - u_tilde_;
      double phi = 0.5 * c_m_ * du.dot(system_.mass().cwiseProduct(du)) + system_.energy(u) - load_->force.dot(u);
      if (damped()) phi += 0.5 * c_d_ * du.dot(damp(du)) + damping_force_.dot(u);
      if (load_->has_stiffness()) phi += 0.5 * u.dot(load_->stiffness * u);
      return phi;
    }

    void gradient(VectorIn u, VectorOut g) {
      system_.force(u, g);
      if (load_->has_stiffness()) g += load_->stiffness * u;
      scale_ = std::max(g.norm(), load_->force.norm());
      const Vector inertia = c_m_ * system_.mass().cwiseProduct(u - u_tilde_);
      scale_ = std::max({scale_, inertia.norm(), rounding_.cwiseProduct(u).norm() / options_.tolerance});
      g += inertia - load_->force;
      if (!damped()) return;
      const Vector damping = damping_force_ + c_d_ * damp(u - u_tilde_);
      scale_ = std::max(scale_, damping.norm());
      g += damping;
    }

    void hessian(VectorIn u, MatrixType& H) const {
      system_.stiffness(u, H);
      complete(H, load_->stiffness);
    }
    /// Adds what a stiffness lacks of the system matrix.
    void complete(MatrixType& H, const MatrixType& load_stiffness) const {
      if (options_.damping.beta != 0) add_scaled(H, c_d_ * options_.damping.beta, system_.rest_stiffness());
      add_diagonal(H, (c_m_ + c_d_ * options_.damping.alpha) * system_.mass());
      if (load_stiffness.size() > 0) add_few(H, load_stiffness);
    }

    double scale(VectorIn) const { return scale_; }
    const Vector& metric() const { return system_.mass(); }

    Vector damp(VectorIn v) const {
      Vector result = options_.damping.alpha * system_.mass().cwiseProduct(v);
      if (options_.damping.beta != 0) result += options_.damping.beta * (system_.rest_stiffness() * v);
      return result;
    }
    bool damped() const { return options_.damping.alpha != 0 || options_.damping.beta != 0; }

   private:
    const System& system_;
    double h_;
    NewmarkOptions options_;
    double c_m_, c_d_;
    Vector rounding_;  // of the forces, relative to the displacements
    const AffineLoad<MatrixType>* load_ = nullptr;
    Vector u_tilde_, v_tilde_, damping_force_;
    double scale_ = 0;
  };

  bool damped() const { return step_.damped(); }

  void check(const AffineLoad<MatrixType>& load, VectorIn u, VectorIn v) const {
    require_size("load.force", load.force.size(), system_.dim());
    if (load.has_stiffness()) require_size("load.stiffness", load.stiffness.rows(), system_.dim());
    require_size("state.u", u.size(), system_.dim());
    require_size("state.v", v.size(), system_.dim());
  }

  /// From u to the displacements at the end of the step.
  StepReport solve(const AffineLoad<MatrixType>& load, Vector& u) {
    if (options_.solver == NonlinearSolver::Newton) {
      const Report newton = newton_minimize(
          step_, solver_, u, {.tolerance = options_.tolerance, .max_iterations = options_.max_iterations});
      return {newton, newton.iterations};
    }
    prepare_rest_jacobian(load);
    const QuasiNewtonOptions options{.tolerance = options_.tolerance, .max_iterations = options_.max_iterations};
    BroydenMemory broyden;
    const QuasiNewtonReport report = options_.solver == NonlinearSolver::Bfgs
                                         ? quasi_newton_solve(step_, solver_, bfgs_, u, options)
                                         : quasi_newton_solve(step_, solver_, broyden, u, options);
    if (report.status == Status::Stagnated) prepared_ = false;  // its last factorisation may have failed
    return {report, report.refreshes};
  }

  /// The solver starts from the Jacobian at rest, and again when the springs of the load have changed.
  void prepare_rest_jacobian(const AffineLoad<MatrixType>& load) {
    if (prepared_ && equal(load.stiffness, prepared_stiffness_)) return;
    MatrixType H;
    system_.stiffness(Vector::Zero(system_.dim()), H);
    step_.complete(H, load.stiffness);
    if (!solver_.factorize(H)) throw SolverError("the system matrix at rest is not positive definite");
    prepared_stiffness_ = load.stiffness;
    prepared_ = true;
    bfgs_.clear();
  }

  const System& system_;
  double h_;
  NewmarkOptions options_;
  Step step_;
  SpdSolver<MatrixType> solver_;
  BfgsMemory bfgs_{60};  // more help little and take longer than they save
  MatrixType prepared_stiffness_;
  bool prepared_ = false;
};

}  // namespace supple
