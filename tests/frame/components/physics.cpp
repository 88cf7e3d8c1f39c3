// A mass on three springs falls for one time step.
#include <physics/model/spring_model.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/newmark.hpp>

using namespace supple;

int main() {
  Points nodes(4, 3);
  nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const FullSystem system(SpringModel(nodes, {{0, 1}, {0, 2}, {0, 3}}, /*stiffness=*/100), Vector::Ones(4), {1, 2, 3});
  Newmark newmark(system, /*h=*/0.01);
  State state = State::at_rest(system.dim());
  const StepReport report = newmark.step(system.project({.gravity = {0, 0, -9.81}}), state);
  return report.status == Status::Converged && state.u[2] < 0 ? 0 : 1;
}
