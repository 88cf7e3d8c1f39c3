#pragma once
/// \file Main job for force models, subspaces and selectors of one's own types.

#include <core/median.hpp>
#include <core/peak_memory.hpp>
#include <reduction/model/reduced_forces.hpp>
#include <reduction/pipeline/training.hpp>
#include <reduction/training/indicator_fitting.hpp>
#include <sparse/selection/explain_subset_selector.hpp>
#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selectors/nn_sp.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <algorithm>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

namespace supple {

/// Few components of an object, in a subspace, that stand for all.
template <ForceModel Model, Subspace S>
struct Reduction : ReducedForces<std::shared_ptr<const S>> {
  std::shared_ptr<const FullSystem<Model>> full;
  ReduceReport report;

  /// What integrators and static solvers run.
  ReducedSystem<Model, S> system() const {
    return {full->shared_model(), this->subspace,       this->indices,
            this->weights,        this->rest_stiffness, full->nodal_mass()};
  }
};

/// K̃(0) of components against the exact stiffness.
template <ForceModel Model, Subspace S>
StiffnessRange rest_stiffness_of(const Training<Model, S>& training, const WorkingComponents& working) {
  return stiffness_range(training.object.stiffness_at_rest(working), training.object.modes);
}
/// Whether components leave a direction weak; never said of forces without a symmetric tangent, whose directions have no
/// stiffness of their own.
template <ForceModel Model, Subspace S>
bool is_weak(const Training<Model, S>& training, const WorkingComponents& working) {
  return has_symmetric_tangent<Model>() && rest_stiffness_of(training, working).is_weak();
}

/// The stage of selection, by select(problem, request): at most as many components as the options say. Where they leave the
/// number open, there are as many as leave no direction weak, as far as that takes no more than eight for each dimension.
template <ForceModel Model, Subspace S, typename Selector>
class ComponentSelection {
 public:
  ComponentSelection(const Training<Model, S>& training, const Selector& select, const ReduceOptions& options)
      : training_(training), select_(select), options_(options) {}

  SelectedComponents operator()(const Progress& progress) const {
    return with_problem([&](const auto& problem) -> SelectedComponents {
      const Index d = training_.object.subspace->dim();
      SelectionRequest request = request_for(
          options_.points > 0 ? options_.points : (training_.object.traits.thin ? 8 * d : 4 * d) / 3, progress);
      request.target_error = options_.target_error;
      const bool to_error = options_.target_error > 0;
      Selection selection = to_error ? smallest_selection(select_, problem, request) : select_(problem, request);
      const bool is_open = to_error ? reaches_error(selection) : options_.points == 0;
      if (!is_open || !leaves_weak(selection)) return {std::move(selection)};
      SelectedComponents result{{}, selection.size()};
      request = request_for(options_.points > 0 ? options_.points : most(), progress);
      request.warm_start = std::move(selection);
      const auto enough = [&](const Selection& c) { return reaches_error(c) && !leaves_weak(c); };
      result.selection = smallest_selection(select_, problem, request, enough);
      if (enough(result.selection)) {  // the selector, which was given a size, knows nothing of that
        result.selection.report.status = Status::Converged;
        result.selection.report.stop_reason = "as few as leave no direction weak";
      }
      return result;
    });
  }

  /// The same from the options' checkpoint, for selectors that have a name; others select afresh.
  SelectedComponents kept(const Progress& progress) const {
    if constexpr (std::same_as<Selector, AnySelector>)
      return options_.checkpoint.keep(
          "selection", [&](Digest& digest) { add_inputs(digest); }, [&] { return (*this)(progress); });
    else
      return (*this)(progress);
  }

  /// A number of points, to a tenth of it, that leaves no direction weak where `selection` does; 0: not even most() do.
  Index points_that_hold(const Selection& selection, const Progress& progress) const {
    if (options_.points >= most()) return 0;
    return with_problem([&](const auto& problem) -> Index {
      // each from the start, as who asks for so many will have it
      const auto hold = [&](Index points) { return !leaves_weak(select_(problem, request_for(points, progress))); };
      Index few = std::max(selection.size(), static_cast<Index>(options_.must_keep.size()));
      Index enough = std::min(most(), 2 * few);
      for (; !hold(enough); enough = std::min(most(), 2 * few)) {
        if (enough == most()) return 0;
        few = enough;
      }
      while (enough - few > std::max<Index>(1, enough / 10)) {
        const Index middle = (few + enough) / 2;
        (hold(middle) ? enough : few) = middle;
      }
      return enough;
    });
  }

