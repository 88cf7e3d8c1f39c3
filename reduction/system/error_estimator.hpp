#pragma once
/// \file Estimates of the error of reduced states, while a simulation runs.

#include <core/check.hpp>
#include <physics/system/damping.hpp>
#include <reduction/system/error_indicator.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/weighted_components.hpp>

#include <cmath>
#include <functional>
#include <memory>

namespace supple {

/// Estimated distances in the norm of the masses [kg^½ m].
struct ErrorEstimate {
  Vector lacking;                ///< force that the model lacks by the second selection, along modes [kg^½ m/s²]
  double fit = 0;                ///< displacement that this causes
  double outside = 0;            ///< by what the subspace cannot hold
  bool beyond_training = false;  ///< larger than what forces were fitted to: the estimate may be worth little

  double total() const { return std::hypot(fit, outside); }
};

/// Estimates the error of states by an ErrorIndicator: the displacements, linear about rest, that the forces of its
/// selection ask for. Costs about as much as half a force of the model. Sees the state, not how it came about: for motions see
/// MotionErrorEstimator.
class ErrorEstimator {
 public:
  /// \param modes  of the reduced stiffness at rest.
  template <ForceModel Model>
  ErrorEstimator(std::shared_ptr<const Model> model, const ErrorIndicator& indicator, const ReducedModes& modes)
      : ErrorEstimator(second_selection(std::move(model), indicator), indicator, modes) {}

  /// \param force  f̃(q), of the model itself.
  ErrorEstimate operator()(VectorIn q, VectorIn force) const;

  /// ω² of the modes along which forces are looked at, the softest that have energy [1/s²].
  const Vector& stiffness() const { return stiffness_; }

 private:
  using Forces = std::function<Vector(VectorIn state)>;  // d + k → d + k
  ErrorEstimator(Forces second, const ErrorIndicator& indicator, const ReducedModes& modes);

  template <ForceModel Model>
  static Forces second_selection(std::shared_ptr<const Model> model, const ErrorIndicator& indicator) {
    using Components = WeightedComponents<Model, 1>;
    require_size("indicator.rows.rows()", indicator.rows.rows(),
                 static_cast<Index>(indicator.indices.size()) * Components::rows);
    const auto rows_of = [&](Index k) -> RowMatrix {
      return indicator.rows.middleRows(k * Components::rows, Components::rows);
    };
    const auto components = std::make_shared<const Components>(model, indicator.indices, indicator.weights,
                                                               indicator.rows.cols(), rows_of, RowPrecision::Single);
    return [components](VectorIn state) { return components->force(state); };
  }

  Forces second_;
  Vector stiffness_;
  Matrix modes_;  // d × as many
  Matrix rigid_;  // d × num_zero
  Vector outside_stiffness_;
  double scale_, trained_size_;
};

/// Estimates the error of a motion from rest or from an equilibrium: what the forces lack at each time, by an ErrorEstimator, moves the softest modes
/// as oscillators, so that it adds up where it acts in their rhythm. A motion that is late is wrong by that, whatever its
/// states look like. Linear about rest: good for as long as the error is small beside the motion.
class MotionErrorEstimator {
 public:
  static constexpr Index every =
      4;  ///< steps from call to call that simulations take: as good, for a quarter of the time

  MotionErrorEstimator(ErrorEstimator states, const RayleighDamping& damping);

  /// The motion starts from an equilibrium, whose error is that of statics. To be called before advance().
  void start_from(VectorIn q, VectorIn force);

  /// To be called in the order of times, not necessarily after each step; modes with less than two calls a period are
  /// taken to follow at once. \param time  [s], from 0.
  ErrorEstimate advance(double time, VectorIn q, VectorIn force);

  const Vector& displacement() const { return displacement_; }  ///< estimated error of each mode so far [kg^½ m]

 private:
  ErrorEstimator states_;
  RayleighDamping damping_;
  double time_ = 0;
  Vector lacking_, displacement_, velocity_;  // of each mode: force, and the error that it has caused
};

}  // namespace supple
