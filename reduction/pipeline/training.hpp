#pragma once
/// \file Stages of training, from an object in a subspace to the fitting problems of its forces.

#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/system/any_system.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/pipeline/kept_training.hpp>
#include <reduction/pipeline/object_traits.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <reduction/pipeline/stage_clock.hpp>
#include <reduction/system/reduced_system.hpp>
#include <reduction/system/stiffness_range.hpp>
#include <reduction/training/equilibrium_fitting.hpp>
#include <reduction/training/exact_equilibria.hpp>
#include <reduction/training/force_fitting.hpp>
#include <reduction/training/relaxation.hpp>
#include <reduction/training/rest_energies.hpp>
#include <reduction/training/training_poses.hpp>
#include <sparse/nnls/working_set.hpp>
#include <sparse/problem/any_problem.hpp>
#include <sparse/problem/stacked_problem.hpp>
#include <sparse/selectors/greedy_cubature.hpp>

#include <memory>
#include <optional>

namespace supple {

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

/// What is wrong with components that leave a direction weak, in words.
std::string weakness(const StiffnessRange& range, Index points, const ObjectTraits& traits);

/// The seeds of what is drawn at random in a run, apart from one another. The seed of the run moves all of them.
struct RunSeeds {
  std::uint64_t poses, held_out, equilibria, full_loads, fresh_equilibria, indicator, selection;

  explicit RunSeeds(const ReduceOptions& options)
      : poses(options.poses.seed + 1000003 * options.seed),
        held_out(poses + 7919),
        equilibria(poses + 15485863),
        full_loads(poses + 32452843),
        fresh_equilibria(poses + 49979687),
        indicator(poses + 67867967),
        selection(options.seed) {}
};

/// An object in a subspace, and what that does at rest.
template <ForceModel F, Subspace S>
struct ReducedObject {
  std::shared_ptr<const FullSystem<F>> system;
  std::shared_ptr<const S> subspace;
  ObjectTraits traits;
  Matrix rest_stiffness = {};  ///< UᵀK(0)U, d × d
  ReducedModes modes = {};     ///< of it

  /// The reduced system of a selection.
  ReducedSystem<F, S> reduced_system(std::span<const Index> indices, VectorIn weights) const {
    return {system->shared_model(), subspace, indices, weights, rest_stiffness, system->nodal_mass()};
  }
  /// The same as a value, for what need not be compiled for each type of system.
  AnySystem<Matrix> any_system(std::span<const Index> indices, VectorIn weights) const {
    return AnySystem<Matrix>(std::make_shared<const ReducedSystem<F, S>>(reduced_system(indices, weights)));
  }
  /// K̃(0) of a selection, d × d [1/s²].
  Matrix stiffness_at_rest(const WorkingComponents& working) const {
    return reduced_system(working.indices, working.weights).stiffness(Vector::Zero(subspace->dim()));
  }
  /// Softest flexible eigenvalues of a reduced stiffness at rest, at most `count` [1/s²].
  Vector softest_eigenvalues(const Matrix& stiffness, Index count = 5) const;
};

/// What a selection is made for, and what it is judged by: the object and what came out of the stages of train().
template <ForceModel F, Subspace S>
struct Training {
  using Model = F;
  using Fitting = ForceFitting<Model, S>;
  using Equilibria = EquilibriumFitting<Model, S>;

  ReducedObject<F, S> object;
  TrainingPoses poses;
  Fitting fitting;                                   ///< on the training poses
  std::vector<std::pair<double, Fitting>> held_out;  ///< on fresh poses at these shares of the largest amplitude
  std::optional<Equilibria> equilibria = {};
  std::shared_ptr<const Relaxation> relaxation = {};  ///< if forces relaxed
  FullStates relaxed = {};                            ///< then of the equilibria

