#pragma once
/// \file The stages that reduce() and SelectionStudy share: from a body to the fitting problems of its forces.

#include <core/stopwatch.hpp>
#include <physics/body/force_models.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/training/equilibrium_fitting.hpp>
#include <sparse/nnls/working_set.hpp>
#include <sparse/problem/stacked_problem.hpp>
#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selectors/greedy_cubature.hpp>

#include <algorithm>
#include <limits>
#include <memory>
#include <optional>

namespace supple {

/// Runs named stages, tells of them and notes their times.
class Stages {
 public:
  Stages(ReduceReport& report, Progress progress) : report_(report), progress_(std::move(progress)) {}

  template <typename Work>
  decltype(auto) operator()(const std::string& name, Work&& work) {
    struct Finish {
      Stages& stages;
      const std::string& name;
      Stopwatch watch;
      ~Finish() { stages.report_.seconds.emplace_back(name, watch.seconds()); }
    } finish{*this, name, {}};
    tell(progress_, name, 0);
    return work([this, &name](double share) { tell(progress_, name, share); });
  }

  ReduceReport& report() { return report_; }
  const Progress& progress() const { return progress_; }

 private:
  ReduceReport& report_;
  Progress progress_;
};

/// Components that do the work of all, in ascending order.
struct WorkingComponents {
  std::vector<Index> indices;
  Vector weights;  ///< > 0
};
/// Those of a selection with a positive weight: others, that a selector had to keep, do no work.
/// \throws SolverError if a weight is negative or none is positive. \param selector  its name, for the message.
WorkingComponents working_components(const Selection& selection, const std::string& selector);

/// Those with a positive weight, in the order given.
WorkingComponents with_positive_weights(std::span<const Index> indices, VectorIn weights);

/// What a selection is made for, and what it is judged by.
template <ForceModel F, Subspace S>
struct Training {
  using Model = F;
  using Fitting = ForceFitting<Model, S>;

  std::shared_ptr<const FullSystem<Model>> system;
  std::shared_ptr<const S> subspace;
  Matrix rest_stiffness;  ///< UᵀK(0)U, d × d
  ReducedModes modes;
  Fitting fitting;  ///< on the training poses
  std::optional<EquilibriumFitting<Model, S>> equilibria = {};
  std::vector<std::pair<double, Fitting>> held_out;  ///< on fresh poses at these shares of the largest amplitude

  /// The reduced system of a selection.
  ReducedSystem<Model, S> reduced_system(std::span<const Index> indices, VectorIn weights) const {
    return {system->shared_model(), subspace, indices, weights, rest_stiffness, system->nodal_mass()};
  }
  /// The equilibria by its own tangents; there must be some.
  EquilibriumFitting<Model, S> equilibria_of(const WorkingComponents& working) const {
    return equilibria->with_tangents_of(reduced_system(working.indices, working.weights));
  }
  /// Calls visit(problem) with what selectors solve: the training poses, above the equilibria if there are any.
  template <typename Visitor>
  decltype(auto) with_problem(const Visitor& visit) const {
    if (equilibria) return visit(StackedProblem(fitting, *equilibria));
    return visit(fitting);
  }
  /// Of everything that selectors solve, relative.
  double error(const WorkingComponents& working) const {
    return with_problem([&](const auto& problem) {
      const Vector& b = problem.rhs();
      return (problem.columns(working.indices).times(working.weights) - b).norm() / b.norm();
    });
  }
  /// Weights fitted once more, with the tangents of the object that the components make in place of those of a rough
  /// selection; as they are where that does not bring its equilibria nearer, or there are none.
  WorkingComponents refitted(const WorkingComponents& working) const;
  /// Softest flexible eigenvalues of a reduced stiffness at rest, at most `count` [1/s²].
  Vector softest_eigenvalues(const Matrix& stiffness, Index count = 5) const;
};

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count);

template <ForceModel Model, Subspace S>
Vector Training<Model, S>::softest_eigenvalues(const Matrix& stiffness, Index count) const {
  return supple::softest_eigenvalues(stiffness, modes.num_zero, count);
}

template <ForceModel Model, Subspace S>
WorkingComponents Training<Model, S>::refitted(const WorkingComponents& working) const {
  if (!equilibria) return working;
  const auto own = equilibria_of(working);
  const StackedProblem problem(fitting, own);
  WorkingSet chosen(problem);
  chosen.append(problem.columns(working.indices));
  const WorkingComponents refit = with_positive_weights(working.indices, chosen.fit());
  if (refit.indices.empty()) return working;
  const bool nearer =
      equilibria_of(refit).error(refit.indices, refit.weights) < own.error(working.indices, working.weights);
  return nearer ? refit : working;
}

