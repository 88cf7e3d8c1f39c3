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

FullError distance_from(const std::function<FullStates(const Matrix& linear, const Matrix& reduced)>& reference,
                        const AnySystem<Matrix>& system, const ReducedModes& modes, Matrix linear) {
  FullError result;
  double outside = 0, inside = 0, worst = 0;
  for (int halvings = 0; halvings <= 2 && linear.cols() > 0; ++halvings) {
    const Matrix reduced = equilibrium_poses(system, modes, linear);
    const FullStates states = reference(linear, reduced);
    std::vector<Index> left;
    for (Index t = 0; t < linear.cols(); ++t) {
      const double out = std::pow(states.outside[t], 2);
      const double in = (states.Q.col(t) - reduced.col(t)).squaredNorm() / std::pow(states.sizes[t], 2);
      if (!(states.residuals[t] < std::max(1e-6, 0.1 * std::sqrt(out + in)))) {
        left.push_back(t);
        continue;
      }
      outside += out;
      inside += in;
      worst = std::max(worst, out + in);
      ++result.loads;
      if (halvings > 0) ++result.halved;
    }
    linear = Matrix(0.5 * linear(Eigen::all, left));
  }
  result.unfinished = linear.cols();
  if (result.loads == 0) return result;
  const auto count = static_cast<double>(result.loads);
  result.outside = std::sqrt(outside / count);
  result.inside = std::sqrt(inside / count);
  result.total = std::sqrt((outside + inside) / count);
  result.worst = std::sqrt(worst);
  return result;
}

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(stiffness, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().segment(first, std::min(count, stiffness.rows() - first));
}

}  // namespace supple
