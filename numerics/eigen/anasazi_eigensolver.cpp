#include <core/check.hpp>
#include <numerics/eigen/anasazi_adapter.hpp>
#include <numerics/eigen/eigensolver.hpp>
#include <numerics/eigen/zero_modes.hpp>
#include <numerics/linear/single_threaded_blas.hpp>
#include <numerics/linear/symmetric_eigen.hpp>

#include <AnasaziBasicEigenproblem.hpp>
#include <AnasaziBlockKrylovSchurSolMgr.hpp>
#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <sstream>
#include <string>

namespace supple {

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double zero_energy = 1e-13;         // times |y|ᵀ |A| |y|: below, an eigenvalue of A is taken for zero
constexpr double largest_rigid_force = 1e-6;  // times ‖A‖
constexpr Index dense_rows = 300;             // up to here a dense solver is as fast

/// Y = A X for a symmetric A: the columns of A serve as rows. Or |A| X, where entries(a) is |a|.
template <typename Entries = std::identity>
Matrix product(const SparseMatrix& A, MatrixIn X, const Entries& entries = {}) {
  const RowMatrix by_rows = X;
  RowMatrix Y(X.rows(), X.cols());
  parallel_ranges(A.cols(), 4096, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      Y.row(i).setZero();
      for (SparseMatrix::InnerIterator entry(A, i); entry; ++entry)
        Y.row(i) += entries(entry.value()) * by_rows.row(entry.row());
    }
  });
  return Y;
}

/// K φ = ω² M φ as the standard problem A y = ω² y with A = M^{−1/2} K M^{−1/2} and y = M^{1/2} φ, in the
/// orthogonal complement of the columns of `deflated`.
struct StandardProblem {
  SparseMatrix A;
  Matrix deflated;  // orthonormal
  double norm = 0;  // ‖A‖_∞, at least the largest eigenvalue
  // Of the column sums of |A|, the median and the smallest that is not 0: slivers of almost no mass, and stiff parts, have
  // the largest.
  double bulk = 0, softest = 0;

  /// Whether a dense solver, whose errors are relative to the largest eigenvalue, would lose digits of the small ones.
  bool is_graded() const { return norm > 1e4 * softest; }
};

/// What rounding may do to products of A with the columns of Y: the sizes of what cancels in them. A few stiff and light
/// nodes, which soft modes hardly see, make ‖A‖ a poor bound.
struct Rounding {
  Vector energies;  // |y|ᵀ |A| |y|
  Vector forces;    // ‖ |A| |y| ‖

  Rounding(const StandardProblem& problem, MatrixIn Y) {
    const double least = problem.is_graded() ? problem.softest : problem.norm;
    const Matrix sizes = Y.cwiseAbs(), sums = product(problem.A, sizes, [](double a) { return std::abs(a); });
    energies = sizes.cwiseProduct(sums).colwise().sum().transpose().cwiseMax(least);
    forces = sums.colwise().norm().transpose().cwiseMax(least);
  }
};

StandardProblem standard_problem(const SparseMatrix& K, const Vector& M_diagonal, const Matrix& rigid) {
  const Index n = K.rows();
  require_size("columns of K", K.cols(), n);
  require_size("M_diagonal", M_diagonal.size(), n);
  require(n > 0, "smallest_eigenpairs: K is empty");
  if (rigid.cols() > 0) require_size("rows of rigid", rigid.rows(), n);
  require(rigid.allFinite(), "smallest_eigenpairs: rigid has an entry that is not finite");
  Index worst = 0;
  require(M_diagonal.allFinite() && M_diagonal.minCoeff(&worst) > 0, "M_diagonal[" + std::to_string(worst) + "] is " +
                                                                         std::to_string(M_diagonal[worst]) +
                                                                         ", expected a positive mass everywhere");
  StandardProblem problem{K, Matrix(n, 0)};
  problem.A.makeCompressed();
  require(problem.A.coeffs().allFinite(), "smallest_eigenpairs: K has an entry that is not finite");
  const Vector scale = M_diagonal.cwiseSqrt().cwiseInverse();
  Vector column_sums = Vector::Zero(n);
  for (Index j = 0; j < n; ++j)
    for (SparseMatrix::InnerIterator entry(problem.A, j); entry; ++entry) {
      entry.valueRef() *= scale[entry.row()] * scale[j];
      column_sums[j] += std::abs(entry.value());
    }
  problem.norm = column_sums.maxCoeff<Eigen::PropagateNaN>();
  require(K.nonZeros() > 0 && K.coeffs().cwiseAbs().maxCoeff() > 0, "smallest_eigenpairs: K is zero");
  if (!(1e-120 < problem.norm && problem.norm < 1e120)) {  // squares of it would leave the range of numbers
    std::ostringstream norm;
    norm << problem.norm;
    throw InputError("stiffness over mass is " + norm.str() +
                     " 1/s², expected 1e-120 to 1e120; are the units of stiffness and density right?");
  }
  std::nth_element(column_sums.begin(), column_sums.begin() + n / 2, column_sums.end());
  problem.bulk = std::max(column_sums[n / 2], 1e-20 * problem.norm);
  problem.softest = problem.norm;
  for (const double sum : column_sums)  // nothing holds unknowns whose sum is rounding
    if (sum > 1e-20 * problem.norm) problem.softest = std::min(problem.softest, sum);
  Random random(0);
  Matrix probes(n, 2);
  for (double& value : probes.reshaped()) value = random.normal();
  const Matrix image = product(problem.A, probes);
  const Vector transposed = problem.A * probes.col(1);  // differs from `image` if A is not symmetric
  require((image.col(1) - transposed).norm() <= 1e-8 * problem.norm * probes.col(1).norm(),
          "smallest_eigenpairs: K is not symmetric");

  if (rigid.cols() > 0) {
    const Matrix fields = scale.cwiseInverse().asDiagonal() * rigid;
    Eigen::ColPivHouseholderQR<Matrix> qr(fields);
    qr.setThreshold(1e-10);
    problem.deflated = qr.householderQ() * Matrix::Identity(n, qr.rank());
  }
  return problem;
}

