#include <core/check.hpp>
#include <numerics/linear/metis_mutex.hpp>
#include <numerics/linear/single_threaded_blas.hpp>
#include <numerics/linear/umfpack_solver.hpp>

#include <array>
#include <string>
#include <umfpack.h>

namespace supple {

/// UMFPACK's analysis and factors.
struct UmfpackSolver::Factor {
  Index dim = 0, num_nonzeros = 0;
  void* symbolic = nullptr;
  void* numeric = nullptr;
  std::array<double, UMFPACK_CONTROL> control;

  Factor() {
    umfpack_di_defaults(control.data());
    control[UMFPACK_STRATEGY] = UMFPACK_STRATEGY_SYMMETRIC;
    control[UMFPACK_ORDERING] = UMFPACK_ORDERING_METIS;
    control[UMFPACK_IRSTEP] = 0;  // Newton's next iteration corrects what refinement would
  }
  ~Factor() {
    free_numeric();
    if (symbolic) umfpack_di_free_symbolic(&symbolic);
  }
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  void free_numeric() {
    if (numeric) umfpack_di_free_numeric(&numeric);
    numeric = nullptr;
  }
};

namespace {

/// \throws SolverError for all but success and singular matrices.
void check(const char* what, int status) {
  if (status == UMFPACK_OK || status == UMFPACK_WARNING_singular_matrix) return;
  if (status == UMFPACK_ERROR_out_of_memory) throw SolverError(std::string(what) + ": out of memory");
  throw SolverError(std::string(what) + ": UMFPACK fails with status " + std::to_string(status));
}

}  // namespace

UmfpackSolver::UmfpackSolver() = default;
UmfpackSolver::~UmfpackSolver() = default;
UmfpackSolver::UmfpackSolver(UmfpackSolver&&) noexcept = default;
UmfpackSolver& UmfpackSolver::operator=(UmfpackSolver&&) noexcept = default;

void UmfpackSolver::analyze(const SparseMatrix& A) {
  require_size("columns of A", A.cols(), A.rows());
  require(A.rows() > 0, "analyze: A is empty");
  require(A.isCompressed(), "analyze: A is not compressed");
  auto factor = std::make_unique<Factor>();
  factor->dim = A.rows();
  factor->num_nonzeros = A.nonZeros();
  const std::lock_guard lock(metis_mutex);
  const int n = static_cast<int>(A.rows());
  check("analyze", umfpack_di_symbolic(n, n, A.outerIndexPtr(), A.innerIndexPtr(), nullptr, &factor->symbolic,
                                       factor->control.data(), nullptr));
  factor_ = std::move(factor);
}

bool UmfpackSolver::factorize(const SparseMatrix& A) {
  require(factor_ != nullptr, "factorize: no matrix has been analysed");
  require(A.isCompressed() && A.rows() == dim() && A.cols() == dim() && A.nonZeros() == factor_->num_nonzeros,
          "factorize: A has another pattern than the matrix analysed");
  factor_->free_numeric();
  if (!A.coeffs().allFinite()) return false;
  const SingleThreadedBlas guard;
  const int status = umfpack_di_numeric(A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr(), factor_->symbolic,
                                        &factor_->numeric, factor_->control.data(), nullptr);
  check("factorize", status);
  if (status != UMFPACK_OK) factor_->free_numeric();
  return status == UMFPACK_OK;
}

Vector UmfpackSolver::solve(VectorIn b) const {
  require(factor_ && factor_->numeric, "solve: there is no factorisation");
  require_size("b", b.size(), dim());
  Vector x(b.size());
  // without refinement A itself is not read again
  check("solve", umfpack_di_solve(UMFPACK_A, nullptr, nullptr, nullptr, x.data(), b.data(), factor_->numeric,
                                  factor_->control.data(), nullptr));
  return x;
}

Index UmfpackSolver::dim() const {
  return factor_ ? factor_->dim : 0;
}

}  // namespace supple
