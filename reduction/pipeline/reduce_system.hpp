#pragma once
/// \file The main job for force models, subspaces and selectors of one's own types.

#include <reduction/pipeline/reduce_stages.hpp>
#include <sparse/selection/explain_subset_selector.hpp>
#include <sparse/selectors/nn_sp.hpp>

#include <memory>
#include <vector>

namespace supple {

/// Few components of an object, in a subspace, that stand for all.
template <ForceModel Model, Subspace S>
struct Reduction {
  std::shared_ptr<const FullSystem<Model>> full;
  std::shared_ptr<const S> subspace;
  Matrix rest_stiffness;       ///< UᵀK(0)U, exact, d × d
  std::vector<Index> indices;  ///< selected components, ascending
  Vector weights;              ///< of these, > 0
  ReduceReport report;

  /// What integrators and static solvers run.
  ReducedSystem<Model, S> system() const {
    return {full->shared_model(), subspace, indices, weights, rest_stiffness, full->nodal_mass()};
  }
};

/// Samples poses of the subspace, fits the forces by few components that `select` chooses, and measures the error. Any
/// force model, subspace and selector will do; the model says where its nodes rest (rest_positions(), n × 3 [m]).
/// Poses with inverted components are shrunk, and there are no equilibria, unless the options say otherwise. Of the
/// options, those of the subspace and the name of the selector are not read.
/// \throws as reduce() of a Body.
template <ForceModel Model, Subspace S, typename Selector = NnSp>
Reduction<Model, S> reduce(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace,
                           const Selector& select = {}, const ReduceOptions& options = {},
                           const Progress& progress = {}) {
  static_assert(explain_subset_selector<Selector>());
  check(options);
  const Stopwatch total;
  Reduction<Model, S> result;
  Stages stage(result.report, progress);
  result.report.nodes = system->num_nodes();
  result.report.components = system->model().num_components();
  result.report.fixed_nodes = system->num_nodes() - system->numbering().num_free();
  const ObjectTraits object{.diagonal = bounding_box(system->model().rest_positions()).diagonal(),
                            .inverted = options.poses.inverted.value_or(InvertedPoses::Shrink),
                            .equilibria = options.equilibria.value_or(0)};
  const Training<Model, S> training = train(object, system, subspace, options, stage);
  WorkingComponents working = select_components(training, select, options, stage);
  result.full = std::move(system);
  result.subspace = std::move(subspace);
  result.rest_stiffness = training.rest_stiffness;
  result.indices = std::move(working.indices);
  result.weights = std::move(working.weights);
  result.report.total_seconds = total.seconds();
  result.report.peak_memory = peak_resident_memory();
  return result;
}

}  // namespace supple
