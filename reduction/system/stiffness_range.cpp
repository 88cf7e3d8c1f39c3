#include <core/check.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/stiffness_range.hpp>

namespace supple {

StiffnessRange stiffness_range(const Matrix& stiffness, const ReducedModes& exact) {
  require_size("stiffness.rows()", stiffness.rows(), exact.Phi.rows());
  const Index flexible = exact.omega.size() - exact.num_zero;
  if (flexible == 0) return {};
  const Matrix U = exact.Phi.rightCols(flexible) * exact.omega.tail(flexible).cwiseInverse().asDiagonal();
  const Vector eigenvalues = symmetric_eigenvalues(U.transpose() * stiffness * U);
  return {eigenvalues[0], eigenvalues[flexible - 1]};
}

}  // namespace supple
