#include <reduction/reduced_modes.hpp>

#include <Eigen/Eigenvalues>

namespace supple {

ReducedModes reduced_modes(const Matrix& reduced_stiffness, std::optional<Index> num_rigid) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(reduced_stiffness);
  if (eigen.info() != Eigen::Success) throw SolverError("eigenvalues of the reduced stiffness did not converge");
  ReducedModes modes{eigen.eigenvalues().cwiseMax(0).cwiseSqrt(), eigen.eigenvectors(), num_rigid.value_or(0)};
  const double largest = modes.omega.size() > 0 ? modes.omega[modes.omega.size() - 1] : 0;
  if (!num_rigid)
    while (modes.num_zero < modes.omega.size() && modes.omega[modes.num_zero] <= 1e-5 * largest) ++modes.num_zero;
  require(modes.num_zero <= modes.omega.size(), "there are more rigid motions than modes");
  for (Index j = 0; j < modes.Phi.cols(); ++j) {  // one sign for every platform
    Index at;
    modes.Phi.col(j).cwiseAbs().maxCoeff(&at);
    if (modes.Phi(at, j) < 0) modes.Phi.col(j) *= -1;
  }
  return modes;
}

Vector ReducedModes::positive_omega() const {
  require(num_zero < omega.size(), "the reduced stiffness is zero");
  Vector result = omega;
  result.head(num_zero).setConstant(omega[num_zero]);
  return result;
}

double ReducedModes::softest_stiffness() const {
  require(num_zero < omega.size(), "the reduced stiffness is zero");
  return omega[num_zero] * omega[num_zero];
}

}  // namespace supple
