#pragma once
/// \file Models of one object, made one after the other.

#include <reduction/pipeline/trained_object.hpp>

#include <optional>

namespace supple {

/// reduce() for several options that may differ in subspace, modes, dimension, points and whether forces relax. A model
/// that differs from the last one in its points alone shares its subspace and training.
class ModelSeries {
 public:
  /// \param body  must outlive the series.
  explicit ModelSeries(const Body& body, Progress progress = {}) : body_(body), progress_(std::move(progress)) {}

  /// \throws as reduce().
  ReducedModel make(const ReduceOptions& options, ReduceReport& report);

 private:
  const Body& body_;
  Progress progress_;
  ReduceOptions last_;
  std::optional<TrainedObject> trained_;  // by the last options
};

}  // namespace supple
