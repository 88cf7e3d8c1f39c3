#pragma once
/// \file Search for the model that a goal asks for, coarse to fine.

#include <core/progress.hpp>
#include <reduction/model/reduced_model.hpp>
#include <reduction/pipeline/model_choice.hpp>
#include <reduction/pipeline/model_ladder.hpp>

#include <string>
#include <vector>

namespace supple {

struct TriedModel {
  std::string model;  ///< in words
  Index dimension = 0, points = 0;
  ModelMeasure measure;  ///< step_seconds is NaN for goals that do not ask for it
};

/// The chosen model, and all that were tried on the way, in order.
struct ModelSearch {
  ReduceOptions options;
  ReducedModel model;
  ReduceReport report;  ///< of the chosen one, with notes on those that could not be made
  std::vector<TriedModel> tried;
  std::size_t chosen = 0;
  bool met = false;          ///< whether it is what the goal asks for
  double other_seconds = 0;  ///< spent on the others, and on timing steps [s]
};

/// Makes models of the ladder from the first one on, compares each with the full object and, for a goal of time, runs
/// pluck_scene() of the first one with it. Ends with the first that meets a goal of error; passes over those whose step,
/// judging by the last one in a subspace of the same kind, takes much longer than a goal of time. \see ModelGoal::best_of()
/// \throws SolverError if none can be made.
ModelSearch search(const Body& body, const std::vector<ModelRung>& ladder, const ModelGoal& goal,
                   const Progress& progress);

}  // namespace supple