using Pairs = SymmetricEigen;

/// X minus its part in span(Q), twice for full accuracy.
void project_out(const Matrix& Q, Matrix& X) {
  if (Q.cols() == 0) return;
  for (int pass = 0; pass < 2; ++pass) tall::add_product(-1, Q, tall::inner_products(Q, X), 1, X);
}

/// Orthonormal columns with the span of X: two Cholesky–QR passes, or Householder's if X is too ill
/// conditioned for them.
Matrix orthonormalized(Matrix X) {
  X.colwise().normalize();
  for (int pass = 0; pass < 2; ++pass) {
    const Eigen::LLT<Matrix> gram(tall::inner_products(X, X));
    if (gram.info() != Eigen::Success || gram.matrixLLT().diagonal().minCoeff() < 1e-6)
      return Eigen::HouseholderQR<Matrix>(X).householderQ() * Matrix::Identity(X.rows(), X.cols());
    Matrix Q(X.rows(), X.cols());
    tall::add_product(1, X, gram.matrixU().solve(Matrix::Identity(X.cols(), X.cols())), 0, Q);
    X.swap(Q);
  }
  return X;
}

/// Best approximations of eigenpairs of A in span(X).
Pairs rayleigh_ritz(const SparseMatrix& A, Matrix X) {
  X = orthonormalized(std::move(X));
  const Matrix projected = tall::inner_products(X, product(A, X));
  const SymmetricEigen dense = symmetric_eigen(0.5 * (projected + projected.transpose()));
  Matrix vectors(X.rows(), X.cols());
  tall::add_product(1, X, dense.vectors, 0, vectors);
  return {dense.values, std::move(vectors)};
}

/// (A + σ I)⁻¹, with σ fitted to the lowest flexible eigenvalue.
class ShiftedInverse {
 public:
  ShiftedInverse(const StandardProblem& problem, std::uint64_t seed) : problem_(problem) {
    const Index n = problem.A.rows();
    // For a compact solid of N nodes, (π/L)² against (2/h)² with L/h = N^{1/3}. Slender ones have a far lower
    // frequency yet, and a shift that is much too small does less harm than one that is too large.
    const double first_guess = 1e-6 * problem.bulk * std::pow(static_cast<double>(n) / 3, -2.0 / 3);
    const double smallest = 1e-12 * problem.softest;
    shift_ = std::max(first_guess, smallest);
    factorize();
    for (int attempt = 0; attempt < 4; ++attempt) {
      const double flexible = lowest_flexible(seed);
      const bool fits = shift_ <= 0.2 * flexible && shift_ >= 1e-7 * flexible;
      const double better = std::max(1e-2 * flexible, smallest);
      if (fits || !std::isfinite(flexible) || std::abs(better - shift_) <= 0.5 * shift_) return;
      shift_ = better;
      factorize();
    }
  }

  double shift() const { return shift_; }
  Index blocks() const { return blocks_; }
  void solve(MatrixIn x, MatrixOut y) const {
    ++blocks_;
    cholesky_.solve(x, y);
  }