  /// The equilibria by its own tangents; there must be some.
  Equilibria equilibria_of(const WorkingComponents& working) const {
    return equilibria->with_tangents_of(object.reduced_system(working.indices, working.weights));
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
  /// selection where that brings its equilibria nearer, and with its frequencies at rest where forces relaxed in a subspace
  /// without the structure W ⊗ I; as they are without equilibria.
  WorkingComponents refitted(const WorkingComponents& working) const;

 private:
  /// Weights of the columns whose Gram matrix and Aᵀb these are, fitted to the frequencies at rest, too, for a motion that is
  /// late is wrong however near its equilibria are: with rows ψₖᵀ K̃(0) ψₖ / ωₖ² = 1 for the modes that the subspace was
  /// made from, each of which weighs as much as all poses at rest. ψₖ are eigenvectors of K̃(0) itself, whose errors couple
  /// soft modes to stiff ones.
  Vector with_frequencies(std::span<const Index> indices, const Matrix& gram, const Vector& atb, Vector w) const;
};

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count);

template <ForceModel Model, Subspace S>
Vector ReducedObject<Model, S>::softest_eigenvalues(const Matrix& stiffness, Index count) const {
  return supple::softest_eigenvalues(stiffness, modes.num_zero, count);
}

template <ForceModel Model, Subspace S>
WorkingComponents Training<Model, S>::refitted(const WorkingComponents& working) const {
  if (!equilibria) return working;
  const auto own = equilibria_of(working);
  const auto refit_by = [&](const Equilibria& rows, const auto& fit) {
    const StackedProblem stacked(fitting, rows);
    const AnyProblem problem(stacked);  // what fits is compiled once, not for each type of problem
    WorkingSet chosen(problem);
    chosen.append(problem.columns(working.indices));
    return with_positive_weights(working.indices, fit(chosen));
  };
  const WorkingComponents refit = refit_by(own, [](const auto& chosen) { return chosen.fit(); });
  const bool nearer = !refit.indices.empty() && equilibria_of(refit).error(refit.indices, refit.weights) <
                                                    own.error(working.indices, working.weights);
  const bool locks =
      S::block > 1;  // fields under all linear maps lock in bending still; soft frequencies make up for that
  if (!relaxation || locks) return nearer ? refit : working;
  const WorkingComponents tuned = refit_by(nearer ? own : *equilibria, [&](const auto& chosen) {
    return with_frequencies(working.indices, chosen.gram(), chosen.atb(), chosen.fit());
  });
  return tuned.indices.empty() ? working : tuned;
}

template <ForceModel Model, Subspace S>
Vector Training<Model, S>::with_frequencies(std::span<const Index> indices, const Matrix& gram, const Vector& atb,
                                            Vector w) const {
  constexpr int rounds = 4;  // eigenvectors settle
  const ReducedModes& modes = object.modes;
  const SubspaceReport& made = object.subspace->report;
  const Index first = modes.num_zero, count = std::min(made.omega.size() - made.rigid_modes, modes.Phi.cols() - first);
  if (count <= 0) return w;
  const Vector exact = modes.omega.segment(first, count).cwiseAbs2();
  const double weight = std::sqrt(static_cast<double>(fitting.num_poses()));
  for (int round = 0; round < rounds; ++round) {
    const WorkingComponents working = with_positive_weights(indices, w);
    if (working.indices.empty()) return w;
    const SymmetricEigen fitted = symmetric_eigen(object.stiffness_at_rest(working));
    const Matrix A =
        weight * exact.cwiseInverse().asDiagonal() *
        rest_energies(*object.system, *object.subspace, indices, Matrix(fitted.vectors.middleCols(first, count)));
    const Vector b = Vector::Constant(count, weight);
    w = Fnnls{}(gram + A.transpose() * A, atb + A.transpose() * b, all_positions(w.size())).w;
  }
  return w;
}

/// Random poses of an object by these options. \throws as sample_poses.
template <ForceModel Model, Subspace S>
TrainingPoses sample_poses(const ReducedObject<Model, S>& object, const PoseOptions& options) {
  return sample_poses(object.system->shared_model(), *object.subspace, object.modes, object.system->nodal_mass().sum(),
                      object.traits.diagonal, options);
}

/// The poses that the options give, or random ones.
template <ForceModel Model, Subspace S>
TrainingPoses training_poses(const ReducedObject<Model, S>& object, const PoseOptions& poses, const Matrix& given) {
  if (given.size() == 0) return sample_poses(object, poses);
  return treat_inverted(object.system->shared_model(), *object.subspace,
                        poses_in_subspace(*object.subspace, object.system->nodal_mass(), given),
                        object.traits.inverted);
}

/// Equilibria of a system beside those of a reference under the same loads, a column or an entry for each.
struct EquilibriumPairs {
  Matrix reduced;          ///< d × loads, those of the system
  Vector inside, outside;  ///< distances in the subspace and out of it, as shares of the size
  Index halved = 0;        ///< loads that were halved, for no equilibrium of the reference was found before
  Index unfinished = 0;    ///< left out, for none was found after that either

