#pragma once
/// \file Choice among measured models: the front of time and error, and the model that a goal asks for.

#include <cstddef>
#include <span>
#include <vector>

namespace supple {

/// What a model costs and how far it is off; NaN: not known.
struct ModelMeasure {
  double step_seconds = 0;  ///< of a time step [s]
  double error = 0;         ///< relative, against the full object
};

/// Whether each model is on the Pareto front: of what is known of all, no other is at least as good in both and better
/// in one. \note O(n²)
std::vector<bool> pareto_front(std::span<const ModelMeasure> models);

/// What a model is asked for.
struct ModelGoal {
  enum class Limit { Error, StepTime };

  Limit limit = Limit::Error;
  double most = 0;  ///< error, relative; or time of a step [s]

  bool is_met_by(const ModelMeasure& model) const;
  /// The best of models that were tried, coarse to fine. Error: the first that meets the goal; if none does, the one of least
  /// error. Step time: of those that meet it the one of least error; if none does, the fastest. At least one model.
  std::size_t best_of(std::span<const ModelMeasure> tried) const;
};

}  // namespace supple
