#include <reduction/pipeline/training.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <Eigen/Eigenvalues>

namespace supple {

WorkingComponents working_components(const Selection& selection, const std::string& selector) {
  if ((selection.weights.array() < 0).any())
    throw SolverError("selector '" + selector +
                      "' gave negative weights, with which a reduced object may be unstable; choose one "
                      "that keeps them positive, such as " +
                      known_selectors().front());
  WorkingComponents result = with_positive_weights(selection.indices, selection.weights);
  if (result.indices.empty()) throw SolverError("the selector found no component with a positive weight");
  return result;
}

WorkingComponents with_positive_weights(std::span<const Index> indices, VectorIn weights) {
  WorkingComponents result;
  result.weights.resize(weights.size());
  for (Index k = 0; k < weights.size(); ++k)
    if (weights[k] > 0) {
      result.weights[static_cast<Index>(result.indices.size())] = weights[k];
      result.indices.push_back(indices[static_cast<std::size_t>(k)]);
    }
  result.weights.conservativeResize(static_cast<Index>(result.indices.size()));
  return result;
}

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(stiffness, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().segment(first, std::min(count, stiffness.rows() - first));
}

}  // namespace supple
