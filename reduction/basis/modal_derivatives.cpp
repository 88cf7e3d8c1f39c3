#include <core/check.hpp>
#include <core/parallel.hpp>
#include <numerics/linear/cholmod_solver.hpp>
#include <numerics/linear/matrix_sums.hpp>
#include <numerics/linear/tall_qr.hpp>
#include <reduction/basis/force_curvature.hpp>
#include <reduction/basis/kept_modes.hpp>
#include <reduction/basis/modal_derivatives.hpp>

#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple {

namespace {

/// Solves K X = B among the fields M-orthogonal to those without energy, for many right-hand sides.
class StaticResponse {
 public:
  /// \param without_energy  M-orthonormal columns.  \param lambda  lowest eigenvalue beside them [1/s²].
  StaticResponse(const SparseMatrix& K, const Vector& mass, Matrix without_energy, double lambda)
      : K_(K), mass_(mass), without_energy_(std::move(without_energy)) {
    cholesky_.analyze(K, 3);
    if (without_energy_.cols() == 0) {
      if (!cholesky_.factorize(K)) throw SolverError("modal derivatives: K is not positive definite at rest");
      return;
    }
    // every refinement gains the digits of λ / σ; rounding may leave K slightly indefinite
    for (double sigma = 1e-5 * lambda; sigma < 0.1 * lambda; sigma *= 100) {
      SparseMatrix shifted = K;
      add_diagonal(shifted, sigma * mass);
      if (cholesky_.factorize(shifted)) return;
    }
    throw SolverError("modal derivatives: K is not positive semi-definite at rest");
  }

  /// X, and the largest ‖B − K X‖ / ‖B‖ of its columns.
  std::pair<Matrix, double> solve(Matrix B, double tolerance) const {
    remove_loads(B);
    Matrix X = Matrix::Zero(B.rows(), B.cols()), rest = B, step(B.rows(), B.cols());
    double residual = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 20; ++round) {
      cholesky_.solve(rest, step);
      remove_motions(step);
      const Matrix X_next = X + step;
      rest = B - product(X_next);
      remove_loads(rest);
      double worst = 0;
      for (Index j = 0; j < B.cols(); ++j)
        if (const double size = B.col(j).norm(); size > 0) worst = std::max(worst, rest.col(j).norm() / size);
      if (!(worst < residual)) break;  // rounding
      X = X_next;
      const bool slow = worst > 0.5 * residual;
      residual = worst;
      if (slow || residual <= tolerance) break;
    }
    return {std::move(X), residual};
  }

 private:
  Matrix product(const Matrix& X) const {
    Matrix Y(X.rows(), X.cols());
    parallel_for(X.cols(), [&](Index j) { Y.col(j).noalias() = K_ * X.col(j); });
    return Y;
  }
  void remove_loads(Matrix& B) const {
    if (without_energy_.cols() > 0) B -= mass_.asDiagonal() * (without_energy_ * (without_energy_.transpose() * B));
  }
  void remove_motions(Matrix& X) const {
    if (without_energy_.cols() > 0) X -= without_energy_ * (without_energy_.transpose() * (mass_.asDiagonal() * X));
  }

  const SparseMatrix& K_;
  const Vector& mass_;
  Matrix without_energy_;
  CholmodSolver cholesky_;
};

