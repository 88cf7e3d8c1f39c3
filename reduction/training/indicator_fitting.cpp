#include <numerics/linear/symmetric_eigen.hpp>
#include <reduction/training/indicator_fitting.hpp>

namespace supple {

OutsideModes outside_modes(const Matrix& remainders, const Vector& sizes, const SparseMatrix& K, const Vector& mass,
                           Index count) {
  require_size("sizes", sizes.size(), remainders.cols());
  require_size("mass", mass.size(), remainders.rows());
  const Matrix B = remainders * sizes.cwiseInverse().asDiagonal();
  const SymmetricEigen gram = symmetric_eigen(B.transpose() * (mass.asDiagonal() * B));
  const Vector& squared = gram.values;
  constexpr double nothing = 1e-12;  // share of the pose, squared: 10⁻⁶ of it
  const Index last = squared.size();
  count = std::min<Index>(count, (squared.array() > std::max(nothing, 1e-10 * squared[last - 1])).count());
  if (count == 0) return {Matrix(remainders.rows(), 0), Vector(), Matrix(0, remainders.cols())};
  OutsideModes modes;
  const Matrix V = B * gram.vectors.rightCols(count) * squared.tail(count).cwiseSqrt().cwiseInverse().asDiagonal();
  SymmetricEigen turned = symmetric_eigen(V.transpose() * (K * V));
  modes.V = V * turned.vectors;
  modes.stiffness = std::move(turned.values);
  modes.coordinates = modes.V.transpose() * (mass.asDiagonal() * B);
  return modes;
}

double ninth_decile(Vector sizes) {
  require(sizes.size() > 0, "there are no sizes");
  const Index at = 9 * (sizes.size() - 1) / 10;
  std::nth_element(sizes.begin(), sizes.begin() + at, sizes.end());
  return sizes[at];
}

}  // namespace supple
