#pragma once
/// \file Nonlinear solver of any kind, with what it keeps from solve to solve.

#include <numerics/optimize/any_objective.hpp>
#include <numerics/optimize/line_search_bfgs.hpp>
#include <numerics/optimize/newton.hpp>
#include <numerics/optimize/nlopt_minimizer.hpp>
#include <numerics/optimize/quasi_newton.hpp>

#include <variant>

namespace supple {

/// LineSearchBfgs for full objects, whose Hessian is dear to factorise: only the one at rest is, and turns with the nodes.
/// Where a load has no potential, or this does not converge, Newton's method takes over.
struct WarpedBfgs {
  Index memory = 20;          ///< steps kept
  Index max_iterations = 30;  ///< about what Newton's method takes the time of, where that has to go on
};

/// One of NLopt's minimisers in coordinates where the Hessian at rest is I; for dense systems only, to compare with ours.
struct Nlopt {
  NloptMethod method = NloptMethod::Lbfgs;
};

/// How time integrators and static solvers find the root of their equations.
using NonlinearSolver = std::variant<Newton, Bfgs, Broyden, LineSearchBfgs, WarpedBfgs, Nlopt>;

/// A nonlinear solver with its memory: solves problems that differ little, one after the other. Quasi-Newton methods start
/// from the Hessian at u = 0, factorised once; forget() when that has changed. For dense and sparse matrices.
template <typename MatrixType>
class WarmSolver {
 public:
  explicit WarmSolver(const NonlinearSolver& method);

  /// Improves u until the residual is at most limits.tolerance. Not converging is reported and the best iterate kept.
  /// \throws SolverError if no shift makes the Hessian at rest definite; std::invalid_argument for a minimiser where
  /// there is nothing to minimise, and for NLopt on sparse systems.
  template <SmoothObjective O>
  SolveReport operator()(O& objective, Vector& u, const SolveLimits& limits) {
    ErasedObjective<O> erased(objective);
    return solve(erased, u, limits);
  }

  void forget() { ready_ = false; }
  /// Whether the Hessian at rest needed no shift, of the last solve that took it.
  bool was_definite_at_rest() const { return rest_.was_definite(); }

 private:
  using Objective = AnyObjective<MatrixType>;

  SolveReport solve(Objective& objective, Vector& u, const SolveLimits& limits);
  SolveReport run(const Newton& newton, Objective& objective, Vector& u, const SolveLimits& limits);
  SolveReport run(const Bfgs& bfgs, Objective& objective, Vector& u, const SolveLimits& limits);
  SolveReport run(const Broyden& broyden, Objective& objective, Vector& u, const SolveLimits& limits);
  SolveReport run(const LineSearchBfgs& bfgs, Objective& objective, Vector& u, const SolveLimits& limits);
  SolveReport run(const WarpedBfgs& bfgs, Objective& objective, Vector& u, const SolveLimits& limits);
  SolveReport run(const Nlopt& nlopt, Objective& objective, Vector& u, const SolveLimits& limits);
  void prepare(Objective& objective);
  SolveReport settled(const SolveReport& report);

  NonlinearSolver method_;
  SpdSolver<MatrixType> solver_;
  SpdSolver<MatrixType> tangent_;  // of Newton's method where another has the Hessian at rest
  ShiftedHessian<MatrixType> rest_;
  Matrix rest_factor_;  // Cholesky, for NLopt
  BfgsMemory steps_;
  bool ready_ = false;
};

extern template class WarmSolver<Matrix>;
extern template class WarmSolver<SparseMatrix>;

}  // namespace supple