  Vector total() const { return (inside.cwiseAbs2() + outside.cwiseAbs2()).cwiseSqrt(); }
};
/// Loads under which the reference finds no equilibrium are halved, twice at most. \param linear  linear responses to the loads, d × T. \param reference  from linear responses
/// and equilibria of the system to its own.
EquilibriumPairs compare_equilibria(
    const std::function<FullStates(const Matrix& linear, const Matrix& reduced)>& reference,
    const AnySystem<Matrix>& system, const ReducedModes& modes, Matrix linear);
/// Root mean squares over the loads.
FullError full_error_of(const EquilibriumPairs& pairs);

/// Null for forces without a potential.
template <ForceModel F, Subspace S>
std::shared_ptr<const Relaxation> relaxation_of(const ReducedObject<F, S>& object) {
  if constexpr (PotentialModel<F> && has_symmetric_tangent<F>())
    return std::make_shared<const Relaxation>(object.system, object.subspace, object.modes);
  else
    return nullptr;
}

/// Linear responses to random loads along the softest flexible modes, coordinates z / ω² with normal z, each of the rms
/// displacement that is its turn. \param num_modes  at most so many. \param amplitudes  shares of the diagonal. \return d × T
template <ForceModel Model, Subspace S>
Matrix soft_responses(const ReducedObject<Model, S>& object, Index num_modes, Index count,
                      const std::vector<double>& amplitudes, std::uint64_t seed) {
  const ReducedModes& modes = object.modes;
  const Index first = modes.num_zero, soft = std::min(num_modes, modes.Phi.cols() - first);
  const double unit = object.traits.diagonal * std::sqrt(object.system->nodal_mass().sum());
  Random random(seed);
  Matrix Q(modes.Phi.rows(), count);
  for (Index t = 0; t < count; ++t) {
    Vector z(soft);
    for (Index k = 0; k < soft; ++k) z[k] = random.normal() / std::pow(modes.omega[first + k], 2);
    Q.col(t) = modes.Phi.middleCols(first, soft) * (amplitudes[t % amplitudes.size()] * unit / z.norm() * z);
  }
  return Q;
}

/// The linear responses to random loads such as those of the equilibria. \return d × count
template <ForceModel Model, Subspace S>
Matrix equilibrium_loads(const ReducedObject<Model, S>& object, Index count, std::uint64_t seed,
                         const ReduceOptions& options) {
  PoseOptions poses = options.poses;
  std::vector<double> amplitudes = options.equilibrium_amplitudes;
  if (amplitudes.empty()) {
    const double largest = poses.largest_amplitude();
    amplitudes = options.relaxed ? std::vector{0.12, 0.06, 0.03} : std::vector{3 * largest, largest, 0.3 * largest};
    if (object.traits.thin)
      for (double& amplitude : amplitudes) amplitude /= 3;
  }
  if (options.relaxed) {
    const SubspaceReport& made = object.subspace->report;
    const Index num_modes = made.omega.size() > 0 ? made.omega.size() - made.rigid_modes : object.subspace->dim();
    return soft_responses(object, num_modes, count, amplitudes, seed);
  }
  poses.count = count;
  poses.amplitudes = amplitudes;
  poses.seed = seed;
  poses.inverted = InvertedPoses::Keep;  // nothing is trained on them
  return sample_poses(object, poses).Q;
}

/// Poses in equilibrium of a rough selection. \throws std::invalid_argument for forces without a potential.
/// \param relaxation  of the object, or null: nothing relaxes. \param relaxed  where the relaxed states go.
template <ForceModel Model, Subspace S>
EquilibriumFitting<Model, S> fit_equilibria(const ReducedObject<Model, S>& object,
                                            const ForceFitting<Model, S>& fitting, const RunSeeds& seeds,
                                            const ReduceOptions& options, const Relaxation* relaxation,
                                            FullStates& relaxed) {
  if constexpr (PotentialModel<Model> && has_symmetric_tangent<Model>()) {
    const auto& model = object.system->shared_model();
    const ObjectTraits& traits = object.traits;
    const Index size = std::min(fitting.cols(), 4 * object.subspace->dim());
    const WorkingComponents working =
        working_components(BatchedGreedy{.seed = seeds.selection}(AnyProblem(fitting), size), "batched-greedy");
    const AnySystem<Matrix> rough = object.any_system(working.indices, working.weights);
    const Matrix linear = equilibrium_loads(object, traits.equilibria, seeds.equilibria, options);
    const Matrix at_rest =
        treat_inverted(model, *object.subspace, equilibrium_poses(rough, object.modes, linear), traits.inverted).Q;
    const auto inputs = [&](Digest& digest) { digest.add(object.rest_stiffness).add(at_rest).add(fitting.rhs()); };
    if (relaxation) relaxed = options.checkpoint.keep("forces", inputs, [&] { return relaxation->relaxed(at_rest); });
    const double share = static_cast<double>(fitting.num_poses()) / static_cast<double>(traits.equilibria);
    return {model,
            object.subspace,
            at_rest,
            relaxed.forces,
            [&](VectorIn q) { return rough.stiffness(q); },
            object.modes.softest_stiffness(),
            (relaxation ? 40 : 20) + object.modes.num_zero,
            options.equilibrium_weight * std::sqrt(share)};
  } else {
    throw std::invalid_argument("equilibria need forces with a potential");
  }
}

/// All stages of training, of an object in a subspace.
template <ForceModel Model, Subspace S>
Training<Model, S> train(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace,
                         ObjectTraits traits, const ReduceOptions& options, StageClock& stage) {
  using Fitting = ForceFitting<Model, S>;
  ReducedObject<Model, S> object{std::move(system), std::move(subspace), std::move(traits)};
  stage("reduced stiffness", [&](auto) {
    object.rest_stiffness = project_stiffness(*object.subspace, *object.system);
    object.modes = reduced_modes(object.rest_stiffness, object.subspace->report.known_zero_modes());
  });
  const RunSeeds seeds(options);
  PoseOptions pose_options = options.poses;
  pose_options.seed = seeds.poses;
  pose_options.inverted = object.traits.inverted;
  TrainingPoses poses =
      stage("training poses", [&](auto) { return training_poses(object, pose_options, options.given_poses); });
  const Matrix metric = force_metric(options.norm, object.modes);
  const auto fit = [&](const Matrix& Q, const auto& share) {
    return Fitting(object.system->shared_model(), object.subspace, metric, Q, share);
  };
  Fitting fitting = stage("training forces", [&](auto share) { return fit(poses.Q, share); });
  std::vector<std::pair<double, Fitting>> held_out;
  if (options.held_out_poses > 0)
    stage("held-out forces", [&](auto share) {
      PoseOptions fresh = pose_options;
      fresh.count = options.held_out_poses;
      fresh.seed = seeds.held_out;
      for (const double part : {1.0, 0.3, 0.1}) {
        fresh.amplitudes = {part * pose_options.largest_amplitude()};
        held_out.emplace_back(part, fit(sample_poses(object, fresh).Q, std::function<void(double)>()));
        share(static_cast<double>(held_out.size()) / 3);
      }
    });
  Training<Model, S> training{std::move(object), std::move(poses), std::move(fitting), std::move(held_out)};
  if (training.object.traits.equilibria > 0)
    stage("equilibria", [&](auto) {
      if (options.relaxed) training.relaxation = relaxation_of(training.object);
      training.equilibria = fit_equilibria(training.object, training.fitting, seeds, options, training.relaxation.get(),
                                           training.relaxed);
    });
  return training;
}

/// What the stages up to the training forces have to say.
template <ForceModel Model, Subspace S>
ReduceReport report_of(const Training<Model, S>& training) {
  const auto& [system, subspace, traits, rest_stiffness, modes] = training.object;
  const TrainingPoses& poses = training.poses;
  ReduceReport report;
  report.nodes = system->num_nodes();
  report.components = system->model().num_components();
  report.fixed_nodes = system->num_nodes() - system->numbering().num_free();
  report.dimension = subspace->dim();
  report.omega = subspace->report.omega;
  report.rigid_modes = subspace->report.rigid_modes;
  report.dropped = subspace->report.dropped;
  report.notes = subspace->report.notes;
  report.poses = poses.Q.cols();
  report.inverted_poses = poses.inverted;
  report.redrawn_poses = poses.redrawn;
  report.shrunk_poses = poses.shrunk;
  if (poses.inverted > 0)
    report.notes.push_back(std::to_string(poses.inverted) + " of " + std::to_string(poses.Q.cols()) +
                           " training poses had inverted " + traits.component_name + " (" +
                           std::to_string(poses.inverted_components) + " in all); " + std::to_string(poses.redrawn) +
                           " draws were redrawn, " + std::to_string(poses.shrunk) + " poses shrunk");
  return report;
}

}  // namespace supple
