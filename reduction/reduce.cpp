#include <core/stopwatch.hpp>
#include <physics/full_system.hpp>
#include <reduction/modal_basis.hpp>
#include <reduction/reduce.hpp>
#include <sparse/selector_library.hpp>
#include <sparse/smallest_selection.hpp>

#include <Eigen/Eigenvalues>

#include <sys/resource.h>

#include <algorithm>

namespace supple {

namespace {

class Stages {
 public:
  Stages(ReduceReport& report, const Progress& progress) : report_(report), progress_(progress) {}

  /// Runs `work` as a named stage and notes its time.
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

 private:
  ReduceReport& report_;
  const Progress& progress_;
};

template <Subspace S>
Matrix poses_in_subspace(const S& subspace, const Vector& nodal_mass, const Matrix& given) {
  if (given.rows() == subspace.dim()) return given;
  require_size("given_poses.rows()", given.rows(), subspace.full_dim());
  Matrix Q(subspace.dim(), given.cols());
  for (Index t = 0; t < given.cols(); ++t) {
    Vector u = given.col(t);
    for (Index v = 0; v < nodal_mass.size(); ++v) u.segment<3>(3 * v) *= nodal_mass[v];
    Q.col(t) = subspace.project(u);
  }
  return Q;
}

Vector lowest_eigenvalues(const Matrix& K, Index first, Index count) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(K, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().segment(first, std::min(count, K.rows() - first));
}

template <template <typename> class Material, Subspace S>
void fit_and_finish(const Solid& solid, const FullSystem<TetElasticity<Material>>& system,
                    std::shared_ptr<const S> subspace, const ReduceOptions& options, ReducedModel& model,
                    ReduceReport& report, Stages& stage, const Progress& progress) {
  using Model = TetElasticity<Material>;
  report.dimension = subspace->dim();
  report.omega = subspace->report.omega;
  report.rigid_modes = subspace->report.rigid_modes;
  report.dropped = subspace->report.dropped;
  report.notes.insert(report.notes.end(), subspace->report.notes.begin(), subspace->report.notes.end());

  const double total_mass = system.nodal_mass().sum(), diagonal = bounding_box(solid.mesh.nodes).diagonal();
  const ReducedModes modes = stage("reduced stiffness", [&](auto) {
    model.rest_stiffness = project_stiffness(*subspace, system);
    return reduced_modes(model.rest_stiffness, subspace->report.known_rigid_modes());
  });
  PoseOptions pose_options = options.poses;
  pose_options.seed += 1000003 * options.seed;  // the seed of a run moves all random choices
  const auto sample = [&](const PoseOptions& some) {
    return sample_poses(system.shared_model(), *subspace, modes, total_mass, diagonal, some);
  };
  const Matrix Q = stage("training poses", [&](auto) -> Matrix {
    if (options.given_poses.size() > 0)
      return poses_in_subspace(*subspace, system.nodal_mass(), options.given_poses);
    TrainingPoses poses = sample(pose_options);
    report.inverted_poses = poses.inverted;
    report.redrawn_poses = poses.redrawn;
    report.shrunk_poses = poses.shrunk;
    if (poses.inverted > 0)
      report.notes.push_back(std::to_string(poses.inverted) + " of " + std::to_string(pose_options.count) +
                             " training poses had inverted tets (" +
                             std::to_string(poses.inverted_components) + " in all); " +
                             std::to_string(poses.redrawn) + " draws were redrawn, " +
                             std::to_string(poses.shrunk) + " poses shrunk");
    return std::move(poses.Q);
  });
  report.poses = Q.cols();
  const Matrix metric = force_metric(options.norm, modes);
  using Fitting = ForceFitting<Model, S>;
  const Fitting fitting = stage("training forces", [&](auto share) {
    return Fitting(system.shared_model(), subspace, metric, Q, share);
  });

  std::vector<std::pair<double, Fitting>> held_out;
  if (options.held_out_poses > 0)
    stage("held-out forces", [&](auto share) {
      const double largest =
          *std::max_element(pose_options.amplitudes.begin(), pose_options.amplitudes.end());
      for (const double part : {1.0, 0.3, 0.1}) {
        PoseOptions some = pose_options;
        some.count = options.held_out_poses;
        some.amplitudes = {part * largest};
        some.seed = pose_options.seed + 7919;
        held_out.emplace_back(part, Fitting(system.shared_model(), subspace, metric, sample(some).Q));
        share(static_cast<double>(held_out.size()) / 3);
      }
    });

  Selection selection = stage("selection", [&](auto) {
    SelectionRequest request(std::min<Index>(options.points, fitting.cols()));
    request.target_error = options.target_error;
    request.progress = progress;
    if (!held_out.empty())
      request.validate = [&](const std::vector<Index>& indices, VectorIn weights) {
        return held_out.front().second.error(indices, weights);
      };
    const auto select = [&](const AnyProblem& problem, const SelectionRequest& some) {
      return select_by_name(options.selector, problem, some, options.seed);
    };
    return options.target_error > 0 ? smallest_selection(select, AnyProblem(fitting), request)
                                    : select(AnyProblem(fitting), request);
  });
  // components that a selector had to keep at weight zero do no work
  for (Index k = 0; k < selection.size(); ++k)
    if (selection.weights[k] > 0) {
      model.indices.push_back(selection.indices[k]);
      model.weights.conservativeResize(static_cast<Index>(model.indices.size()));
      model.weights[model.weights.size() - 1] = selection.weights[k];
    }
  if (model.indices.empty()) throw SolverError("the selector found no component with a positive weight");
  report.points = static_cast<Index>(model.indices.size());
  report.selection = std::move(selection.report);
  report.training_error = report.selection.training_error;

  stage("checks", [&](auto) {
    report.held_out_error = std::numeric_limits<double>::quiet_NaN();
    for (const auto& [part, problem] : held_out)
      report.held_out.emplace_back(part, problem.error(model.indices, model.weights));
    if (!report.held_out.empty()) report.held_out_error = report.held_out.front().second;
    const ReducedSystem<Model, S> reduced(system.shared_model(), subspace, model.indices, model.weights,
                                          model.rest_stiffness, system.nodal_mass());
    report.exact_eigenvalues = lowest_eigenvalues(model.rest_stiffness, modes.num_zero, 5);
    report.fitted_eigenvalues =
        lowest_eigenvalues(reduced.stiffness(Vector::Zero(reduced.dim())), modes.num_zero, 5);
  });
  model.subspace = subspace;
}

}  // namespace

ReduceOptions ReduceOptions::paper() {
  ReduceOptions options;
  options.poses.count = 1000;
  options.poses.omega_exponent = 1;
  options.poses.amplitudes = {0.07};
  options.norm = ForceNorm::Mass;
  options.selector = "nn-htp";
  return options;
}

ReducedModel reduce(const Solid& solid, const ReduceOptions& options, ReduceReport* report_out,
                    const Progress& progress) {
  require(options.points >= 1,
          "number of points is " + std::to_string(options.points) + ", expected at least 1");
  require(options.target_error >= 0, "target error is negative, expected 0 or more");
  require(options.held_out_poses >= 0, "number of held-out poses is negative, expected 0 or more");
  require(options.subspace == "extended" || options.subspace == "modal",
          "subspace '" + options.subspace + "' is not known, expected extended or modal");
  const auto& selectors = known_selectors();
  require(std::find(selectors.begin(), selectors.end(), options.selector) != selectors.end(),
          "selector '" + options.selector + "' is not known, see known_selectors()");
  const Stopwatch total;
  ReduceReport local, &report = report_out ? *report_out : local;
  report = {};
  Stages stage(report, progress);
  ReducedModel model;
  model.solid = solid;
  report.nodes = solid.mesh.num_nodes();
  report.tets = solid.mesh.num_tets();
  report.fixed_nodes = static_cast<Index>(solid.fixed_nodes.size());

  with_law(solid.law, [&]<template <typename> class Material>() {
    ReduceOptions used = options;
    if (solid.law == "mooney-rivlin" && used.poses.inverted == InvertedPoses::Keep)
      used.poses.inverted = InvertedPoses::Shrink;
    const auto system = stage("full system", [&](auto) {
      return std::make_unique<FullSystem<TetElasticity<Material>>>(make_model<Material>(solid),
                                                                   solid.nodal_mass(), solid.fixed_nodes);
    });
    const VibrationModes modes = stage("vibration modes", [&](auto) {
      return vibration_modes(
          *system,
          {.num_modes = options.modes, .tolerance = 1e-8, .seed = options.seed, .progress = progress});
    });
    if (options.subspace == "extended") {
      auto subspace = stage("subspace", [&](auto) {
        return std::make_shared<const NodalBasis>(
            extend_modes(modes, solid.mesh.nodes, system->nodal_mass()));
      });
      fit_and_finish<Material>(solid, *system, std::move(subspace), used, model, report, stage, progress);
    } else {
      auto subspace = std::make_shared<const DenseBasis>(
          DenseBasis{modes.vectors, {modes.omega, modes.residuals, modes.num_rigid, 0, modes.notes}});
      fit_and_finish<Material>(solid, *system, std::move(subspace), used, model, report, stage, progress);
    }
  });
  report.total_seconds = total.seconds();
  report.peak_memory = peak_resident_memory();
  return model;
}

double peak_resident_memory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * static_cast<double>(usage.ru_maxrss) : 0;
}

}  // namespace supple