 private:
  void factorize() {
    SparseMatrix identity(problem_.A.rows(), problem_.A.cols());
    identity.setIdentity();
    for (;; shift_ *= 100) {
      const SparseMatrix shifted = problem_.A + shift_ * identity;
      if (cholesky_.dim() == 0) cholesky_.analyze(shifted);
      if (cholesky_.factorize(shifted)) return;
      // Rounding may leave K slightly indefinite, which a larger shift mends; more is the caller's mistake.
      if (shift_ > 1e-10 * problem_.norm) break;
    }
    throw SolverError("smallest_eigenpairs: K + σM is not positive definite for σ = " + std::to_string(shift_) +
                      " 1/s²: K has negative eigenvalues");
  }

  /// A rough value of the smallest eigenvalue that is not zero, by inverse iteration of a small block that
  /// grows if it finds motions without energy only.
  double lowest_flexible(std::uint64_t seed) const {
    const Index n = problem_.A.rows();
    for (const Index cols : {2, 16}) {
      Random random(seed);
      Matrix X(n, std::min(cols, n - problem_.deflated.cols()));
      for (double& value : X.reshaped()) value = random.normal();
      for (int step = 0; step < 3; ++step) {
        project_out(problem_.deflated, X);
        X = orthonormalized(std::move(X));
        solve(X, X);
      }
      project_out(problem_.deflated, X);
      const Pairs rough = rayleigh_ritz(problem_.A, std::move(X));
      const Vector zero = zero_energy * Rounding(problem_, rough.vectors).energies;
      for (Index j = 0; j < zero.size(); ++j)
        if (rough.values[j] > zero[j] && rough.values[j] > 1e-6 * rough.values.tail(1)[0]) return rough.values[j];
    }
    return std::numeric_limits<double>::infinity();
  }

  const StandardProblem& problem_;
  CholmodSolver cholesky_;
  double shift_ = 0;
  mutable Index blocks_ = 0;
};

/// Anasazi's timers and Teuchos' tables are global: one search at a time.
std::mutex anasazi_mutex;

struct Search {
  Index num_pairs;
  double tolerance;
  Index block_size;
  Index max_restarts;
  std::uint64_t seed;
};

/// The largest eigenvalues θ of the inverse in the orthogonal complement of `deflated`; those that did not
/// converge are left out.
Pairs search_largest(const ShiftedInverse& inverse, const Matrix& deflated, const Search& search,
                     const std::function<void()>& tick) {
  const std::lock_guard lock(anasazi_mutex);
  const Index n = deflated.rows();
  const auto random = std::make_shared<Random>(search.seed);
  using Problem = Anasazi::BasicEigenproblem<double, Multivector, BlockOperator>;
  const auto start = Teuchos::rcp(new Multivector(Matrix(n, search.block_size), random));
  Anasazi::MultiVecTraits<double, Multivector>::MvRandom(*start);
  const auto op = Teuchos::rcp(new BlockOperator{[&](MatrixIn x, MatrixOut y) {
    inverse.solve(x, y);
    tick();
  }});
  const auto problem = Teuchos::rcp(new Problem(op, start));
  problem->setHermitian(true);
  problem->setNEV(static_cast<int>(search.num_pairs));
  if (deflated.cols() > 0) problem->setAuxVecs(Teuchos::rcp(new Multivector(deflated, random)));
  if (!problem->setProblem()) throw SolverError("Anasazi does not accept the eigenproblem");

  const Index wanted_blocks = (search.num_pairs + search.block_size - 1) / search.block_size;
  const Index most_blocks = (n - deflated.cols()) / search.block_size - 1;
  const Index num_blocks = std::min(std::max(wanted_blocks + 16, 3 * wanted_blocks), most_blocks);
  Teuchos::ParameterList parameters;
  parameters.set("Which", "LM");
  parameters.set("Block Size", static_cast<int>(search.block_size));
  parameters.set("Num Blocks", static_cast<int>(num_blocks));
  parameters.set("Dynamic Extra NEV", true);
  parameters.set("Step Size", 1);
  parameters.set("Maximum Restarts", static_cast<int>(search.max_restarts));
  parameters.set("Convergence Tolerance", search.tolerance);
  parameters.set("Verbosity", 0);
  try {
    Anasazi::BlockKrylovSchurSolMgr<double, Multivector, BlockOperator> manager(problem, parameters);
    manager.solve();  // Unconverged only says that fewer pairs came out
  } catch (const SolverError&) {
    throw;
  } catch (const std::exception& error) {
    throw SolverError(std::string("Anasazi fails: ") + error.what());
  }
  const auto& solution = problem->getSolution();
  Pairs pairs{Vector(solution.numVecs), Matrix(n, solution.numVecs)};
  for (int j = 0; j < solution.numVecs; ++j) pairs.values[j] = solution.Evals[j].realpart;
  if (solution.numVecs > 0) pairs.vectors = solution.Evecs->copy();
  return pairs;
}

