#include <core/check.hpp>
#include <numerics/linear/cholmod_solver.hpp>
#include <numerics/linear/metis_mutex.hpp>
#include <numerics/linear/single_threaded_blas.hpp>
#include <numerics/linear/supernodal_factor.hpp>

#include <cholmod.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace supple {

namespace {

/// CHOLMOD's workspace and settings.
class Workspace {
 public:
  Workspace() {
    cholmod_start(&common_);
    common_.print = 0;
    common_.try_catch = 1;  // no messages: failures are told by status
    common_.supernodal = CHOLMOD_SUPERNODAL;
  }
  ~Workspace() { cholmod_finish(&common_); }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;

  cholmod_common* get() { return &common_; }
  void check() const {
    switch (common_.status) {
      case CHOLMOD_OK:
        return;
      case CHOLMOD_OUT_OF_MEMORY:
        throw SolverError("analyze: out of memory");
      case CHOLMOD_TOO_LARGE:
        throw SolverError("analyze: the factor has too many entries for 32-bit indices");
      default:
        throw SolverError("analyze: CHOLMOD fails with status " + std::to_string(common_.status));
    }
  }

 private:
  cholmod_common common_;
};

/// CHOLMOD's view of a symmetric pattern of which the lower triangle is read.
cholmod_sparse lower_triangle(Index n, const int* start, const int* rows) {
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(n);
  view.nzmax = static_cast<std::size_t>(start[n]);
  view.p = const_cast<int*>(start);
  view.i = const_cast<int*>(rows);
  view.stype = -1;
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_PATTERN;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

/// First row of each node, and n: rows in blocks of the given size or, if it is 0, consecutive rows with
/// equal pattern.
std::vector<int> node_starts(const SparseMatrix& A, Index block_size) {
  const int n = static_cast<int>(A.rows());
  const int* const start = A.outerIndexPtr();
  const int* const rows = A.innerIndexPtr();
  std::vector<int> nodes;
  for (int j = 0; j < n; ++j) {
    const bool joins = block_size > 0 ? j % block_size != 0
                                      : j > 0 && std::equal(rows + start[j - 1], rows + start[j], rows + start[j],
                                                            rows + start[j + 1]);
    if (!joins) nodes.push_back(j);
  }
  nodes.push_back(n);
  return nodes;
}

/// An order of the rows of A that keeps L sparse, found on the graph of nodes.
std::vector<int> fill_reducing_order(const SparseMatrix& A, const std::vector<int>& nodes, Workspace& workspace) {
  const int num_nodes = static_cast<int>(nodes.size()) - 1;
  std::vector<int> node_of(A.rows()), start{0}, neighbours, seen(num_nodes, -1);
  for (int v = 0; v < num_nodes; ++v) std::fill(node_of.begin() + nodes[v], node_of.begin() + nodes[v + 1], v);
  for (int v = 0; v < num_nodes; ++v) {
    const auto first = static_cast<std::ptrdiff_t>(neighbours.size());
    for (int k = A.outerIndexPtr()[nodes[v]]; k < A.outerIndexPtr()[nodes[v + 1]]; ++k) {
      const int neighbour = node_of[A.innerIndexPtr()[k]];
      if (std::exchange(seen[neighbour], v) != v) neighbours.push_back(neighbour);
    }
    std::sort(neighbours.begin() + first, neighbours.end());
    start.push_back(static_cast<int>(neighbours.size()));
  }
  cholmod_sparse graph = lower_triangle(num_nodes, start.data(), neighbours.data());
  cholmod_common* const common = workspace.get();
  common->nmethods = 2;  // the sparser factor wins; a CHOLMOD without METIS skips it
  common->method[0].ordering = CHOLMOD_METIS;
  common->method[1].ordering = CHOLMOD_AMD;
  const std::lock_guard lock(metis_mutex);
  cholmod_factor* L = cholmod_analyze(&graph, common);
  workspace.check();
  std::vector<int> order;
  order.reserve(A.rows());
  for (int k = 0; k < num_nodes; ++k)
    for (int v = static_cast<const int*>(L->Perm)[k], row = nodes[v]; row < nodes[v + 1]; ++row) order.push_back(row);
  cholmod_free_factor(&L, common);
  return order;
}

SupernodalPattern supernodal_pattern(const SparseMatrix& A, Index block_size) {
  Workspace workspace;
  std::vector<int> order = fill_reducing_order(A, node_starts(A, block_size), workspace);
  cholmod_sparse rows = lower_triangle(A.rows(), A.outerIndexPtr(), A.innerIndexPtr());
  cholmod_common* const common = workspace.get();
  common->nmethods = 1;
  common->method[0].ordering = CHOLMOD_GIVEN;
  cholmod_factor* L = cholmod_analyze_p(&rows, order.data(), nullptr, 0, common);
  workspace.check();
  const auto copy = [](const void* data, std::size_t count) {
    const int* const begin = static_cast<const int*>(data);
    return std::vector<int>(begin, begin + count);
  };
  const std::vector<int> row_start = copy(L->pi, L->nsuper + 1);
  SupernodalPattern pattern{
      copy(L->Perm, L->n), copy(L->super, L->nsuper + 1), {row_start.begin(), row_start.end()}, copy(L->s, L->ssize)};
  cholmod_free_factor(&L, common);
  return pattern;
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

}  // namespace

struct CholmodSolver::Factor {
  SupernodalFactor L;
  std::uint64_t pattern;
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
  require(block_size == 0 || (block_size > 0 && A.rows() % block_size == 0),
          "block_size is " + std::to_string(block_size) + ", expected 0 or a divisor of " + std::to_string(A.rows()));
  factor_ = std::make_unique<Factor>(Factor{{supernodal_pattern(A, block_size), A}, fingerprint(A)});
}

bool CholmodSolver::factorize(const SparseMatrix& A) {
  require(factor_ != nullptr, "factorize: no matrix has been analysed");
  require(A.isCompressed() && A.rows() == dim() && A.cols() == dim() && fingerprint(A) == factor_->pattern,
          "factorize: A has another pattern than the matrix analysed");
  const SingleThreadedBlas guard;
  factor_->ready = false;  // also if an exception follows
  factor_->ready = A.coeffs().allFinite() && factor_->L.factorize(A);
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
  factor_->L.solve(B, X);
}

Index CholmodSolver::dim() const {
  return factor_ ? factor_->L.dim() : 0;
}
Index CholmodSolver::factor_nonzeros() const {
  return factor_ ? static_cast<Index>(factor_->L.num_values()) : 0;
}
double CholmodSolver::factor_flops() const {
  return factor_ ? factor_->L.flops() : 0;
}

}  // namespace supple