  /// The most components that are tried: of those that may be chosen eight for each dimension, if more are not asked for.
  Index most() const {
    const auto kept = static_cast<Index>(options_.must_keep.size());
    std::vector<Index> some;
    std::ranges::set_union(options_.candidates, options_.must_keep, std::back_inserter(some));
    const Index eligible = options_.candidates.empty() ? training_.fitting.cols() : static_cast<Index>(some.size());
    return std::min(eligible, std::max({kept, options_.points, 8 * training_.object.subspace->dim()}));
  }

 private:
  SelectionRequest request_for(Index points, const Progress& progress) const {
    SelectionRequest request(std::min<Index>(points, training_.fitting.cols()));
    request.candidates = options_.candidates;
    request.must_keep = options_.must_keep;
    request.warm_start = options_.warm_start;
    request.progress = progress;
    if (!training_.held_out.empty())
      request.validate = [this](const std::vector<Index>& indices, VectorIn weights) {
        return training_.held_out.front().second.error(indices, weights);
      };
    return request;
  }
  void add_inputs(Digest& digest) const {
    digest.add(options_.selector).add(options_.seed).add(options_.points).add(options_.target_error);
    digest.add(options_.candidates).add(options_.must_keep).add(options_.held_out_poses);
    digest.add(options_.warm_start.indices).add(options_.warm_start.weights);
    with_problem([&](const auto& problem) {
      digest.add(problem.cols()).add(problem.rhs());
      Vector column(problem.rows());
      constexpr Index samples = 16;
      for (Index k = 0; k < samples; ++k) {
        problem.column(k * (problem.cols() - 1) / samples, column);
        digest.add(column);
      }
    });
  }
  bool reaches_error(const Selection& selection) const {
    return options_.target_error == 0 || selection.report.training_error <= options_.target_error;
  }
  bool leaves_weak(const Selection& selection) const {
    return is_weak(training_, working_components(selection, options_.selector));
  }
  template <typename Visitor>
  auto with_problem(const Visitor& visit) const {
    return training_.with_problem([&](const auto& problem) {
      if constexpr (std::same_as<Selector, AnySelector>)
        return visit(AnyProblem(problem));
      else
        return visit(problem);
    });
  }

