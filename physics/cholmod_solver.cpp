#include <core/check.hpp>
#include <core/parallel.hpp>
#include <physics/cholmod_solver.hpp>

#include <cholmod.h>

#include <algorithm>
#include <cstdint>
#include <dlfcn.h>
#include <mutex>
#include <string>
#include <vector>

namespace supple {

namespace {

/// Keeps OpenBLAS on one thread while at least one guard lives: the way it splits a product over threads
/// changes the bits of the result.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas() {
    const std::lock_guard lock(mutex_);
    if (guards_++ > 0 || !set_threads()) return;
    threads_before_ = get_threads()();
    set_threads()(1);
  }
  ~SingleThreadedBlas() {
    const std::lock_guard lock(mutex_);
    if (--guards_ == 0 && set_threads()) set_threads()(threads_before_);
  }
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;

 private:
  // Looked up at run time, because any BLAS may stand behind the system's libblas.
  static auto set_threads() -> void (*)(int) {
    static const auto function =
        reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "openblas_set_num_threads"));
    return function;
  }
  static auto get_threads() -> int (*)() {
    static const auto function = reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, "openblas_get_num_threads"));
    return function;
  }

  static inline std::mutex mutex_;
  static inline int guards_ = 0;
  static inline int threads_before_ = 1;
};

/// CHOLMOD's workspace and settings; one for each thread that calls it.
class Workspace {
 public:
  Workspace() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.try_catch = 1;  // no messages: failures are told by status
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.quick_return_if_not_posdef = 1;
  }
  ~Workspace() {
    cholmod_free_dense(&Y_, &common_);
    cholmod_free_dense(&E_, &common_);
    cholmod_finish(&common_);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  cholmod_common* get() { return &common_; }
  int status() const { return common_.status; }

  /// \throws SolverError if the last call failed for another reason than an indefinite matrix.
  void check(const char* task) const {
    switch (common_.status) {
      case CHOLMOD_OK:
      case CHOLMOD_NOT_POSDEF:
      case CHOLMOD_DSMALL:
        return;
      case CHOLMOD_OUT_OF_MEMORY:
        throw SolverError(std::string(task) + ": out of memory");
      case CHOLMOD_TOO_LARGE:
        throw SolverError(std::string(task) + ": the factor has too many entries for 32-bit indices");
      default:
        throw SolverError(std::string(task) + ": CHOLMOD fails with status " +
                          std::to_string(common_.status));
    }
  }

  /// x = A⁻¹ b for columns of b that lie b_stride apart, into columns without gaps.
  void solve(const cholmod_factor* L, const double* b, Index b_stride, double* x, Index cols) {
    cholmod_dense B = dense(const_cast<double*>(b), L->n, cols, b_stride);
    cholmod_dense X = dense(x, L->n, cols, static_cast<Index>(L->n));
    cholmod_dense* result = &X;  // as large as needed, so it is filled and not replaced
    cholmod_solve2(CHOLMOD_A, const_cast<cholmod_factor*>(L), &B, nullptr, &result, nullptr, &Y_, &E_,
                   &common_);
    check("solve");
  }

 private:
  static cholmod_dense dense(double* values, std::size_t rows, Index cols, Index stride) {
    cholmod_dense D{};
    D.nrow = rows;
    D.ncol = static_cast<std::size_t>(cols);
    D.d = static_cast<std::size_t>(stride);
    D.nzmax = D.d * D.ncol;
    D.x = values;
    D.xtype = CHOLMOD_REAL;
    D.dtype = CHOLMOD_DOUBLE;
    return D;
  }

  cholmod_common common_;
  cholmod_dense* Y_ = nullptr;
  cholmod_dense* E_ = nullptr;
};

/// A seen as CHOLMOD's symmetric matrix of which the lower triangle is stored; other entries are ignored.
cholmod_sparse lower_triangle(const SparseMatrix& A) {
  cholmod_sparse view{};
  view.nrow = static_cast<std::size_t>(A.rows());
  view.ncol = static_cast<std::size_t>(A.cols());
  view.nzmax = static_cast<std::size_t>(A.nonZeros());
  view.p = const_cast<int*>(A.outerIndexPtr());
  view.i = const_cast<int*>(A.innerIndexPtr());
  view.x = const_cast<double*>(A.valuePtr());
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

/// The graph of nodes: an entry (i, j) wherever A has one in that block. Values are zero.
SparseMatrix node_graph(const SparseMatrix& A, Index block_size) {
  const Index nodes = A.rows() / block_size;
  const int b = static_cast<int>(block_size);
  std::vector<int> start{0}, neighbours, seen(nodes, -1);
  start.reserve(nodes + 1);
  for (int node = 0; node < nodes; ++node) {
    const std::size_t first = neighbours.size();
    for (Index column = node * block_size; column < (node + 1) * block_size; ++column)
      for (SparseMatrix::InnerIterator entry(A, column); entry; ++entry) {
        const int neighbour = static_cast<int>(entry.row()) / b;
        if (seen[neighbour] == node) continue;
        seen[neighbour] = node;
        neighbours.push_back(neighbour);
      }
    std::sort(neighbours.begin() + static_cast<std::ptrdiff_t>(first), neighbours.end());
    start.push_back(static_cast<int>(neighbours.size()));
  }
  const std::vector<double> zeros(neighbours.size(), 0.0);
  return Eigen::Map<const SparseMatrix>(nodes, nodes, static_cast<Index>(neighbours.size()), start.data(),
                                        neighbours.data(), zeros.data());
}

/// Sizes and a hash of all indices: equal patterns have equal fingerprints.
std::uint64_t fingerprint(const SparseMatrix& A) {
  std::uint64_t hash = 14695981039346656037u;
  const auto mix = [&hash](std::uint64_t value) { hash = (hash ^ value) * 1099511628211u; };
  mix(static_cast<std::uint64_t>(A.rows()));
  for (Index j = 0; j <= A.outerSize(); ++j) mix(static_cast<std::uint32_t>(A.outerIndexPtr()[j]));
  for (Index k = 0; k < A.nonZeros(); ++k) mix(static_cast<std::uint32_t>(A.innerIndexPtr()[k]));
  return hash;
}

// METIS draws from the C library's generator, which it seeds first: one caller at a time gets the same
// ordering.
std::mutex ordering_mutex;

constexpr Index solve_block = 8;  // columns in one call: enough for matrix products, few enough to share out

}  // namespace

