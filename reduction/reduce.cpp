#include <reduction/reduce_stages.hpp>
#include <sparse/selector_library.hpp>
#include <sparse/smallest_selection.hpp>

#include <Eigen/Eigenvalues>

#include <sys/resource.h>

namespace supple {

namespace {

template <typename AnyTraining>
Selection select(const AnyTraining& training, const ReduceOptions& options, const Progress& progress) {
  SelectionRequest request(std::min<Index>(options.points, training.fitting.cols()));
  request.target_error = options.target_error;
  request.progress = progress;
  if (!training.held_out.empty())
    request.validate = [&](const std::vector<Index>& indices, VectorIn weights) {
      return training.held_out.front().second.error(indices, weights);
    };
  const auto select = [&](const AnyProblem& problem, const SelectionRequest& some) {
    return select_by_name(options.selector, problem, some, options.seed);
  };
  const AnyProblem problem(training.fitting);
  return options.target_error > 0 ? smallest_selection(select, problem, request) : select(problem, request);
}

template <typename AnyTraining>
void check_selection(const AnyTraining& training, const ReducedModel& model, ReduceReport& report) {
  report.held_out_error = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [part, problem] : training.held_out)
    report.held_out.emplace_back(part, problem.error(model.indices, model.weights));
  if (!report.held_out.empty()) report.held_out_error = report.held_out.front().second;
  const auto reduced = training.reduced_system(model.indices, model.weights);
  report.exact_eigenvalues = training.softest_eigenvalues(training.rest_stiffness);
  report.fitted_eigenvalues = training.softest_eigenvalues(reduced.stiffness(Vector::Zero(reduced.dim())));
}

}  // namespace

Vector softest_eigenvalues(const Matrix& stiffness, Index first, Index count) {
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(stiffness, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().segment(first, std::min(count, stiffness.rows() - first));
}

void check(const ReduceOptions& options) {
  require(options.points >= 1,
          "number of points is " + std::to_string(options.points) + ", expected at least 1");
  require(options.target_error >= 0, "target error is negative, expected 0 or more");
  require(options.held_out_poses >= 0, "number of held-out poses is negative, expected 0 or more");
  check(options.subspace_choice());
  const auto& selectors = known_selectors();
  require(std::find(selectors.begin(), selectors.end(), options.selector) != selectors.end(),
          "selector '" + options.selector + "' is not known, see known_selectors()");
}

InvertedPoses inverted_rule(std::string_view law, std::optional<InvertedPoses> asked) {
  const bool finite_energy = law == shell_law || material_law(law).finite_when_inverted;
  require(finite_energy || asked != InvertedPoses::Keep,
          "poses with inverted tets cannot be kept: the energy of " + std::string(law) +
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
  return options;
}

ReducedModel reduce(const Body& body, const ReduceOptions& options, ReduceReport* report_out,
                    const Progress& progress) {
  check(options);
  const Stopwatch total;
  ReduceReport local, &report = report_out ? *report_out : local;
  report = {};
  Stages stage(report, progress);
  ReducedModel model;
  model.body = body;
  model.subspace_name = options.subspace;
  with_training(body, options, stage, [&](const auto& training) {
    Selection selection = stage("selection", [&](auto) { return select(training, options, progress); });
    model.subspace = training.subspace;
    model.rest_stiffness = training.rest_stiffness;
    if ((selection.weights.array() < 0).any())
      throw SolverError("selector '" + options.selector +
                        "' gave negative weights, with which a reduced object may be unstable; choose one "
                        "that keeps them positive, such as " + known_selectors().front());
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
    stage("checks", [&](auto) { check_selection(training, model, report); });
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
