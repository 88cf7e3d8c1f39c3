#include <core/check.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/stiffness_range.hpp>

#include <Eigen/Eigenvalues>

namespace supple {

StiffnessRange stiffness_range(const Matrix& stiffness, const ReducedModes& exact) {
  require_size("stiffness.rows()", stiffness.rows(), exact.Phi.rows());
  const Index flexible = exact.omega.size() - exact.num_zero;
  if (flexible == 0) return {};
  const Matrix U = exact.Phi.rightCols(flexible) * exact.omega.tail(flexible).cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(U.transpose() * stiffness * U, Eigen::EigenvaluesOnly);
  return {eigen.eigenvalues()[0], eigen.eigenvalues()[flexible - 1]};
}

}  // namespace supple
