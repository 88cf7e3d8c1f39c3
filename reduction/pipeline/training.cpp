#include <numerics/linear/symmetric_eigen.hpp>
#include <reduction/pipeline/training.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <sstream>

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

std::string weakness(const StiffnessRange& range, Index points, const ObjectTraits& traits) {
  std::ostringstream words;
  words.precision(2);
  words << "the " << points << " selected " << traits.component_name << " leave a direction with ";
  if (range.smallest > 1e-6)
    words << 100 * range.smallest << " % of its stiffness at rest";
  else
    words << (range.smallest < -1e-6 ? "a negative" : "no") << " stiffness at rest";
  words << (range.is_singular() ? ", and the object would have no shape of its own" : ", and move too far along it");
  return words.str();
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

EquilibriumPairs compare_equilibria(
    const std::function<FullStates(const Matrix& linear, const Matrix& reduced)>& reference,
    const AnySystem<Matrix>& system, const ReducedModes& modes, Matrix linear) {
  EquilibriumPairs pairs{Matrix(linear.rows(), linear.cols()), Vector(linear.cols()), Vector(linear.cols())};
  Index count = 0;
  for (int halvings = 0; halvings <= 2 && linear.cols() > 0; ++halvings) {
    const Matrix reduced = equilibrium_poses(system, modes, linear);
    const FullStates states = reference(linear, reduced);
    std::vector<Index> left;
    for (Index t = 0; t < linear.cols(); ++t) {
      const double outside = states.outside[t];
      const double inside = (states.Q.col(t) - reduced.col(t)).norm() / states.sizes[t];
      if (!(states.residuals[t] < std::max(1e-6, 0.1 * std::hypot(inside, outside)))) {
        left.push_back(t);
        continue;
      }
      pairs.reduced.col(count) = reduced.col(t);
      pairs.inside[count] = inside;
      pairs.outside[count] = outside;
      ++count;
      if (halvings > 0) ++pairs.halved;
    }
    linear = Matrix(0.5 * linear(Eigen::all, left));
  }
  pairs.reduced.conservativeResize(Eigen::NoChange, count);
  pairs.inside.conservativeResize(count);
  pairs.outside.conservativeResize(count);
  pairs.unfinished = linear.cols();
  return pairs;
}

FullError full_error_of(const EquilibriumPairs& pairs) {
  FullError error;
  error.loads = pairs.inside.size();
  error.halved = pairs.halved;
  error.unfinished = pairs.unfinished;
  if (error.loads == 0) return error;
  const double root = std::sqrt(static_cast<double>(error.loads));
  error.outside = pairs.outside.norm() / root;
  error.inside = pairs.inside.norm() / root;
  error.total = pairs.total().norm() / root;
  error.worst = pairs.total().maxCoeff();
  return error;
}

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count) {
  const Vector eigenvalues = symmetric_eigenvalues(stiffness);
  return eigenvalues.segment(first, std::min(count, stiffness.rows() - first));
}

}  // namespace supple
