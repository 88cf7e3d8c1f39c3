#include <numerics/optimize/warm_solver.hpp>

#include <algorithm>
#include <concepts>

namespace supple {

namespace {

Index memory_of(const NonlinearSolver& method) {
  const Bfgs* bfgs = std::get_if<Bfgs>(&method);
  return bfgs ? bfgs->memory : 1;
}

template <SmoothObjective O>
void require_value(const O& objective) {
  require(has_value(objective), "a load has no potential, so there is nothing to minimise; Newton or Bfgs solve this");
}

}  // namespace

template <typename MatrixType>
WarmSolver<MatrixType>::WarmSolver(const NonlinearSolver& method) : method_(method), steps_(memory_of(method)) {}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::solve(Objective& objective, Vector& u, const SolveLimits& limits) {
  return std::visit([&](const auto& method) { return run(method, objective, u, limits); }, method_);
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::run(const Newton& newton, Objective& objective, Vector& u,
                                        const SolveLimits& limits) {
  forget();
  return newton(objective, solver_, u, limits);
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::run(const Bfgs& bfgs, Objective& objective, Vector& u, const SolveLimits& limits) {
  prepare(objective);
  return settled(bfgs(objective, solver_, steps_, u, limits));
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::run(const Broyden& broyden, Objective& objective, Vector& u,
                                        const SolveLimits& limits) {
  prepare(objective);
  return settled(broyden(objective, solver_, u, limits));
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::run(const LineSearchBfgs& bfgs, Objective& objective, Vector& u,
                                        const SolveLimits& limits) {
  require_value(objective);
  prepare(objective);
  const SolveReport report = settled(bfgs(objective, solver_, u, limits));
  if (report.tangents > 0) forget();
  return report;
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::run(const WarpedBfgs& bfgs, Objective& objective, Vector& u,
                                        const SolveLimits& limits) {
  if (!has_value(objective)) return run(Newton{}, objective, u, limits);
  const Vector start = u;
  const Index few = std::min(limits.max_iterations / 2, bfgs.max_iterations);
  const SolveReport first = run(LineSearchBfgs{.memory = bfgs.memory}, objective, u, {limits.tolerance, few});
  if (first.status == Status::Converged || first.status == Status::NotFinite) return first;
  u = start;
  SolveReport report = Newton{}(objective, tangent_, u, {limits.tolerance, limits.max_iterations - first.iterations});
  report.iterations += first.iterations;
  return report;
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::run(const Nlopt& nlopt, Objective& objective, Vector& u,
                                        const SolveLimits& limits) {
  if constexpr (std::same_as<MatrixType, Matrix>) {
    require_value(objective);
    prepare(objective);
    const auto evaluate = [&](VectorIn at, VectorOut g) {
      objective.gradient(at, g);
      return objective.value(at);
    };
    const auto residual = [&](VectorIn at, VectorIn g) { return relative_residual(g.norm(), objective.scale(at)); };
    return {minimize_by_nlopt(
                evaluate, residual, u,
                {.method = nlopt.method, .tolerance = limits.tolerance, .max_evaluations = 20 * limits.max_iterations},
                rest_factor_),
            0};
  } else {
    throw std::invalid_argument("NLopt's methods are for reduced systems");
  }
}

/// The Hessian at rest into the solver, unless it is there.
template <typename MatrixType>
void WarmSolver<MatrixType>::prepare(Objective& objective) {
  if (ready_) return;
  if (!rest_.factorize_at_rest(objective, solver_)) throw SolverError("the system matrix at rest is not finite");
  if constexpr (std::same_as<MatrixType, Matrix>)
    if (std::holds_alternative<Nlopt>(method_)) rest_factor_ = rest_.matrix().llt().matrixL();
  steps_.clear();
  ready_ = true;
}

template <typename MatrixType>
SolveReport WarmSolver<MatrixType>::settled(const SolveReport& report) {
  if (report.status == Status::Stagnated) forget();  // its last factorisation may have failed
  return report;
}

template class WarmSolver<Matrix>;
template class WarmSolver<SparseMatrix>;

}  // namespace supple
