#include <app/report/terminal.hpp>
#include <app/scene/scene.hpp>
#include <core/check.hpp>
#include <io/text/json_fields.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <physics/time/integrator_library.hpp>
#include <viewer/scene/scene_loads.hpp>

#include <algorithm>
#include <cmath>

namespace supple {

bool TimeSpan::contains(double t) const {
  const double rounding = 1e-9 * (std::abs(t) + ramp);  // of a time that is a multiple of the step
  return t >= from - rounding && t <= until + rounding;
}

double TimeSpan::share(double t) const {
  return !contains(t) ? 0 : ramp == 0 ? 1 : std::clamp((t - from) / ramp, 0.0, 1.0);
}

Point TimedSprings::displacement(double t) const {
  const Index after = std::upper_bound(times.begin(), times.end(), t) - times.begin();
  if (after == 0) return displacements.row(0).transpose();
  if (after == times.size()) return displacements.row(after - 1).transpose();
  const double share = (t - times[after - 1]) / (times[after] - times[after - 1]);
  return ((1 - share) * displacements.row(after - 1) + share * displacements.row(after)).transpose();
}

namespace {

TimeSpan read_span(const JsonFields& fields) {
  TimeSpan span;
  span.from = fields.number_or("from", span.from, any_number, "s");
  span.until = fields.number_or("until", span.until, any_number, "s");
  span.ramp = fields.number_or("ramp", span.ramp, non_negative, "s");
  if (span.until < span.from) fields.fail("until", "is before 'from'");
  return span;
}

TimedSprings read_springs(const JsonFields& fields, const Body& body, std::vector<std::string>& warnings) {
  TimedSprings result;
  const double stiffness = fields.number("stiffness", positive, "N/m");
  const NodeShares nodes = read_nodes(fields, body);
  std::vector<NodalForce> pulls;
  for (const auto& [node, share] : nodes) {
    result.springs.emplace_back(node, share * stiffness);
    pulls.push_back({node, Point::Constant(share)});
  }
  if (const auto note = held_nodes_note(fields, pulls, body, "spring")) warnings.push_back(*note);
  result.when = read_span(fields);
  const bool target = fields.contains("target"), displacement = fields.contains("displacement"),
             path = fields.contains("path");
  if (target + displacement + path > 1)
    throw InputError(fields.source() + ": " + fields.place() + " has several of 'target', 'displacement' and 'path'");
  result.times = Vector::Zero(1);
  result.displacements = Points::Zero(1, 3);
  if (displacement) result.displacements.row(0) = fields.point("displacement").transpose();
  if (target) {
    if (result.springs.size() > 1) fields.fail("target", "is one point for several nodes; give a 'displacement'");
    result.displacements.row(0) =
        fields.point("target").transpose() - node_positions(body).row(result.springs.front().first);
  }
  if (path) {
    const std::vector<JsonFields> keys = fields.objects("path");
    if (keys.empty()) fields.fail("path", "is empty, expected at least one {\"time\": ..., \"displacement\": [...]}");
    result.times.resize(static_cast<Index>(keys.size()));
    result.displacements.resize(result.times.size(), 3);
    for (std::size_t k = 0; k < keys.size(); ++k) {
      result.times[k] = keys[k].number("time", any_number, "s");
      result.displacements.row(k) = keys[k].point("displacement").transpose();
      if (k > 0 && !(result.times[k] > result.times[k - 1])) keys[k].fail("time", "is not after the one before");
    }
  }
  return result;
}

}  // namespace

Loads loads_at(const Scene& scene, double t) {
  Loads all;
  for (const TimedLoads& timed : scene.loads) {
    const double share = timed.when.share(t);
    if (share == 0) continue;
    all.gravity += share * timed.loads.gravity;
    for (const auto& [node, force] : timed.loads.forces) all.forces.push_back({node, share * force});
  }
  for (const TimedSprings& timed : scene.springs)
    if (timed.when.contains(t))
      for (const auto& [node, stiffness] : timed.springs)
        all.springs.push_back({node, stiffness, timed.when.share(t) * timed.displacement(t)});
  for (const TimedForce& timed : scene.others)
    if (timed.when.contains(t)) all.others.push_back(timed.force);
  return all;
}

double time_of_full_load(const Scene& scene) {
  double last = 0;
  const auto count = [&](const TimeSpan& when, double full) { last = std::max(last, std::min(full, when.until)); };
  for (const TimedLoads& timed : scene.loads) count(timed.when, timed.when.from + timed.when.ramp);
  for (const TimedSprings& timed : scene.springs)
    count(timed.when, std::max(timed.when.from + timed.when.ramp, timed.times[timed.times.size() - 1]));
  for (const TimedForce& timed : scene.others) count(timed.when, timed.when.from);
  return last;
}

Index num_idle(const Scene& scene, double t) {
  const auto idle = [t](const auto& all) {
    return std::ranges::count_if(all, [t](const auto& timed) { return timed.when.share(t) == 0; });
  };
  return idle(scene.loads) + idle(scene.springs) + idle(scene.others);
}

Scene read_scene(const std::filesystem::path& path, const Body& body) {
  const JsonFields file = JsonFields::read(path);
  Scene scene;
  std::vector<std::string> warnings;
  scene.description = file.text_or("description", path.filename().string());
  if (file.contains("duration")) scene.duration = file.number("duration", positive, "s");
  if (file.contains("step")) scene.step = file.number("step", positive, "s");
  if (file.contains("start"))
    scene.starts_in_equilibrium = file.choice("start", {"rest", "equilibrium"}) == "equilibrium";

  const Point gravity = file.point_or("gravity", Point::Zero(), "m/s^2");
  if (!gravity.isZero(0)) scene.loads.push_back({{.gravity = gravity, .forces = {}, .springs = {}}, {}});
  for (const JsonFields& pull : file.objects_if("pulls"))
    scene.loads.push_back(
        {{.gravity = pull.point("acceleration", "m/s^2"), .forces = {}, .springs = {}}, read_span(pull)});
  for (const JsonFields& fields : file.objects_if("forces")) {
    TimedLoads timed{{}, read_span(fields)};
    const Point force = fields.point("force", "N");
    const NodeShares nodes = read_nodes(fields, body);
    for (const auto& [node, share] : nodes) timed.loads.forces.push_back({node, share * force});
    if (const auto note = held_nodes_note(fields, timed.loads.forces, body, "force")) warnings.push_back(*note);
    scene.loads.push_back(std::move(timed));
  }
  for (const JsonFields& fields : file.objects_if("surface")) {
    TimedLoads timed{{.forces = read_surface_load(fields, body)}, read_span(fields)};
    if (const auto note = held_nodes_note(fields, timed.loads.forces, body, "load")) warnings.push_back(*note);
    scene.loads.push_back(std::move(timed));
  }
  for (const JsonFields& fields : file.objects_if("springs"))
    scene.springs.push_back(read_springs(fields, body, warnings));

  for (const JsonFields& fields : file.objects_if("outside")) {
    TimeSpan when;
    when.from = fields.number_or("from", when.from, any_number, "s");
    when.until = fields.number_or("until", when.until, any_number, "s");
    if (when.until < when.from) fields.fail("until", "is before 'from'");
    scene.others.push_back({read_outside_force(fields, body), when});
  }

  if (const auto damping = file.object_if("damping"))
    scene.damping = {damping->number_or("alpha", 0, non_negative, "1/s"),
                     damping->number_or("beta", 0, non_negative, "s")};
  if (const auto solver = file.object_if("solver")) {
    if (solver->contains("method"))
      scene.solver = solver_named(step_solvers, solver->choice("method", solver_names(step_solvers)));
    if (solver->contains("tolerance")) scene.tolerance = solver->number("tolerance", positive);
    if (solver->contains("max_iterations")) scene.max_iterations = solver->integer("max_iterations", at_least(1));
    if (solver->contains("max_halvings")) scene.max_halvings = solver->integer("max_halvings", between(0, 20));
    for (const std::string_view moved : {"beta", "gamma"})
      if (solver->contains(moved))
        solver->fail(moved, "belongs to the integrator: \"integrator\": {\"method\": \"newmark\", \"" +
                                std::string(moved) + "\": ...}");
  }
  if (const auto integrator = file.object_if("integrator")) {
    scene.integrator = read_choice(*integrator, "method", integrators());
    try {
      (void)energy_behaviour(*scene.integrator);
    } catch (const std::invalid_argument& error) {
      integrator->fail("method", "is refused: " + std::string(error.what()));
    }
  }
  if (const auto output = file.object_if("output")) {
    if (output->contains("every")) scene.every = output->integer("every", at_least(1));
    if (output->contains("track"))
      for (const Index place : output->integers("track", node_range(body))) {
        scene.track.push_back(node_places(body).node(place));
        if (scene.track.back() < 0)
          output->fail("track", "names node " + std::to_string(place) + ", which no cell has");
      }
  }
  file.finish();
  for (const std::string& warning : warnings) warn(warning);  // of a scene that is taken
  return scene;
}

}  // namespace supple