struct CholmodSolver::Factor {
  ~Factor() { cholmod_free_factor(&L, workspace.get()); }

  Workspace workspace;
  cholmod_factor* L = nullptr;
  double flops = 0, nonzeros = 0;
  std::uint64_t pattern = 0;
  bool ready = false;
};

CholmodSolver::CholmodSolver() = default;
CholmodSolver::~CholmodSolver() = default;
CholmodSolver::CholmodSolver(CholmodSolver&&) noexcept = default;
CholmodSolver& CholmodSolver::operator=(CholmodSolver&&) noexcept = default;

void CholmodSolver::analyze(const SparseMatrix& A, Index block_size) {
  require_size("columns of A", A.cols(), A.rows());
  require(A.rows() > 0, "analyze: A is empty");
  require(A.isCompressed(), "analyze: A is not compressed");
  require(
      block_size >= 1 && A.rows() % block_size == 0,
      "block_size is " + std::to_string(block_size) + ", expected a divisor of " + std::to_string(A.rows()));
  const SingleThreadedBlas blas_guard;
  auto factor = std::make_unique<Factor>();
  cholmod_common* common = factor->workspace.get();

  std::vector<int> order(A.rows());
  {
    const SparseMatrix graph = node_graph(A, block_size);
    cholmod_sparse nodes = lower_triangle(graph);
    common->nmethods = 2;  // the sparser factor wins; a CHOLMOD built without METIS skips it
    common->method[0].ordering = CHOLMOD_METIS;
    common->method[1].ordering = CHOLMOD_AMD;
    const std::lock_guard lock(ordering_mutex);
    cholmod_factor* L = cholmod_analyze(&nodes, common);
    factor->workspace.check("analyze");
    const int* node_order = static_cast<const int*>(L->Perm);
    for (Index k = 0; k < A.rows(); ++k)
      order[k] = node_order[k / block_size] * static_cast<int>(block_size) + static_cast<int>(k % block_size);
    cholmod_free_factor(&L, common);
  }
  cholmod_sparse rows = lower_triangle(A);
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_GIVEN;
  factor->L = cholmod_analyze_p(&rows, order.data(), nullptr, 0, common);
  factor->workspace.check("analyze");
  factor->flops = common->fl;
  factor->nonzeros = static_cast<double>(factor->L->xsize);
  factor->pattern = fingerprint(A);
  factor_ = std::move(factor);
}

bool CholmodSolver::factorize(const SparseMatrix& A) {
  require(factor_ != nullptr, "factorize: no matrix has been analysed");
  require(A.isCompressed() && A.rows() == dim() && A.cols() == dim() && fingerprint(A) == factor_->pattern,
          "factorize: A has another pattern than the matrix analysed");
  factor_->ready = false;
  if (!A.coeffs().allFinite()) return false;
  const SingleThreadedBlas blas_guard;
  cholmod_sparse rows = lower_triangle(A);
  cholmod_factorize(&rows, factor_->L, factor_->workspace.get());
  factor_->workspace.check("factorize");
  factor_->ready = factor_->workspace.status() == CHOLMOD_OK && factor_->L->minor == factor_->L->n;
  return factor_->ready;
}

Vector CholmodSolver::solve(VectorIn b) const {
  Vector x(b.size());
  solve(MatrixIn(b), MatrixOut(x));
  return x;
}

void CholmodSolver::solve(MatrixIn B, MatrixOut X) const {
  require(factor_ && factor_->ready, "solve: there is no factorisation");
  require_size("rows of B", B.rows(), dim());
  require_size("rows of X", X.rows(), dim());
  require_size("columns of X", X.cols(), B.cols());
  const SingleThreadedBlas blas_guard;
  parallel_ranges(B.cols(), solve_block, [&](Index begin, Index end) {
    Workspace workspace;
    Matrix block(dim(), end - begin);
    workspace.solve(factor_->L, B.col(begin).data(), B.outerStride(), block.data(), end - begin);
    X.middleCols(begin, end - begin) = block;
  });
}

Index CholmodSolver::dim() const {
  return factor_ ? static_cast<Index>(factor_->L->n) : 0;
}
Index CholmodSolver::factor_nonzeros() const {
  return factor_ ? static_cast<Index>(factor_->nonzeros) : 0;
}
double CholmodSolver::factor_flops() const {
  return factor_ ? factor_->flops : 0;
}

}  // namespace supple
