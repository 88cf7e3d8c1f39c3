#pragma once
/// \file Settings of a session: what acts on the object, and how it moves.

#include <core/registry.hpp>
#include <core/types.hpp>
#include <physics/load/penalty_floor.hpp>
#include <physics/system/damping.hpp>

#include <optional>

namespace supple {

/// A floor that the object cannot fall through.
struct Floor {
  FloorAxis axis = FloorAxis::Y;
  double height = 0;  ///< [m]

  bool operator==(const Floor&) const = default;
};

/// What a user may set at any time.
struct ViewSettings {
  Point gravity = Point::Zero();  ///< [m/s²]
  double step = 0;                ///< [s]
  double speed = 1;               ///< session time over wall-clock time that is wanted
  double stiffness = 1;           ///< factor on the elastic forces
  RayleighDamping damping = {};
  Choice integrator{"average-vector-field"};  ///< one of integrators()
  std::optional<Floor> floor = {};
};

/// Some of them, to be changed together.
struct SettingsChange {
  std::optional<Point> gravity = {};
  std::optional<double> step = {}, speed = {}, stiffness = {};
  std::optional<RayleighDamping> damping = {};
  std::optional<Choice> integrator = {};
  std::optional<std::optional<Floor>> floor = {};

  ViewSettings applied_to(ViewSettings settings) const;
};

/// \throws std::invalid_argument naming the first that is out of range. \param diagonal  of the object [m].
void check_settings(const ViewSettings& settings, double diagonal);

}  // namespace supple