Matrix side_by_side(const Matrix& A, const Matrix& B) {
  Matrix both(A.rows(), A.cols() + B.cols());
  both << A, B;
  return both;
}

Pairs dense_pairs(const StandardProblem& problem) {
  const Index n = problem.A.rows(), k = problem.deflated.cols();
  if (k == 0) return symmetric_eigen(Matrix(problem.A));
  const Eigen::HouseholderQR<Matrix> qr(problem.deflated);
  const Matrix complement = Matrix(qr.householderQ()).rightCols(n - k);
  const Matrix projected = complement.transpose() * (problem.A * complement);
  const Pairs dense = symmetric_eigen(0.5 * (projected + projected.transpose()));
  return {dense.values, complement * dense.vectors};
}

/// The `count` smallest pairs as the largest of the inverse, which a dense solver finds beside any stiff part.
Pairs dense_pairs_of_inverse(const StandardProblem& problem, const ShiftedInverse& inverse, Index count) {
  const Index n = problem.A.rows();
  const auto apply_inverse = [&](Matrix X) {
    project_out(problem.deflated, X);
    inverse.solve(X, X);
    project_out(problem.deflated, X);
    return X;
  };
  const Matrix B = apply_inverse(Matrix::Identity(n, n));
  return rayleigh_ritz(problem.A, apply_inverse(symmetric_eigen(0.5 * (B + B.transpose())).vectors.rightCols(count)));
}

struct SparseResult {
  Pairs pairs;
  Index missed = 0, blocks = 0;
  double shift = 0;
  bool complete = true;  // the search for missed pairs, if asked for, came to an end
};

/// The `count` smallest pairs; fewer if the search did not converge.
SparseResult sparse_pairs(const StandardProblem& problem, Index count, const EigenOptions& options) {
  const ShiftedInverse inverse(problem, options.seed);
  const Index block_size = options.block_size;
  const Index available = problem.A.rows() - problem.deflated.cols();
  // About three solves for each pair; a search that takes longer stays just below its end.
  const double expected_blocks = 3.0 * static_cast<double>(count) / static_cast<double>(block_size) + 8;
  const Index blocks_before = inverse.blocks();
  const auto tick = [&] {
    const double done = static_cast<double>(inverse.blocks() - blocks_before) / expected_blocks;
    tell(options.progress, "eigenpairs", std::min(done, 0.95));
  };

  // The final inverse iteration turns residuals of the inverse into residuals of A of the same relative size.
  Search search{count, 0.3 * options.tolerance, block_size, options.max_restarts, options.seed};
  Matrix found = search_largest(inverse, problem.deflated, search, tick).vectors;
  SparseResult result;
  const auto polish = [&] {
    inverse.solve(found, found);
    project_out(problem.deflated, found);
    result.pairs = rayleigh_ritz(problem.A, std::move(found));
    found = result.pairs.vectors;
  };
  polish();
  const bool check = options.check_completeness && found.cols() == count && count < available;
  for (Index round = 0; check && round < count; ++round) {  // each brings at least one missed pair
    const Matrix taken = side_by_side(problem.deflated, found);
    ++search.seed;
    const Index probe_block = std::min(block_size, available - count);
    Search probe{1, 1e-3, probe_block, options.max_restarts, search.seed};
    const Pairs next = search_largest(inverse, taken, probe, tick);
    const double largest_kept = result.pairs.values[count - 1];
    const auto below = [&](double theta) {
      // A copy of the last frequency that the cut left out is nothing missed.
      return 1 / theta - inverse.shift() < largest_kept - 1e-6 * (largest_kept + inverse.shift());
    };
    result.complete = next.values.size() > 0;
    if (!result.complete || !below(next.values[0])) break;
    const Pairs more = search_largest(
        inverse, taken,
        {std::min(probe_block, count), search.tolerance, probe_block, options.max_restarts, search.seed}, tick);
    result.complete = more.values.size() > 0;
    if (!result.complete) break;
    for (const double theta : more.values) result.missed += below(theta);
    found = side_by_side(found, more.vectors);
    polish();
    result.pairs.values.conservativeResize(count);
    result.pairs.vectors.conservativeResize(Eigen::NoChange, count);
    found = result.pairs.vectors;
  }
  result.blocks = inverse.blocks();
  result.shift = inverse.shift();
  return result;
}

}  // namespace