/// What training needs to know of an object beside its system.
struct ObjectTraits {
  double diagonal;  ///< the length that amplitudes are shares of [m]
  InvertedPoses inverted;
  Index equilibria = 0;
  bool thin = false;  ///< buckles under large loads: equilibria have a third of them
  std::string component_name = "components";
};

/// Poses in equilibrium of a rough selection. \throws std::invalid_argument for forces without a potential.
template <ForceModel Model, Subspace S>
void add_equilibria(const ObjectTraits& object, PoseOptions poses, const ReduceOptions& options,
                    Training<Model, S>& training) {
  if constexpr (PotentialModel<Model> && has_symmetric_tangent<Model>()) {
    const auto& model = training.system->shared_model();
    const Index size = std::min(training.fitting.cols(), 4 * training.subspace->dim());
    const WorkingComponents working =
        working_components(BatchedGreedy{.seed = options.seed}(training.fitting, size), "batched-greedy");
    const auto system = training.reduced_system(working.indices, working.weights);
    const double largest = poses.largest_amplitude();
    poses.count = object.equilibria;
    poses.amplitudes = {3 * largest, largest, 0.3 * largest};
    if (object.thin)
      for (double& amplitude : poses.amplitudes) amplitude /= 3;
    poses.seed += 15485863;
    poses.inverted = InvertedPoses::Keep;  // of the linear responses, which nothing is trained on
    const Matrix linear = sample_poses(model, *training.subspace, training.modes, training.system->nodal_mass().sum(),
                                       object.diagonal, poses)
                              .Q;
    const Matrix relaxed =
        treat_inverted(model, *training.subspace, equilibrium_poses(system, training.modes, linear), object.inverted).Q;
    const double share = static_cast<double>(training.fitting.num_poses()) / static_cast<double>(object.equilibria);
    training.equilibria.emplace(
        model, training.subspace, relaxed, [&](VectorIn q) { return system.stiffness(q); },
        training.modes.softest_stiffness(), 20 + training.modes.num_zero, std::sqrt(share));
  } else {
    require(false, "equilibria need forces with a potential");
  }
}

template <ForceModel Model, Subspace S>
Training<Model, S> train(const ObjectTraits& object, std::shared_ptr<const FullSystem<Model>> system,
                         std::shared_ptr<const S> subspace, const ReduceOptions& options, Stages& stage) {
  using Fitting = ForceFitting<Model, S>;
  ReduceReport& report = stage.report();
  report.dimension = subspace->dim();
  report.omega = subspace->report.omega;
  report.rigid_modes = subspace->report.rigid_modes;
  report.dropped = subspace->report.dropped;
  report.notes.insert(report.notes.end(), subspace->report.notes.begin(), subspace->report.notes.end());

  const double total_mass = system->nodal_mass().sum();
  Matrix rest_stiffness;
  ReducedModes modes = stage("reduced stiffness", [&](auto) {
    rest_stiffness = project_stiffness(*subspace, *system);
    return reduced_modes(rest_stiffness, subspace->report.known_zero_modes());
  });
  PoseOptions pose_options = options.poses;
  pose_options.seed += 1000003 * options.seed;  // the seed of a run moves all random choices
  pose_options.inverted = object.inverted;
  const auto sample = [&](const PoseOptions& some) {
    return sample_poses(system->shared_model(), *subspace, modes, total_mass, object.diagonal, some);
  };
  const Matrix Q = stage("training poses", [&](auto) -> Matrix {
    const bool given = options.given_poses.size() > 0;
    TrainingPoses poses = given
                              ? treat_inverted(system->shared_model(), *subspace,
                                               poses_in_subspace(*subspace, system->nodal_mass(), options.given_poses),
                                               *pose_options.inverted)
                              : sample(pose_options);
    report.inverted_poses = poses.inverted;
    report.redrawn_poses = poses.redrawn;
    report.shrunk_poses = poses.shrunk;
    if (poses.inverted > 0)
      report.notes.push_back(std::to_string(poses.inverted) + " of " + std::to_string(poses.Q.cols()) +
                             " training poses had inverted " + object.component_name + " (" +
                             std::to_string(poses.inverted_components) + " in all); " + std::to_string(poses.redrawn) +
                             " draws were redrawn, " + std::to_string(poses.shrunk) + " poses shrunk");
    return std::move(poses.Q);
  });
  report.poses = Q.cols();
  const Matrix metric = force_metric(options.norm, modes);
  Fitting fitting =
      stage("training forces", [&](auto share) { return Fitting(system->shared_model(), subspace, metric, Q, share); });
  std::vector<std::pair<double, Fitting>> held_out;
  if (options.held_out_poses > 0)
    stage("held-out forces", [&](auto share) {
      const double largest = pose_options.largest_amplitude();
      for (const double part : {1.0, 0.3, 0.1}) {
        PoseOptions some = pose_options;
        some.count = options.held_out_poses;
        some.amplitudes = {part * largest};
        some.seed = pose_options.seed + 7919;
        held_out.emplace_back(part, Fitting(system->shared_model(), subspace, metric, sample(some).Q));
        share(static_cast<double>(held_out.size()) / 3);
      }
    });
  Training<Model, S> training{.system = std::move(system),
                              .subspace = std::move(subspace),
                              .rest_stiffness = std::move(rest_stiffness),
                              .modes = std::move(modes),
                              .fitting = std::move(fitting),
                              .held_out = std::move(held_out)};
  if (object.equilibria > 0)
    stage("equilibria", [&](auto) { add_equilibria(object, pose_options, options, training); });
  return training;
}

