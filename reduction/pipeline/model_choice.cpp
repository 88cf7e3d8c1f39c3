#include <core/check.hpp>
#include <reduction/pipeline/model_choice.hpp>

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

/// Whether a is less than b, or known where b is not.
bool better(double a, double b) {
  return a < b || (std::isnan(b) && !std::isnan(a));
}

bool dominates(const ModelMeasure& a, const ModelMeasure& b) {
  return a.step_seconds <= b.step_seconds && a.error <= b.error &&
         (a.step_seconds < b.step_seconds || a.error < b.error);
}

}  // namespace

std::vector<bool> pareto_front(std::span<const ModelMeasure> models) {
  std::vector<bool> front;
  for (const ModelMeasure& model : models)
    front.push_back(!std::isnan(model.step_seconds) && !std::isnan(model.error) &&
                    std::ranges::none_of(models, [&](const ModelMeasure& other) { return dominates(other, model); }));
  return front;
}

bool ModelGoal::is_met_by(const ModelMeasure& model) const {
  return (limit == Limit::Error ? model.error : model.step_seconds) <= most;
}

std::size_t ModelGoal::best_of(std::span<const ModelMeasure> tried) const {
  require(!tried.empty(), "there is no model to choose from");
  std::size_t best = 0;
  for (std::size_t k = 1; k < tried.size(); ++k) {
    const bool met = is_met_by(tried[k]), was_met = is_met_by(tried[best]);
    if (met != was_met) {
      if (met) best = k;
      continue;
    }
    if (limit == Limit::Error && met) continue;
    const bool by_error = limit == Limit::Error || met;
    if (by_error ? better(tried[k].error, tried[best].error) : better(tried[k].step_seconds, tried[best].step_seconds))
      best = k;
  }
  return best;
}

}  // namespace supple
