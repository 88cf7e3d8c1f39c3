#include <app/scene/model_search.hpp>
#include <app/scene/motion_study.hpp>
#include <core/check.hpp>
#include <core/stopwatch.hpp>
#include <reduction/pipeline/model_series.hpp>

#include <limits>
#include <map>
#include <optional>

namespace supple {

namespace {

constexpr double doubtful = 1.5;  // a step that is expected to take so many times what it may is not tried

/// Expects the time of a step from that of the last model in a subspace of the same kind.
class StepTimes {
 public:
  void add(const ModelRung& rung, double step_seconds) { unit_[kind(rung)] = step_seconds / relative(rung); }
  /// 0 where nothing is known.
  double expected(const ModelRung& rung) const {
    const auto known = unit_.find(kind(rung));
    return known == unit_.end() ? 0 : known->second * relative(rung);
  }

 private:
  static std::string kind(const ModelRung& rung) { return Choice::parse(rung.options.subspace).name; }
  static double relative(const ModelRung& rung) { return relative_step_time(rung.dimension, rung.options.points); }

  std::map<std::string, double> unit_;
};

}  // namespace

ModelSearch search(const Body& body, const std::vector<ModelRung>& ladder, const ModelGoal& goal,
                   const Progress& progress) {
  const Stopwatch total;
  const bool timed = goal.limit == ModelGoal::Limit::StepTime;
  ModelSeries series(body, progress);
  std::optional<MotionStudy> motions;
  StepTimes times;
  ModelSearch result;
  std::vector<ModelMeasure> measures;
  std::vector<std::string> failures;
  for (const ModelRung& rung : ladder) {
    if (timed && times.expected(rung) > doubtful * goal.most) continue;
    ReduceReport report;
    ReducedModel model;
    ModelMeasure measure{std::numeric_limits<double>::quiet_NaN(), 0};
    try {
      model = series.make(rung.options, report);
      if (timed) {
        if (!motions) motions.emplace(pluck_scene(model), model);
        const MotionMeasure motion = motions->measure(model, {}, progress);
        if (!motion.complete) throw SolverError("its motion does not run to its end");
        measure.step_seconds = motion.step_seconds;
        times.add(rung, motion.step_seconds);
      }
    } catch (const SolverError& failure) {
      failures.push_back(in_words(rung.options) + " is left out: " + failure.what());
      continue;
    }
    measure.error = report.full_error.total;
    measures.push_back(measure);
    result.tried.push_back({in_words(rung.options), report.dimension, report.points, measure});
    result.chosen = goal.best_of(measures);
    if (result.chosen + 1 == measures.size()) {
      result.options = rung.options;
      result.model = std::move(model);
      result.report = std::move(report);
    }
    if (!timed && goal.is_met_by(measure)) break;
  }
  if (measures.empty()) throw SolverError("no model could be made; " + failures.back());
  result.met = goal.is_met_by(measures[result.chosen]);
  result.report.notes.insert(result.report.notes.end(), failures.begin(), failures.end());
  result.other_seconds = total.seconds();
  for (const auto& [stage, seconds] : result.report.seconds) result.other_seconds -= seconds;
  return result;
}

}  // namespace supple
