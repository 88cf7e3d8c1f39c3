#include <physics/body/material_law.hpp>
#include <reduction/pipeline/body_training.hpp>
#include <reduction/pipeline/reduction.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <Eigen/Eigenvalues>

namespace supple {

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(stiffness, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().segment(first, std::min(count, stiffness.rows() - first));
}

void check(const ReduceOptions& options) {
  require(options.points >= 1, "number of points is " + std::to_string(options.points) + ", expected at least 1");
  require(options.target_error >= 0, "target error is negative or not a number, expected 0 or more");
  require(options.equilibria.value_or(0) >= 0, "number of equilibria is negative, expected 0 or more");
  require(options.held_out_poses >= 0, "number of held-out poses is negative, expected 0 or more");
  check(options.subspace_choice());
  (void)AnySelector(options.selector);
}

InvertedPoses inverted_rule(std::string_view law, std::optional<InvertedPoses> asked) {
  const bool finite_energy = law == shell_law || material_law(law).finite_when_inverted;
  require(finite_energy || asked != InvertedPoses::Keep, "poses with inverted tets cannot be kept: the energy of " +
                                                             std::string(law) +
                                                             " is infinite there; expected shrink or redraw");
  return asked.value_or(finite_energy ? InvertedPoses::Keep : InvertedPoses::Shrink);
}

ReduceOptions ReduceOptions::paper() {
  ReduceOptions options;
  options.poses.count = 1000;
  options.poses.omega_exponent = 1;
  options.poses.amplitudes = {0.07};
  options.norm = ForceNorm::Mass;
  options.selector = "nn-htp";
  options.equilibria = 0;
  return options;
}

Index num_equilibria(const Body& body, const ReduceOptions& options) {
  const bool free_shell = std::holds_alternative<Shell>(body) && fixed_nodes(body).empty();
  const bool useful = options.given_poses.size() == 0 && !free_shell;
  return options.equilibria.value_or(useful ? options.poses.count / 3 : 0);
}

ObjectTraits traits_of(const Body& body, const ReduceOptions& options) {
  return {.diagonal = bounding_box(node_positions(body)).diagonal(),
          .inverted = inverted_rule(law(body), options.poses.inverted),
          .equilibria = num_equilibria(body, options),
          .thin = std::holds_alternative<Shell>(body),
          .component_name = std::string(component_name(body))};
}

ReducedModel reduce(const Body& body, const ReduceOptions& options, ReduceReport* report_out,
                    const Progress& progress) {
  check(options);
  StageClock stage(progress);
  const AnySelector select(options.selector, RunSeeds(options).selection);
  ReducedModel model;
  with_object(body, options, stage, [&](const auto& system, const auto& subspace) {
    auto reduction = reduce(system, subspace, traits_of(body, options), select, options, stage);
    static_cast<ReducedForces<AnyBasis>&>(model) = {std::move(reduction.subspace), std::move(reduction.rest_stiffness),
                                                    std::move(reduction.indices), std::move(reduction.weights)};
    if (report_out) *report_out = std::move(reduction.report);
  });
  model.body = body;
  model.subspace_name = options.subspace;
  return model;
}

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

}  // namespace supple
