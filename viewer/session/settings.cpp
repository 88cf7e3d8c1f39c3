#include <core/check.hpp>
#include <core/text.hpp>
#include <physics/time/integrator_library.hpp>
#include <viewer/session/settings.hpp>

#include <cmath>

namespace supple {

namespace {

void require_between(const char* name, double value, double low, double high, const char* unit = "") {
  require(value >= low && value <= high,  // false for NaN
          std::string(name) + " is " + shown(value) + unit + ", expected " + shown(low) + " to " + shown(high) + unit);
}

}  // namespace

ViewSettings SettingsChange::applied_to(ViewSettings settings) const {
  const auto set = [](const auto& change, auto& value) {
    if (change) value = *change;
  };
  set(gravity, settings.gravity);
  set(step, settings.step);
  set(speed, settings.speed);
  set(stiffness, settings.stiffness);
  set(damping, settings.damping);
  set(integrator, settings.integrator);
  set(floor, settings.floor);
  return settings;
}

void check_settings(const ViewSettings& settings, double diagonal) {
  require_between("gravity", settings.gravity.norm(), 0, 1e5, " m/s^2");
  require_between("step", settings.step, 1e-7, 1, " s");
  require_between("speed", settings.speed, 0.01, 10);
  require_between("stiffness", settings.stiffness, 1e-3, 1e3);
  require_between("damping of the mass", settings.damping.alpha, 0, 1e4, " 1/s");
  require_between("damping of the stiffness", settings.damping.beta, 0, 100, " s");
  if (settings.floor)
    require_between("height of the floor", settings.floor->height, -1e4 * diagonal, 1e4 * diagonal, " m");
  (void)energy_behaviour(settings.integrator);  // or it is refused
}

}  // namespace supple
