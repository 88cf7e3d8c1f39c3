#include <reduction/training/force_fitting.hpp>

namespace supple {

Matrix force_metric(ForceNorm norm, const ReducedModes& modes) {
  if (norm == ForceNorm::Mass) return Matrix::Identity(modes.Phi.rows(), modes.Phi.cols());
  return modes.positive_omega().cwiseInverse().asDiagonal() * modes.Phi.transpose();
}

}  // namespace supple
