#pragma once
/// \file Nonlinear solver of any kind, with what it keeps from solve to solve.

#include <numerics/optimize/line_search_bfgs.hpp>
#include <numerics/optimize/newton.hpp>
#include <numerics/optimize/nlopt_minimizer.hpp>
#include <numerics/optimize/quasi_newton.hpp>

#include <concepts>
#include <variant>

namespace supple {

/// One of NLopt's minimisers in coordinates where the Hessian at rest is I; for dense systems only, to compare with ours.
struct Nlopt {
  NloptMethod method = NloptMethod::Lbfgs;
};

/// How time integrators and static solvers find the root of their equations.
using NonlinearSolver = std::variant<Newton, Bfgs, Broyden, LineSearchBfgs, Nlopt>;

/// A nonlinear solver with its memory: solves problems that differ little, one after the other. Quasi-Newton methods start
/// from the Hessian at u = 0, factorised once; forget() when that has changed.
template <typename MatrixType>
class WarmSolver {
 public:
  explicit WarmSolver(const NonlinearSolver& method) : method_(method), steps_(memory_of(method)) {}

  /// Improves u until the residual is at most limits.tolerance. Not converging is reported and the best iterate kept.
  /// \throws SolverError if no shift makes the Hessian at rest definite; std::invalid_argument for a minimiser where
  /// there is nothing to minimise, and for NLopt on sparse systems.
  template <SmoothObjective O>
  SolveReport operator()(O& objective, Vector& u, const SolveLimits& limits) {
    return std::visit([&](const auto& method) { return solve(method, objective, u, limits); }, method_);
  }

  void forget() { ready_ = false; }
  /// Whether the Hessian at rest needed no shift, of the last solve that took it.
  bool was_definite_at_rest() const { return rest_.was_definite(); }

 private:
  static Index memory_of(const NonlinearSolver& method) {
    const Bfgs* bfgs = std::get_if<Bfgs>(&method);
    return bfgs ? bfgs->memory : 1;
  }

  template <SmoothObjective O>
  SolveReport solve(const Newton& newton, O& objective, Vector& u, const SolveLimits& limits) {
    forget();
    return newton(objective, solver_, u, limits);
  }
  template <SmoothObjective O>
  SolveReport solve(const Bfgs& bfgs, O& objective, Vector& u, const SolveLimits& limits) {
    prepare(objective);
    return settled(bfgs(objective, solver_, steps_, u, limits));
  }
  template <SmoothObjective O>
  SolveReport solve(const Broyden& broyden, O& objective, Vector& u, const SolveLimits& limits) {
    prepare(objective);
    return settled(broyden(objective, solver_, u, limits));
  }
  template <SmoothObjective O>
  SolveReport solve(const LineSearchBfgs& bfgs, O& objective, Vector& u, const SolveLimits& limits) {
    require_value(objective);
    prepare(objective);
    const SolveReport report = settled(bfgs(objective, solver_, u, limits));
    if (report.tangents > 0) forget();
    return report;
  }
  template <SmoothObjective O>
  SolveReport solve(const Nlopt& nlopt, O& objective, Vector& u, const SolveLimits& limits) {
    if constexpr (std::same_as<MatrixType, Matrix>) {
      require_value(objective);
      prepare(objective);
      const auto evaluate = [&](VectorIn at, VectorOut g) {
        objective.gradient(at, g);
        return objective.value(at);
      };
      const auto residual = [&](VectorIn at, VectorIn g) { return relative_residual(g.norm(), objective.scale(at)); };
      return {
          minimize_by_nlopt(
              evaluate, residual, u,
              {.method = nlopt.method, .tolerance = limits.tolerance, .max_evaluations = 20 * limits.max_iterations},
              rest_factor_),
          0};
    } else {
      throw std::invalid_argument("NLopt's methods are for reduced systems");
    }
  }

  /// The Hessian at rest into the solver, unless it is there.
  template <SmoothObjective O>
  void prepare(O& objective) {
    if (ready_) return;
    if (!rest_.factorize(objective, solver_, Vector::Zero(objective.metric().size())))
      throw SolverError("the system matrix at rest is not finite");
    if constexpr (std::same_as<MatrixType, Matrix>)
      if (std::holds_alternative<Nlopt>(method_)) rest_factor_ = rest_.matrix().llt().matrixL();
    steps_.clear();
    ready_ = true;
  }
  SolveReport settled(const SolveReport& report) {
    if (report.status == Status::Stagnated) forget();  // its last factorisation may have failed
    return report;
  }
  template <SmoothObjective O>
  static void require_value(const O& objective) {
    require(has_value(objective),
            "a load has no potential, so there is nothing to minimise; Newton or Bfgs solve this");
  }

  NonlinearSolver method_;
  SpdSolver<MatrixType> solver_;
  ShiftedHessian<MatrixType> rest_;
  Matrix rest_factor_;  // Cholesky, for NLopt
  BfgsMemory steps_;
  bool ready_ = false;
};

}  // namespace supple