/// Calls visit(training) with the Training of the body's force model and the subspace that the options name.
template <typename Visitor>
void with_training(const Body& body, const ReduceOptions& options, Stages& stage, Visitor&& visit) {
  ReduceReport& report = stage.report();
  report.nodes = num_nodes(body);
  report.fixed_nodes = static_cast<Index>(fixed_nodes(body).size());
  with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    report.components = model->num_components();
    const auto system = stage("full system", [&](auto) {
      return std::make_shared<const FullSystem<Model>>(model, nodal_mass(body), fixed_nodes(body));
    });
    with_subspace(*system, options.subspace_choice(), stage.progress(), stage,
                  [&]<typename S>(std::shared_ptr<const S> subspace) {
                    const ObjectTraits object{.diagonal = bounding_box(node_positions(body)).diagonal(),
                                              .inverted = inverted_rule(law(body), options.poses.inverted),
                                              .equilibria = num_equilibria(body, options),
                                              .thin = std::holds_alternative<Shell>(body),
                                              .component_name = std::string(component_name(body))};
                    visit(train<Model, S>(object, system, std::move(subspace), options, stage));
                  });
  });
}

/// Selects by select(problem, request), and measures what comes out; the report gets errors and spectra.
template <ForceModel Model, Subspace S, typename Selector>
WorkingComponents select_components(const Training<Model, S>& training, const Selector& select,
                                    const ReduceOptions& options, Stages& stage) {
  ReduceReport& report = stage.report();
  SelectionRequest request(std::min<Index>(options.points, training.fitting.cols()));
  request.target_error = options.target_error;
  request.candidates = options.candidates;
  request.must_keep = options.must_keep;
  request.warm_start = options.warm_start;
  request.progress = stage.progress();
  if (!training.held_out.empty())
    request.validate = [&](const std::vector<Index>& indices, VectorIn weights) {
      return training.held_out.front().second.error(indices, weights);
    };
  Selection selection = stage("selection", [&](auto) {
    return training.with_problem([&](const auto& problem) {
      return options.target_error > 0 ? smallest_selection(select, problem, request) : select(problem, request);
    });
  });
  WorkingComponents working = working_components(selection, options.selector);
  stage("refit", [&](auto) {
    WorkingComponents refit = training.refitted(working);
    if (options.target_error == 0 || training.error(refit) <= options.target_error) working = std::move(refit);
  });
  report.points = static_cast<Index>(working.indices.size());
  report.selection = std::move(selection.report);
  stage("checks", [&](auto) {
    report.training_error = training.error(working);
    report.equilibrium_error = training.equilibria
                                   ? training.equilibria_of(working).error(working.indices, working.weights)
                                   : std::numeric_limits<double>::quiet_NaN();
    report.held_out_error = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [part, problem] : training.held_out)
      report.held_out.emplace_back(part, problem.error(working.indices, working.weights));
    if (!report.held_out.empty()) report.held_out_error = report.held_out.front().second;
    const auto reduced = training.reduced_system(working.indices, working.weights);
    report.exact_eigenvalues = training.softest_eigenvalues(training.rest_stiffness);
    report.fitted_eigenvalues = training.softest_eigenvalues(reduced.stiffness(Vector::Zero(reduced.dim())));
  });
  return working;
}

/// \throws std::invalid_argument for options out of range.
void check(const ReduceOptions& options);

}  // namespace supple
