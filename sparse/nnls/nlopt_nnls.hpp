#pragma once
/// \file Non-negative least squares by bounded quasi-Newton methods: what the paper found too stiff, to
/// repeat its finding.

#include <sparse/nnls/nnls.hpp>

namespace supple {

enum class QuasiNewtonMethod {
  Lbfgs,            ///< limited-memory BFGS with bounds, a relative of L-BFGS-B (Nocedal 1980; Luksan)
  VariableMetric,   ///< shifted limited-memory variable metric, rank 2 (Vlček & Lukšan 2006)
  TruncatedNewton,  ///< preconditioned, with restarts (Dembo & Steihaug 1982)
  Ccsa,             ///< conservative convex separable approximations, with a diagonal quadratic (Svanberg 2002)
};

/// min ½ ‖A w − b‖² over w ≥ 0 by a general-purpose bounded minimiser from NLopt. Slow on ill-conditioned
/// columns, and its answer is approximate: zeros are exact only where a bound is active, gᵢ is small but
/// not zero. For comparison; use Nnls for an answer.
/// \see von Tycowicz et al. 2013, Sec. 4.1: "too stiff for projection-based solvers".
struct QuasiNewtonNnls {
  QuasiNewtonMethod method = QuasiNewtonMethod::Lbfgs;
  double tolerance = 1e-12;      ///< stop when a step changes the objective by less than this share
  Index max_evaluations = 5000;  ///< of objective and gradient

  /// Columns are normalised inside. The fit's method is Automatic, its passive set all that is positive.
  /// \throws std::invalid_argument if sizes do not fit. A NaN or infinity gives Status::NotFinite.
  /// \note O(n²) an evaluation, after O(rows n²) for AᵀA.
  NnlsFit operator()(MatrixIn A, VectorIn b) const;
};

}  // namespace supple