/// (i, j), i ≤ j, in order: of all pairs of these modes, or of those `count` whose product of eigenvalues is smallest.
std::vector<std::array<Index, 2>> softest_pairs(VectorIn omega, Index first, Index count) {
  std::vector<std::array<Index, 2>> pairs;
  for (Index i = first; i < omega.size(); ++i)
    for (Index j = i; j < omega.size(); ++j) pairs.push_back({i, j});
  if (count == 0 || count >= static_cast<Index>(pairs.size())) return pairs;
  std::ranges::stable_sort(pairs, {}, [&](const auto& pair) { return omega[pair[0]] * omega[pair[1]]; });
  pairs.resize(count);
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace

ModalDerivativeVectors modal_derivatives(const RestState& object, const VibrationModes& modes, double tolerance,
                                         const Progress& progress, Index num_pairs) {
  require_size("modes.vectors", modes.vectors.rows(), 3 * object.numbering.num_nodes());
  const Index first = modes.num_zero, r = modes.vectors.cols() - first;
  require(r > 0, "modal derivatives: no mode has energy");
  require(num_pairs >= 0, "number of pairs is " + std::to_string(num_pairs) + ", expected 0 or more");
  tell(progress, "modal derivatives", 0);
  const ForceCurvature H(object);
  Matrix phi = object.restrict(modes.vectors.rightCols(r));
  Vector sizes(r);  // modes of one size add up without loss of digits
  for (Index i = 0; i < r; ++i) phi.col(i) /= sizes[i] = H.size(phi.col(i));
  const Matrix own = H.squares(phi);  // H(φ_i, φ_i)

  ModalDerivativeVectors result;
  result.pairs = softest_pairs(modes.omega, first, num_pairs);
  const Index count = static_cast<Index>(result.pairs.size());
  result.vectors.resize(modes.vectors.rows(), count);
  const StaticResponse respond(object.K, object.mass, object.restrict(modes.vectors.leftCols(first)),
                               modes.omega[first] * modes.omega[first]);
  constexpr Index at_once = 32;  // bounds the memory
  for (Index begin = 0; begin < count; begin += at_once) {
    Matrix loads(phi.rows(), std::min(at_once, count - begin));
    const auto modes_of = [&](Index k) {
      return std::pair(result.pairs[begin + k][0] - first, result.pairs[begin + k][1] - first);
    };
    Matrix sums(phi.rows(), loads.cols());
    for (Index k = 0; k < sums.cols(); ++k) {
      const auto [i, j] = modes_of(k);
      sums.col(k) = phi.col(i) + phi.col(j);
    }
    const Matrix squares = H.squares(sums);
    for (Index k = 0; k < loads.cols(); ++k) {
      const auto [i, j] = modes_of(k);
      loads.col(k) = -0.5 * sizes[i] * sizes[j] * (squares.col(k) - (own.col(i) + own.col(j)));
    }
    const auto [theta, residual] = respond.solve(std::move(loads), tolerance);
    result.residual = std::max(result.residual, residual);
    result.vectors.middleCols(begin, theta.cols()) = object.expand(theta);
    tell(progress, "modal derivatives", static_cast<double>(begin + theta.cols()) / static_cast<double>(count));
  }
  if (!(result.residual <= std::max(1e-3, tolerance)))
    throw SolverError("modal derivatives: the static responses have a relative residual of " +
                      std::to_string(result.residual));
  return result;
}

DenseBasis ModalDerivatives::operator()(const RestState& object) const {
  object.require_space();
  const FreeComponents parts = find_free_components(object.stencils, object.stencil_size, object.numbering);
  require(parts.num_rigid_modes() + num_modes <= object.mass.size(),
          "number of modes is " + std::to_string(num_modes) + " beside " + std::to_string(parts.num_rigid_modes()) +
              " rigid ones, but the system has only " + std::to_string(object.mass.size()) + " unknowns");
  const VibrationModes modes =
      vibration_modes(object, {parts.num_rigid_modes() + num_modes, tolerance, seed, progress, checkpoint});
  const auto inputs = [&](Digest& digest) {
    digest.add(object.K).add(object.mass).add(object.positions).add(modes.vectors).add(modes.omega);
    digest.add(dimension).add(num_derivatives).add(num_pairs).add(affine_fields).add(derivative_tolerance);
    const Matrix state = object.restrict(modes.vectors.rightCols(1));
    Matrix force(state.rows(), 1);
    object.forces(state, force);  // derivatives depend on the law beyond K
    digest.add(force);
  };
  return checkpoint.keep("derivatives", inputs, [&] { return with_derivatives(object, modes); });
}

DenseBasis ModalDerivatives::with_derivatives(const RestState& object, const VibrationModes& modes) const {
  require(num_derivatives >= 0, "number of derivatives is " + std::to_string(num_derivatives) + ", expected 0 or more");
  const Index pairs = num_pairs != 0 || dimension > 0 ? num_pairs : 2 * num_derivatives;
  const ModalDerivativeVectors derivatives = modal_derivatives(object, modes, derivative_tolerance, progress, pairs);
  const Vector mass = object.mass_of_rows();
  SubspaceReport report = modes.report();
  if (derivatives.residual > derivative_tolerance)
    report.notes.push_back("modal derivatives have a relative residual of " +
                           std::to_string(1e6 * derivatives.residual) + "e-6, more than was asked for");

  // rigid or affine motions and the modes, which stay whatever the dimension
  const Index num_flexible = modes.vectors.cols() - modes.num_rigid;
  FreeComponents movable = modes.components;  // also parts that slide, which may turn and stretch in their planes
  movable.free.insert(movable.free.end(), movable.sliding.begin(), movable.sliding.end());
  const RowMatrix affine = affine_fields ? supple::affine_fields(object.positions, movable) : RowMatrix();
  const Index num_global = affine_fields ? 3 * affine.cols() : modes.num_rigid;
  RowMatrix start = RowMatrix::Zero(mass.size(), num_global + num_flexible);
  if (affine_fields) {
    for (Index v = 0; v < affine.rows(); ++v)
      for (int x = 0; x < 3; ++x)
        for (Index k = 0; k < affine.cols(); ++k) start(3 * v + x, 3 * k + x) = affine(v, k);
    for (const Index i : object.numbering.held_unknowns())
      start.row(3 * object.numbering.free_nodes()[i / 3] + i % 3).setZero();
  } else {
    start.leftCols(num_global) = modes.vectors.leftCols(num_global);
  }
  start.rightCols(num_flexible) = modes.vectors.rightCols(num_flexible);
  Orthonormalized base = mass_orthonormalize(start, mass);
  const Index kept = base.W.cols(), count = derivatives.vectors.cols();
  require(dimension == 0 || dimension >= kept, "the dimension is " + std::to_string(dimension) + ", but " +
                                                   std::to_string(kept) +
                                                   " are taken by the modes and the motions of free parts");

  RowMatrix all(mass.size(), kept + count);
  all << base.W, derivatives.vectors;
  Orthonormalized complete = mass_orthonormalize(all, mass);
  report.dropped = base.dropped + complete.dropped;
  const Matrix added = complete.W.rightCols(complete.W.cols() - kept);
  if (added.cols() == 0) return {std::move(complete.W), std::move(report)};

  Matrix coordinates = added.transpose() * (mass.asDiagonal() * derivatives.vectors);
  const Vector lambda = modes.omega.cwiseAbs2();
  const double lambda_1 = lambda[derivatives.pairs[0][0]];
  for (Index k = 0; k < count; ++k)
    coordinates.col(k) *= lambda_1 * lambda_1 / (lambda[derivatives.pairs[k][0]] * lambda[derivatives.pairs[k][1]]);
  const Eigen::JacobiSVD<Matrix> svd(coordinates, Eigen::ComputeThinU);
  report.singular_values = svd.singularValues();
  const Index asked = dimension > 0 ? dimension - kept : num_derivatives > 0 ? num_derivatives : added.cols();
  const Index wanted = std::min(asked, added.cols());
  if (dimension > kept + added.cols())
    report.notes.push_back("modes and all their derivatives span " + std::to_string(kept + added.cols()) +
                           " dimensions, fewer than the " + std::to_string(dimension) + " asked for");
  RowMatrix W(mass.size(), kept + wanted);
  W.leftCols(kept) = complete.W.leftCols(kept);
  const Matrix components = added * svd.matrixU();  // all of them: equal bits whatever the dimension
  W.rightCols(wanted) = components.leftCols(wanted);
  return {std::move(W), std::move(report)};
}

}  // namespace supple
