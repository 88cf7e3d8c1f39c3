#include <viewer/session/pacemaker.hpp>
#include <viewer/session/settings.hpp>

int main() {
  supple::Pacemaker pace;
  pace.pass(0.1, 1);
  const supple::SettingsChange change{.speed = 0.5};
  supple::check_settings(change.applied_to({.step = 0.01}), 1);
  return pace.is_due(0.01) ? 0 : 1;
}
