#pragma once
/// \file Static equilibrium of any dynamical system, by a choice of methods, solved again and again as loads change.

#include <numerics/optimize/bfgs.hpp>
#include <numerics/optimize/nlopt_minimizer.hpp>
#include <physics/statics/equilibrium.hpp>

namespace supple {

enum class StaticMethod {
  Newton,  ///< tangent and factorisation at every step, shifted until definite; line search
  Bfgs,    ///< quasi-Newton from the inverse Hessian at rest (the paper's choice for reduced systems)
  Nlopt,   ///< one of NLopt's minimisers in coordinates where the Hessian at rest is I; dense systems only
};

struct StaticOptions {
  StaticMethod method = StaticMethod::Newton;
  double tolerance = 1e-6;  ///< residual ‖f(u) + k u − f_ext‖ against the largest of these terms
  Index max_iterations = 200;
  Index refresh_after = 0;  ///< for Bfgs, see BfgsOptions
  NloptMethod nlopt = NloptMethod::Lbfgs;
};

struct StaticReport : Report {
  Index tangents = 0;  ///< computed and factorised
};

/// Minimises E(u) + ½ uᵀ k u − f_extᵀ u. Keeps factorisations between solves as long as the springs of the load stay.
template <DynamicalSystem System>
class StaticSolver {
 public:
  using MatrixType = typename System::MatrixType;

  /// \param system  must outlive the solver.
  explicit StaticSolver(const System& system, const StaticOptions& options = {}) : system_(system), options_(options) {
    require(options.tolerance > 0, "tolerance is " + std::to_string(options.tolerance) + ", expected > 0");
  }

  /// From u, the last equilibrium or zero, to the equilibrium under this load.
  /// \return not converging is reported and the best iterate kept, unless it is NotFinite. \throws SolverError if no
  /// shift makes the Hessian at rest definite.
  StaticReport solve(const AffineLoad<MatrixType>& load, Vector& u) {
    require_size("u", u.size(), system_.dim());
    Equilibrium<System> objective(system_, load, options_.tolerance);
    if (options_.method == StaticMethod::Newton) {
      const Report newton = newton_minimize(
          objective, solver_, u, {.tolerance = options_.tolerance, .max_iterations = options_.max_iterations});
      prepared_ = false;
      return {newton, newton.iterations};
    }
    if (!prepared_ || !equal(load.stiffness, prepared_stiffness_)) prepare(objective);
    if (options_.method == StaticMethod::Bfgs) {
      const BfgsReport bfgs = bfgs_minimize(objective, solver_, u,
                                            {.tolerance = options_.tolerance,
                                             .max_iterations = options_.max_iterations,
                                             .refresh_after = options_.refresh_after});
      if (bfgs.refreshes > 0 || bfgs.status == Status::Stagnated) prepared_ = false;
      return {bfgs, bfgs.refreshes};
    }
    return by_nlopt(objective, u);
  }

 private:
  void prepare(Equilibrium<System>& objective) {
    detail::ShiftedHessian<MatrixType> hessian;
    if (!hessian.factorize(objective, solver_, Vector::Zero(system_.dim())))
      throw SolverError("the stiffness at rest is not finite");
    if constexpr (std::same_as<MatrixType, Matrix>)
      if (options_.method == StaticMethod::Nlopt) factor_ = hessian.matrix().llt().matrixL();
    prepared_stiffness_ = objective.load().stiffness;
    prepared_ = true;
  }

  StaticReport by_nlopt(Equilibrium<System>& objective, Vector& u) {
    require((std::same_as<MatrixType, Matrix>), "NLopt's methods are for reduced systems");
    const auto evaluate = [&](VectorIn at, VectorOut g) {
      objective.gradient(at, g);
      return objective.value(at);
    };
    const auto residual = [&](VectorIn at, VectorIn g) { return detail::relative(g.norm(), objective.scale(at)); };
    return {minimize_by_nlopt(evaluate, residual, u,
                              {.method = options_.nlopt,
                               .tolerance = options_.tolerance,
                               .max_evaluations = 20 * options_.max_iterations},
                              factor_),
            0};
  }

  const System& system_;
  StaticOptions options_;
  SpdSolver<MatrixType> solver_;
  Matrix factor_;
  MatrixType prepared_stiffness_;
  bool prepared_ = false;
};

}  // namespace supple
