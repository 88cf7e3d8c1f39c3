#pragma once
/// \file NLopt's gradient-based minimisers behind one adapter, to compare with ours.

#include <core/report.hpp>

#include <Eigen/Cholesky>

#include <functional>

namespace supple {

enum class NloptMethod {
  Lbfgs,            ///< limited-memory BFGS (Nocedal 1980; Lukšan)
  VariableMetric,   ///< shifted limited-memory variable metric, rank 2 (Vlček & Lukšan 2006)
  TruncatedNewton,  ///< with restarts (Dembo & Steihaug 1982)
  Slsqp,            ///< sequential quadratic programming, which keeps a dense BFGS matrix (Kraft 1994)
};

struct NloptOptions {
  NloptMethod method = NloptMethod::Lbfgs;
  double tolerance = 1e-6;       ///< relative residual ‖g‖ / scale to reach
  Index max_evaluations = 2000;  ///< of value and gradient together
};

/// value(u, g): φ(u), its gradient into g.
using ValueAndGradient = std::function<double(VectorIn u, VectorOut g)>;

/// Improves u by NLopt until `residual(u, g)` is at most the tolerance.
/// \param preconditioner  Cholesky factor L of a matrix close to the Hessian: NLopt then sees y = Lᵀ u, in which the
/// Hessian is near I, the warm start that our own methods have. Empty: u itself.
/// \return iterations are evaluations; the best iterate is kept, Stagnated if NLopt gives up before the tolerance,
/// which it may below 1e-9: its line searches compare values.
Report minimize_by_nlopt(const ValueAndGradient& objective,
                         const std::function<double(VectorIn u, VectorIn g)>& residual, Vector& u,
                         const NloptOptions& options = {}, const Matrix& preconditioner = {});

}  // namespace supple
