#include <core/median.hpp>
#include <core/peak_memory.hpp>
#include <reduction/pipeline/body_training.hpp>
#include <reduction/pipeline/selection_study.hpp>
#include <reduction/training/pull_test.hpp>
#include <sparse/selectors/nn_sp.hpp>

#include <limits>
#include <numeric>
#include <optional>
#include <utility>

namespace supple {

namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Median seconds of a call, in batches that last long enough to time.
template <typename Call>
double median_seconds(const Call& call) {
  std::vector<double> batches(15);
  for (double& batch : batches) {
    const Stopwatch watch;
    int calls = 0;
    for (; watch.seconds() < 1e-3; ++calls) call();
    batch = watch.seconds() / calls;
  }
  return median(std::move(batches));
}

}  // namespace

struct SelectionStudy::Interface {
  virtual ~Interface() = default;
  virtual const AnyProblem& problem() const = 0;
  virtual double held_out_error(const std::vector<Index>& indices, VectorIn weights) const = 0;
  virtual SelectionMeasure measure(const Selection& selection) const = 0;

  ReduceReport report;
  std::vector<PullScene> scenes;
  std::vector<double> reached;
};

template <typename AnyTraining>
struct SelectionStudy::Model final : Interface {
  using Stacked = StackedProblem<typename AnyTraining::Fitting, typename AnyTraining::Equilibria>;
  using Pulls = PullTest<AnySystem<Matrix>>;

  Model(AnyTraining&& some, std::vector<PullScene> pulled, StageClock& stage)
      : training(std::move(some)),
        stacked(training.equilibria ? std::optional<Stacked>(std::in_place, training.fitting, *training.equilibria)
                                    : std::nullopt),
        any(stacked ? AnyProblem(*stacked) : AnyProblem(training.fitting)) {
    this->report = report_of(training);
    exact_softest = object.softest_eigenvalues(object.rest_stiffness, 1)[0];
    if (pulled.empty()) return;
    stage("reference motions", [&](auto) {
      const Index m = training.fitting.cols();
      const Selection rough = NnSp{.max_iterations = 5}(any, std::min(m, 2 * training.fitting.poses().rows()));
      pulls.emplace(std::move(pulled), object.modes, object.traits.diagonal,
                    object.any_system(rough.indices, rough.weights));
      std::vector<Index> all(m);
      std::iota(all.begin(), all.end(), Index{0});
      const auto unfitted = object.any_system(all, Vector::Ones(m));
      references = pulls->move(unfitted);
      for (std::size_t k = 0; k < references.size(); ++k) {
        this->reached.push_back(pulls->reach(unfitted, references[k].q));
        if (references[k].missed_steps > 0)
          this->report.notes.push_back(std::to_string(references[k].missed_steps) + " steps of the reference motion '" +
                                       pulls->scenes()[k].name + "' missed the tolerance");
      }
    });
    this->scenes = pulls->scenes();
  }

  const AnyProblem& problem() const override { return any; }
  double held_out_error(const std::vector<Index>& indices, VectorIn weights) const override {
    return training.held_out.empty() ? nan : training.held_out.front().second.error(indices, weights);
  }

  SelectionMeasure measure(const Selection& selection) const override {
    SelectionMeasure measure;
    measure.softest_eigenvalue = measure.force_seconds = nan;
    measure.trajectory_errors.assign(references.size(), nan);
    const auto hold_out = [&](std::span<const Index> indices, VectorIn weights) {
      for (const auto& [share, problem] : training.held_out)
        measure.held_out.emplace_back(share, problem.error(indices, weights));
    };
    WorkingComponents working = with_positive_weights(selection.indices, selection.weights);
    if (working.indices.empty() || (selection.weights.array() < 0).any()) {
      hold_out(selection.indices, selection.weights);
      return measure;
    }
    working = training.refitted(working);
    hold_out(working.indices, working.weights);
    const auto system = object.any_system(working.indices, working.weights);
    const Vector rest = Vector::Zero(system.dim());
    measure.softest_eigenvalue = object.softest_eigenvalues(system.stiffness(rest), 1)[0] / exact_softest;
    Vector force(system.dim());
    const Vector q = training.fitting.poses().col(0);
    measure.force_seconds = median_seconds([&] { system.force(q, force); });
    if (pulls) {
      const std::vector<PulledMotion> motions = pulls->move(system);
      for (std::size_t k = 0; k < motions.size(); ++k)
        measure.trajectory_errors[k] = deviation(motions[k], references[k]);
    }
    return measure;
  }

  AnyTraining training;
  const decltype(AnyTraining::object)& object = training.object;
  std::optional<Stacked> stacked;  // if there are equilibria
  AnyProblem any;
  double exact_softest = 0;
  std::optional<Pulls> pulls;
  std::vector<PulledMotion> references;
};

SelectionStudy::SelectionStudy(const Body& body, const ReduceOptions& options, std::vector<PullScene> scenes,
                               const Progress& progress) {
  check(options);
  StageClock stage(progress);
  with_object(body, options, stage, [&](const auto& system, const auto& subspace) {
    auto training = train(system, subspace, traits_of(body, options), options, stage);
    self_ = std::make_unique<Model<decltype(training)>>(std::move(training), std::move(scenes), stage);
  });
  self_->report.seconds = stage.seconds();
  self_->report.total_seconds = stage.total_seconds();
  self_->report.peak_memory = peak_resident_memory();
}

SelectionStudy::~SelectionStudy() = default;
SelectionStudy::SelectionStudy(SelectionStudy&&) noexcept = default;
SelectionStudy& SelectionStudy::operator=(SelectionStudy&&) noexcept = default;

const AnyProblem& SelectionStudy::problem() const {
  return self_->problem();
}
double SelectionStudy::held_out_error(const std::vector<Index>& indices, VectorIn weights) const {
  return self_->held_out_error(indices, weights);
}
SelectionMeasure SelectionStudy::measure(const Selection& selection) const {
  return self_->measure(selection);
}
const ReduceReport& SelectionStudy::report() const {
  return self_->report;
}
const std::vector<PullScene>& SelectionStudy::scenes() const {
  return self_->scenes;
}
const std::vector<double>& SelectionStudy::largest_displacements() const {
  return self_->reached;
}

}  // namespace supple
