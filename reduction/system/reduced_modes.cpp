#include <numerics/eigen/zero_modes.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <reduction/system/reduced_modes.hpp>

namespace supple {

ReducedModes reduced_modes(const Matrix& reduced_stiffness, std::optional<Index> num_zero) {
  require(reduced_stiffness.rows() > 0, "the reduced stiffness is empty");
  const SymmetricEigen eigen = symmetric_eigen(reduced_stiffness);
  const Vector eigenvalues = eigen.values.cwiseMax(0);
  ReducedModes modes{eigenvalues.cwiseSqrt(), eigen.vectors, 0};
  modes.num_zero =
      num_zero ? *num_zero
               : num_zero_modes(eigenvalues, Vector::Constant(eigenvalues.size(), 1e-10 * eigenvalues.maxCoeff()));
  require(modes.num_zero <= eigenvalues.size(), "there are more motions without energy than modes");
  for (Index j = 0; j < modes.Phi.cols(); ++j) {  // one sign for every platform
    Index at;
    modes.Phi.col(j).cwiseAbs().maxCoeff(&at);
    if (modes.Phi(at, j) < 0) modes.Phi.col(j) *= -1;
  }
  return modes;
}

Vector ReducedModes::positive_omega() const {
  (void)softest_stiffness();
  Vector result = omega;
  result.head(num_zero).setConstant(omega[num_zero]);
  return result;
}

double ReducedModes::softest_stiffness() const {
  require(num_zero < omega.size(), "the reduced stiffness is zero");
  require(omega[num_zero] > 0, "the reduced stiffness has more than " + std::to_string(num_zero) +
                                   " motions without energy, expected no more than the modes of the object have");
  return omega[num_zero] * omega[num_zero];
}

}  // namespace supple