  const Training<Model, S>& training_;
  const Selector& select_;
  const ReduceOptions& options_;
};

/// The stage of checks: what a selection is worth.
struct SelectionChecks {
  double training_error = 0, equilibrium_training_error = 0;
  std::vector<std::pair<double, double>> held_out = {};  ///< share of the amplitude and error
  Vector fitted_eigenvalues = {}, exact_eigenvalues = {};
  StiffnessRange rest_stiffness = {};
};
template <ForceModel Model, Subspace S>
SelectionChecks check(const Training<Model, S>& training, const WorkingComponents& working) {
  SelectionChecks checks;
  checks.training_error = training.error(working);
  checks.equilibrium_training_error = training.equilibria
                                          ? training.equilibria_of(working).error(working.indices, working.weights)
                                          : std::numeric_limits<double>::quiet_NaN();
  for (const auto& [part, problem] : training.held_out)
    checks.held_out.emplace_back(part, problem.error(working.indices, working.weights));
  const Matrix fitted = training.object.stiffness_at_rest(working);
  checks.exact_eigenvalues = training.object.softest_eigenvalues(training.object.rest_stiffness);
  checks.fitted_eigenvalues = training.object.softest_eigenvalues(fitted);
  checks.rest_stiffness = stiffness_range(fitted, training.object.modes);
  return checks;
}

/// The stage that compares a model with the full object, under loads it has not seen.
template <ForceModel Model, Subspace S>
EquilibriumPairs compare_with_full(const Training<Model, S>& training, const WorkingComponents& working,
                                   const ReduceOptions& options) {
  if constexpr (PotentialModel<Model> && has_symmetric_tangent<Model>()) {
    const ReducedObject<Model, S>& object = training.object;
    std::vector<double> amplitudes{0.08, 0.04};
    if (object.traits.thin)
      for (double& amplitude : amplitudes) amplitude /= 3;
    constexpr Index num_modes = 10;
    const auto relaxation = training.relaxation ? training.relaxation : relaxation_of(object);
    return compare_equilibria(
        [&](const Matrix& linear, const Matrix& reduced) {
          return relaxation->equilibria(object.rest_stiffness * linear, reduced);
        },
        object.any_system(working.indices, working.weights), object.modes,
        soft_responses(object, num_modes, options.full_loads, amplitudes, RunSeeds(options).full_loads));
  } else {
    return {};
  }
}

/// The stage that measures what a fit to all components in the subspace is worth: equilibria of a model under fresh loads
/// such as those of the training equilibria, against those of all components, which are searched from them.
template <ForceModel Model, Subspace S>
EquilibriumPairs compare_with_subspace(const Training<Model, S>& training, const WorkingComponents& working,
                                       const ReduceOptions& options) {
  if constexpr (PotentialModel<Model> && has_symmetric_tangent<Model>()) {
    const ReducedObject<Model, S>& object = training.object;
    const ReducedModes& modes = object.modes;
    const AnySystem<Matrix> system = object.any_system(working.indices, working.weights);
    const auto rigid = modes.Phi.leftCols(modes.num_zero);
    Matrix springs;
    if (modes.num_zero > 0) springs = modes.softest_stiffness() * rigid * rigid.transpose();
    constexpr Index count = 24;
    return compare_equilibria(
        [&](const Matrix& linear, const Matrix& reduced) {
          ExactEquilibria exact = exact_equilibria(
              [&](MatrixIn Q) { return reduced_forces(object.system->shared_model(), *object.subspace, Q); },
              [&](VectorIn q) { return system.stiffness(q); }, object.rest_stiffness * linear, springs, reduced);
          FullStates states;
          states.sizes = exact.Q.colwise().norm().transpose();
          states.outside = Vector::Zero(linear.cols());
          states.Q = std::move(exact.Q);
          states.residuals = std::move(exact.residuals);
          return states;
        },
        system, modes, equilibrium_loads(object, count, RunSeeds(options).fresh_equilibria, options));
  } else {
    return {};
  }
}

/// The stage that trains what estimates the error at run time, by what was measured under fresh loads; none without these,
/// where forces have not relaxed, or where too few components are left.
template <ForceModel Model, Subspace S>
std::optional<ErrorIndicator> indicator_of(const Training<Model, S>& training, const WorkingComponents& working,
                                           const EquilibriumPairs& full, const ReduceOptions& options) {
  if constexpr (PotentialModel<Model> && has_symmetric_tangent<Model>()) {
    if (!training.relaxation || full.reduced.cols() == 0) return std::nullopt;
    const ReducedObject<Model, S>& object = training.object;
    const auto size = static_cast<Index>(working.indices.size()) / 2 + 1;
    auto indicator = fit_indicator(*object.system, *object.subspace, *training.equilibria, training.fitting,
                                   training.relaxed, working.indices, size, RunSeeds(options).indicator);
    if (!indicator) return indicator;
    const ErrorEstimator estimate(object.system->shared_model(), *indicator, object.modes);
    const auto system = object.reduced_system(working.indices, working.weights);
    const Vector measured = full.total();
    std::vector<double> ratios;
    for (Index t = 0; t < measured.size(); ++t) {
      const auto q = full.reduced.col(t);
      const double estimated = estimate(q, system.force(q)).total() / q.norm();
      if (estimated > 0) ratios.push_back(measured[t] / estimated);
    }
    if (ratios.empty()) return std::nullopt;
    indicator->scale = median(std::move(ratios));
    return indicator;
  } else {
    return std::nullopt;
  }
}

/// All stages from the selection to checks.
template <ForceModel Model, Subspace S, typename Selector>
Reduction<Model, S> reduce(const Training<Model, S>& training, const Selector& select, const ReduceOptions& options,
                           StageClock& stage) {
  const ComponentSelection<Model, S, Selector> select_components(training, select, options);
  const SelectedComponents selected =
      stage("selection", [&](auto) { return select_components.kept(stage.progress()); });
  const Selection& selection = selected.selection;
  WorkingComponents working = working_components(selection, options.selector);
  stage("refit", [&](auto) {
    WorkingComponents refit = training.refitted(working);
    const bool misses = options.target_error > 0 && training.error(refit) > options.target_error;
    const bool weakens = is_weak(training, refit) && !is_weak(training, working);
    if (!misses && !weakens) working = std::move(refit);
  });
  const SelectionChecks checks = stage("checks", [&](auto) { return check(training, working); });

  ReduceReport report = report_of(training);
  report.points_too_weak = selected.too_weak;
  if (is_weak(training, working)) {
    const std::string what =
        weakness(checks.rest_stiffness, static_cast<Index>(working.indices.size()), training.object.traits);
    if (checks.rest_stiffness.is_singular() && options.singular == SingularModels::Refuse) {
      const Index enough = stage("points that hold",
                                 [&](auto) { return select_components.points_that_hold(selection, stage.progress()); });
      throw SolverError(what + ": " +
                        (enough > 0 ? "it takes " + std::to_string(enough) + " points"
                                    : "not even " + std::to_string(select_components.most()) + " points mend that"));
    }
    report.notes.push_back(what);
  }
  EquilibriumPairs pairs;
  if (options.full_loads > 0) {
    pairs = stage("full object", [&](auto) { return compare_with_full(training, working, options); });
    report.full_error = full_error_of(pairs);
  }
  const FullError& full = report.full_error;
  FullError fresh = full;  // where forces relaxed, the full object is what they were fitted to
  if (!training.relaxation)
    fresh = stage("fresh equilibria",
                  [&](auto) { return full_error_of(compare_with_subspace(training, working, options)); });
  std::optional<ErrorIndicator> indicator;
  if (training.relaxation && options.full_loads > 0)
    indicator = stage("indicator", [&](auto) { return indicator_of(training, working, pairs, options); });
  report.equilibrium_error = fresh.inside;
  report.equilibrium_loads = fresh.loads;
  report.equilibrium_unfinished = fresh.unfinished;
  report.rest_stiffness = checks.rest_stiffness;
  if (!checks.rest_stiffness.is_sound() && !training.relaxation)
    report.points_for_sound_stiffness = std::min(
        training.fitting.cols(), checks.rest_stiffness.points_for_sound(static_cast<Index>(working.indices.size())));
  if (full.unfinished > 0)
    report.notes.push_back("equilibria of the full object under " + std::to_string(full.unfinished) + " of " +
                           std::to_string(options.full_loads) +
                           " fresh loads were not found; its error is that of the others");
  report.points = static_cast<Index>(working.indices.size());
  report.selection = selection.report;
  report.training_error = checks.training_error;
  report.equilibrium_training_error = checks.equilibrium_training_error;
  report.held_out = checks.held_out;
  report.held_out_error =
      checks.held_out.empty() ? std::numeric_limits<double>::quiet_NaN() : checks.held_out.front().second;
  report.exact_eigenvalues = checks.exact_eigenvalues;
  report.fitted_eigenvalues = checks.fitted_eigenvalues;
  report.seconds = stage.seconds();
  report.total_seconds = stage.total_seconds();
  report.peak_memory = peak_resident_memory();
  const ReducedObject<Model, S>& object = training.object;
  return {{object.subspace, object.rest_stiffness, std::move(working.indices), std::move(working.weights),
           std::move(indicator)},
          object.system,
          std::move(report)};
}

/// All stages from training to checks.
template <ForceModel Model, Subspace S, typename Selector>
Reduction<Model, S> reduce(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace,
                           const ObjectTraits& traits, const Selector& select, const ReduceOptions& options,
                           StageClock& stage) {
  return reduce(train(std::move(system), std::move(subspace), traits, options, stage), select, options, stage);
}

/// Samples poses of the subspace, fits the forces by few components that `select` chooses, and measures the error. Any
/// force model, subspace and selector will do; the model says where its nodes rest (rest_positions(), n × 3 [m]).
/// Poses with inverted components are shrunk, and there are no equilibria, unless the options say otherwise. Of the
/// options, those of the subspace are not read, and the name of the selector is for messages only.
/// \throws as reduce() of a Body.
template <ForceModel Model, Subspace S, typename Selector = NnSp>
Reduction<Model, S> reduce(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace,
                           const Selector& select = {}, const ReduceOptions& options = {},
                           const Progress& progress = {}) {
  static_assert(explain_subset_selector<Selector>());
  check(options);
  StageClock stage(progress);
  const ObjectTraits traits{.diagonal = bounding_box(system->model().rest_positions()).diagonal(),
                            .inverted = options.poses.inverted.value_or(InvertedPoses::Shrink),
                            .equilibria = options.equilibria.value_or(0)};
  return reduce(std::move(system), std::move(subspace), traits, select, options, stage);
}

}  // namespace supple