EigenPairs smallest_eigenpairs(const SparseMatrix& K, const Vector& M_diagonal, const Matrix& rigid,
                               const EigenOptions& options) {
  const SingleThreadedBlas guard;
  const StandardProblem problem = standard_problem(K, M_diagonal, rigid);
  const Index n = K.rows();
  const Index available = n - problem.deflated.cols();
  require(options.num_modes >= 1 && options.num_modes <= available,
          "num_modes is " + std::to_string(options.num_modes) + ", expected 1 … " + std::to_string(available) +
              " (unknowns minus rigid fields)");
  require(options.tolerance > 0 && options.tolerance < 1,
          "tolerance is " + std::to_string(options.tolerance) + ", expected a number between 0 and 1");
  require(options.block_size >= 0, "block_size is " + std::to_string(options.block_size) + ", expected 0 or more");
  require(options.max_restarts >= 0,
          "max_restarts is " + std::to_string(options.max_restarts) + ", expected 0 or more");
  EigenPairs result;
  if (problem.deflated.cols() > 0) {
    result.rigid_residual = product(problem.A, problem.deflated).colwise().norm().maxCoeff() / problem.norm;
    require(result.rigid_residual <= largest_rigid_force,
            "smallest_eigenpairs: K times rigid is not zero, relative size " + std::to_string(result.rigid_residual));
  }

  EigenOptions chosen = options;
  if (chosen.block_size == 0) chosen.block_size = 4;
  chosen.block_size = std::min(chosen.block_size, options.num_modes);
  Pairs pairs;
  bool complete = true;
  const bool dense = problem.is_graded()
                         ? available < 2 * options.num_modes + 4 * chosen.block_size
                         : n <= dense_rows || 4 * (options.num_modes + 8 * chosen.block_size) > available;
  if (dense && problem.is_graded()) {
    const ShiftedInverse inverse(problem, options.seed);
    pairs = dense_pairs_of_inverse(problem, inverse, options.num_modes);
    result.shift = inverse.shift();
    result.report.iterations = 1;
  } else if (dense) {
    pairs = dense_pairs(problem);
    pairs.values.conservativeResize(options.num_modes);
    pairs.vectors.conservativeResize(Eigen::NoChange, options.num_modes);
    result.report.iterations = 1;
  } else {
    SparseResult sparse = sparse_pairs(problem, options.num_modes, chosen);
    pairs = std::move(sparse.pairs);
    complete = sparse.complete;
    result.missed = sparse.missed;
    result.shift = sparse.shift;
    result.report.iterations = sparse.blocks;
  }

  const Matrix force = product(problem.A, pairs.vectors) - pairs.vectors * pairs.values.asDiagonal();
  result.omega_squared = std::move(pairs.values);
  const Index r = result.omega_squared.size();
  const Rounding rounding(problem, pairs.vectors);
  result.residuals.resize(r);
  bool converged = complete && r == options.num_modes;
  for (Index j = 0; j < r; ++j) {
    const double scale = std::max(result.omega_squared[j] + result.shift, zero_energy * rounding.energies[j]);
    result.residuals[j] = force.col(j).norm() / scale;
    const double cancelled = dense && !problem.is_graded() ? problem.norm : rounding.forces[j];
    converged = converged && result.residuals[j] <= std::max(options.tolerance, 10 * epsilon * cancelled / scale);
  }
  result.extra_zero_modes = num_zero_modes(result.omega_squared, zero_energy * rounding.energies);
  result.vectors = M_diagonal.cwiseSqrt().cwiseInverse().asDiagonal() * pairs.vectors;
  for (Index j = 0; j < r; ++j) {
    const auto phi = result.vectors.col(j);
    const double largest = phi.cwiseAbs().maxCoeff();
    // The first of nearly equal entries, so that rounding does not decide between them.
    for (const double entry : phi)
      if (std::abs(entry) >= (1 - 1e-6) * largest) {
        if (entry < 0) result.vectors.col(j) *= -1;
        break;
      }
  }
  result.report.residual = r > 0 ? result.residuals.maxCoeff() : std::numeric_limits<double>::infinity();
  result.report.status = !result.vectors.allFinite() ? Status::NotFinite
                         : converged                 ? Status::Converged
                                                     : Status::MaxIterations;
  tell(options.progress, "eigenpairs", 1);
  return result;
}

}  // namespace supple
