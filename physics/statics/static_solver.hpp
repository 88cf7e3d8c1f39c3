#pragma once
/// \file Static equilibrium of any dynamical system, by a choice of methods, solved again and again as loads change.

#include <numerics/optimize/warm_solver.hpp>
#include <physics/statics/equilibrium.hpp>

namespace supple {

struct StaticOptions {
  NonlinearSolver solver =
      Newton{};             ///< LineSearchBfgs from the Hessian at rest is the paper's choice for reduced systems
  double tolerance = 1e-6;  ///< residual against the forces of the object, see Equilibrium
  Index max_iterations = 200;
};

/// Minimises E(u) + ½ uᵀ k u − f_extᵀ u. Keeps factorisations between solves as long as the springs of the load stay.
template <DynamicalSystem System>
class StaticSolver {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the solver.
  explicit StaticSolver(const System& system, const StaticOptions& options = {})
      : system_(system), options_(options), solver_(options.solver) {
    require(options.tolerance > 0, "tolerance is " + std::to_string(options.tolerance) + ", expected > 0");
  }
  explicit StaticSolver(const System&&, const StaticOptions& = {}) = delete;  // it would dangle

  /// From u, the last equilibrium or zero, to the equilibrium under this load.
  /// \return not converging is reported and the best iterate kept, unless it is NotFinite. \throws as WarmSolver.
  SolveReport solve(const SystemLoad<MatrixType>& load, Vector& u) {
    require_size("u", u.size(), system_.dim());
    Equilibrium<System> objective(system_, load, options_.tolerance);
    if (!load.has_same_pull(prepared_for_)) {
      solver_.forget();
      prepared_for_ = {{}, load.stiffness, load.others};
    }
    return solver_(objective, u, {options_.tolerance, options_.max_iterations});
  }

 private:
  const System& system_;
  StaticOptions options_;
  WarmSolver<MatrixType> solver_;
  SystemLoad<MatrixType> prepared_for_;
};

}  // namespace supple
