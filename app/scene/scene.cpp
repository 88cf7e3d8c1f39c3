#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/scene.hpp>
#include <core/check.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/table/csv.hpp>
#include <io/text/json_fields.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <physics/load/outside_force_library.hpp>
#include <physics/time/integrator_library.hpp>

#include <numeric>

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

Index nearest_node(const Points& nodes, const Point& point) {
  Index nearest = 0;
  (nodes.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest;
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

/// Where a user's index of a node may lie.
Interval node_range(const Body& body) {
  return between(0, static_cast<double>(node_places(body).num_places(num_nodes(body)) - 1));
}

Index read_node(const JsonFields& fields, const Body& body) {
  const Index place = fields.integer("node", node_range(body)), node = node_places(body).node(place);
  if (node < 0) fields.fail("node", "is " + std::to_string(place) + ", a node that no cell has");
  return node;
}

/// The node nearest to the point "at". \throws InputError for a point farther off than half the object's diagonal.
Index node_at(const JsonFields& fields, const Points& nodes) {
  const Point at = fields.point("at");
  const Index node = nearest_node(nodes, at);
  const double distance = (nodes.row(node).transpose() - at).norm(), diagonal = bounding_box(nodes).diagonal();
  if (distance > 0.5 * diagonal)
    fields.fail("at", "is " + shown(distance, 3) + " m from the nearest node of an object of " + shown(diagonal, 3) +
                          " m; lengths are in metres");
  return node;
}

/// The nodes that "node", "at" or "nodes" names, exactly one of them, with their shares of the whole: by
/// mass, so that a finer mesh is not pulled harder.
using NodeShares = std::vector<std::pair<Index, double>>;
NodeShares read_nodes(const JsonFields& fields, const Body& body) {
  if (fields.contains("node") + fields.contains("at") + fields.contains("nodes") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'node', 'at' and 'nodes'");
  if (fields.contains("node")) return {{read_node(fields, body), 1.0}};
  if (fields.contains("at")) return {{node_at(fields, node_positions(body)), 1.0}};
  const std::string rule = fields.text("nodes");
  std::vector<Index> nodes;
  try {
    nodes = select_nodes(node_positions(body), rule);
  } catch (const InputError& error) {
    fields.fail("nodes", std::string("selects nothing: ") + error.what());
  }
  const Vector mass = nodal_mass(body);
  NodeShares shares;
  double sum = 0;
  for (const Index v : nodes) sum += mass[v];
  for (const Index v : nodes) shares.emplace_back(v, mass[v] / sum);
  return shares;
}

/// What acts on nodes that the model holds moves nothing, which is easily overlooked.
void warn_of_held_nodes(const JsonFields& fields, const NodeShares& nodes, const Body& body, const char* what) {
  double held = 0;
  for (const auto& [node, share] : nodes)
    if (std::ranges::binary_search(fixed_nodes(body), node)) held += share;
  if (held > 0.01)
    warn(fields.source() + ": " + fields.place() + ": " + shown_percent(held) + " of this " + what +
         " acts on nodes that the model holds, and moves nothing");
}

/// An option of a registry's entry, as text.
std::string read_option(const JsonFields& fields, const OptionInfo& option) {
  switch (option.type) {
    case OptionType::WholeNumber:
      return std::to_string(fields.integer(option.name));
    case OptionType::Number:
      return exact(fields.number(option.name));
    case OptionType::Flag:
      return fields.flag(option.name) ? "yes" : "no";
    case OptionType::Word:
      return fields.text(option.name);
  }
  return "";
}

std::vector<Index> all_nodes(Index n) {
  std::vector<Index> nodes(static_cast<std::size_t>(n));
  std::iota(nodes.begin(), nodes.end(), Index{0});
  return nodes;
}

TimedSprings read_springs(const JsonFields& fields, const Body& body) {
  TimedSprings result;
  const double stiffness = fields.number("stiffness", positive, "N/m");
  const NodeShares nodes = read_nodes(fields, body);
  warn_of_held_nodes(fields, nodes, body, "spring");
  for (const auto& [node, share] : nodes) result.springs.emplace_back(node, share * stiffness);
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

/// An entry of a registry and its options, from an object that names it by `key`.
template <typename Entry>
Choice read_choice(const JsonFields& fields, std::string_view key, const Registry<Entry>& registry) {
  Choice choice{fields.text(key)};
  if (!registry.contains(choice.name))
    fields.fail(key, "is '" + choice.name + "', expected one of " + listed(registry.names()));
  for (const OptionInfo& option : registry.at(choice.name).options)
    if (fields.contains(option.name)) choice.options.emplace_back(option.name, read_option(fields, option));
  return choice;
}

/// The nodes that a force from outside may touch: all, or those of a rule; with the surface between them.
AnyOutsideForce read_outside_force(const JsonFields& fields, const Body& body) {
  const Choice choice = read_choice(fields, "force", outside_forces());
  TouchedNodes where{node_positions(body), {}, {}, {}};
  if (fields.contains("nodes")) {
    for (const auto& [node, share] : read_nodes(fields, body)) where.nodes.push_back(node);
  } else {
    where.nodes = all_nodes(num_nodes(body));
  }
  const Vector mass = nodal_mass(body);
  where.shares.resize(static_cast<Index>(where.nodes.size()));
  std::vector<char> touched(static_cast<std::size_t>(mass.size()), false);
  for (std::size_t k = 0; k < where.nodes.size(); ++k) {
    where.shares[static_cast<Index>(k)] = mass[where.nodes[k]];
    touched[static_cast<std::size_t>(where.nodes[k])] = true;
  }
  where.shares /= where.shares.sum();
  const Surface surface(body);
  for (const Triangle& triangle : surface.triangles) {
    const std::array<Index, 3> corners{surface.nodes[triangle[0]], surface.nodes[triangle[1]],
                                       surface.nodes[triangle[2]]};
    if (touched[corners[0]] && touched[corners[1]] && touched[corners[2]]) where.triangles.push_back(corners);
  }
  try {
    return outside_forces().at(choice.name).make(where, choice.options);
  } catch (const std::invalid_argument& error) {
    fields.fail("force", "is refused: " + std::string(error.what()));
  }
}

}  // namespace

Scene read_scene(const std::filesystem::path& path, const Body& body) {
  const JsonFields file = JsonFields::read(path);
  Scene scene;
  scene.description = file.text_or("description", path.filename().string());
  if (file.contains("duration")) scene.duration = file.number("duration", positive, "s");
  if (file.contains("step")) scene.step = file.number("step", positive, "s");

  const Point gravity = file.point_or("gravity", Point::Zero(), "m/s^2");
  if (!gravity.isZero(0)) scene.loads.push_back({{.gravity = gravity, .forces = {}, .springs = {}}, {}});
  for (const JsonFields& pull : file.objects_if("pulls"))
    scene.loads.push_back(
        {{.gravity = pull.point("acceleration", "m/s^2"), .forces = {}, .springs = {}}, read_span(pull)});
  for (const JsonFields& fields : file.objects_if("forces")) {
    TimedLoads timed{{}, read_span(fields)};
    const Point force = fields.point("force", "N");
    const NodeShares nodes = read_nodes(fields, body);
    warn_of_held_nodes(fields, nodes, body, "force");
    for (const auto& [node, share] : nodes) timed.loads.forces.push_back({node, share * force});
    scene.loads.push_back(std::move(timed));
  }
  for (const JsonFields& fields : file.objects_if("springs")) scene.springs.push_back(read_springs(fields, body));

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
  return scene;
}

}  // namespace supple
