#include <core/check.hpp>
#include <core/text.hpp>
#include <io/mesh/node_sets.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <viewer/scene/edit_scene_file.hpp>
#include <viewer/scene/scene_loads.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace supple {

namespace {

int read_label(const JsonFields& fields) {
  using Limits = std::numeric_limits<int>;
  return static_cast<int>(fields.integer("label", between(Limits::min(), Limits::max())));
}

std::vector<Index> listed_nodes(const JsonFields& fields, const Points& nodes, const NodePlaces& places) {
  const Interval range = between(0, static_cast<double>(places.num_places(nodes.rows()) - 1));
  return nodes_at_places(fields.integers("indices", range), nodes.rows(), places, fields.source());
}

/// \param folder  where files are looked for; null: there are none.
HandleRegion read_handle(const JsonFields& fields, const std::filesystem::path* folder, const Points& nodes,
                         const NodePlaces& places) {
  HandleRegion handle;
  handle.name = fields.text("name");
  if (fields.contains("nodes") + fields.contains("indices") + fields.contains("box") + fields.contains("file") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'nodes', 'indices', 'box' and 'file'");
  if (!folder && fields.contains("file")) fields.fail("file", "names a file, of which none is read here");
  try {
    if (fields.contains("nodes"))
      handle.nodes = select_nodes(nodes, fields.text("nodes"));
    else if (fields.contains("indices"))
      handle.nodes = listed_nodes(fields, nodes, places);
    else if (fields.contains("box"))
      handle.nodes = nodes_in_box(nodes, fields.text("box"));
    else if (fields.contains("label"))
      handle.nodes = nodes_with_label(nodes, *folder / fields.text("file"), read_label(fields), places);
    else
      handle.nodes = read_node_set(nodes, *folder / fields.text("file"), places);
  } catch (const InputError& error) {
    if (std::string_view(error.what()).starts_with(fields.source())) throw;
    throw InputError(fields.source() + ": " + fields.place() + ": " + error.what());
  }
  if (fields.contains("samples")) handle.samples = fields.integer("samples", at_least(1));
  if (fields.contains("weight")) handle.weight = fields.number("weight", positive, "N/m");
  handle.movable = fields.flag_or("movable", true);
  return handle;
}

/// What a scene is read with.
struct Reading {
  const std::filesystem::path* folder;  // where files are looked for; null: there are none
  std::vector<std::string>* warnings;   // null: not wanted
};

double read_angle(const JsonFields& fields, const Reading& reading) {
  const double angle = fields.number("angle", any_number, "rad");
  if (reading.warnings && fields.is_number("angle") && std::abs(angle) > 2 * std::numbers::pi)
    reading.warnings->push_back(fields.source() + ": " + fields.place() + "/angle is " + shown(angle) +
                                " rad, more than a whole turn; degrees are written as \"" + shown(angle) + " deg\"");
  return angle;
}

RigidMotion read_motion(const JsonFields& fields, const HandleRegion& handle, const Points& nodes,
                        const Reading& reading) {
  if (fields.contains("matrix")) {
    for (const char* other : {"axis", "angle", "centre", "translation"})
      if (fields.contains(other)) fields.fail(other, "stands beside 'matrix', which says it all");
    const Vector m = fields.numbers("matrix", 16);
    try {
      return RigidMotion::from(Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(m.data()));
    } catch (const std::invalid_argument& error) {
      fields.fail("matrix", std::string("is refused: ") + error.what());
    }
  }
  const Point translation = fields.point_or("translation", Point::Zero());
  if (!fields.contains("angle")) {
    for (const char* other : {"axis", "centre"})
      if (fields.contains(other)) fields.fail(other, "needs an 'angle'");
    RigidMotion motion;
    motion.translation = translation;
    return motion;
  }
  const Point axis = fields.point("axis", "1"), mean = nodes(handle.nodes, Eigen::all).colwise().mean().transpose();
  if (!(axis.norm() > 0)) fields.fail("axis", "has no direction");
  return RigidMotion::turn(axis, read_angle(fields, reading), fields.point_or("centre", mean), translation);
}

Loads read_loads(const JsonFields& file, const Body& body, const Reading& reading) {
  Loads loads{.gravity = file.point_or("gravity", Point::Zero(), "m/s^2")};
  const auto note = [&](const JsonFields& fields, const std::vector<NodalForce>& forces, const char* what) {
    const auto text = held_nodes_note(fields, forces, body, what);
    if (text && reading.warnings) reading.warnings->push_back(*text);
  };
  const auto add = [&](const JsonFields& fields, const std::vector<NodalForce>& forces, const char* what) {
    note(fields, forces, what);
    loads.forces.insert(loads.forces.end(), forces.begin(), forces.end());
  };
  for (const JsonFields& fields : file.objects_if("forces")) {
    const Point force = fields.point("force", "N");
    std::vector<NodalForce> forces;
    for (const auto& [node, share] : read_nodes(fields, body)) forces.push_back({node, share * force});
    add(fields, forces, "force");
  }
  for (const JsonFields& fields : file.objects_if("surface")) add(fields, read_surface_load(fields, body), "load");
  for (const JsonFields& fields : file.objects_if("springs")) {
    const double stiffness = fields.number("stiffness", positive, "N/m");
    const Point displacement = fields.point_or("displacement", Point::Zero());
    std::vector<NodalForce> pulls;
    for (const auto& [node, share] : read_nodes(fields, body)) {
      loads.springs.push_back({node, share * stiffness, displacement});
      pulls.push_back({node, Point::Constant(share)});
    }
    note(fields, pulls, "spring");
  }
  for (const JsonFields& fields : file.objects_if("outside")) loads.others.push_back(read_outside_force(fields, body));
  return loads;
}

EditScene read_scene(const JsonFields& file, const Body& body, const Reading& reading) {
  const Points& nodes = node_positions(body);
  EditScene scene;
  scene.description = file.text_or("description", "");
  scene.seed = static_cast<std::uint64_t>(file.integer_or("seed", 1, non_negative));
  for (const JsonFields& fields : file.objects("handles")) {
    scene.handles.push_back(read_handle(fields, reading.folder, nodes, node_places(body)));
    std::erase_if(scene.handles.back().nodes,
                  [&](Index v) { return std::ranges::binary_search(fixed_nodes(body), v); });
    if (scene.handles.back().nodes.empty())
      fields.fail("name", "is '" + scene.handles.back().name + "', all of whose nodes the model holds fixed");
    for (std::size_t k = 0; k + 1 < scene.handles.size(); ++k)
      if (scene.handles[k].name == scene.handles.back().name) fields.fail("name", "is that of an earlier handle, too");
  }
  if (scene.handles.empty()) file.fail("handles", "is empty, expected at least one handle");
  for (const JsonFields& fields : file.objects("edits")) {
    Edit edit;
    edit.increments = fields.integer_or("increments", 1, between(1, 1e6));
    for (const JsonFields& move : fields.objects("moves")) {
      const std::string name = move.text("handle");
      const auto handle = std::find_if(scene.handles.begin(), scene.handles.end(),
                                       [&](const HandleRegion& some) { return some.name == name; });
      if (handle == scene.handles.end()) move.fail("handle", "is '" + name + "', which is no handle of this scene");
      edit.moves.emplace_back(handle - scene.handles.begin(), read_motion(move, *handle, nodes, reading));
    }
    scene.edits.push_back(std::move(edit));
  }
  if (scene.edits.empty()) file.fail("edits", "is empty, expected at least one edit");
  scene.loads = read_loads(file, body, reading);
  if (const auto solver = file.object_if("solver")) {
    if (solver->contains("method"))
      scene.solver = solver_named(static_solvers, solver->choice("method", solver_names(static_solvers)));
    if (solver->contains("tolerance")) scene.tolerance = solver->number("tolerance", positive);
    if (solver->contains("max_iterations")) scene.max_iterations = solver->integer("max_iterations", at_least(1));
  }
  return scene;
}

}  // namespace

EditScene read_edit_scene(const std::filesystem::path& path, const Body& body, std::vector<std::string>* warnings) {
  const JsonFields file = JsonFields::read(path);
  const std::filesystem::path folder = path.parent_path();
  EditScene scene = read_scene(file, body, {&folder, warnings});
  if (scene.description.empty()) scene.description = path.filename().string();
  file.finish();
  return scene;
}

EditScene read_edit_scene(const JsonFields& scene, const Body& body) {
  return read_scene(scene, body, {nullptr, nullptr});
}

nlohmann::ordered_json edit_scene_json(const EditScene& scene, const NodePlaces& places) {
  using Json = nlohmann::ordered_json;
  Json json{{"description", scene.description}, {"seed", scene.seed}, {"handles", Json::array()}};
  for (const HandleRegion& region : scene.handles) {
    Json handle{{"name", region.name}, {"indices", Json::array()}};
    for (const Index v : region.nodes) handle["indices"].push_back(places.place(v));
    if (region.samples) handle["samples"] = *region.samples;
    if (region.weight) handle["weight"] = *region.weight;
    if (!region.movable) handle["movable"] = false;
    json["handles"].push_back(std::move(handle));
  }
  json["edits"] = Json::array();
  for (const Edit& edit : scene.edits) {
    Json moves = Json::array();
    for (const auto& [handle, motion] : edit.moves) {
      const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = motion.matrix();
      const std::vector<double> matrix(rows.data(), rows.data() + rows.size());
      moves.push_back({{"handle", scene.handles[handle].name}, {"matrix", matrix}});
    }
    json["edits"].push_back({{"increments", edit.increments}, {"moves", std::move(moves)}});
  }
  if (const Point& g = scene.loads.gravity; !g.isZero(0)) json["gravity"] = {g[0], g[1], g[2]};
  for (const NodalForce& load : scene.loads.forces)
    json["forces"].push_back(
        {{"node", places.place(load.node)}, {"force", {load.force[0], load.force[1], load.force[2]}}});
  for (const auto& [node, stiffness, u] : scene.loads.springs)
    json["springs"].push_back(
        {{"node", places.place(node)}, {"stiffness", stiffness}, {"displacement", {u[0], u[1], u[2]}}});
  Json solver = Json::object();
  if (scene.solver) solver["method"] = name_of_solver(static_solvers, *scene.solver);
  if (scene.tolerance) solver["tolerance"] = *scene.tolerance;
  if (scene.max_iterations) solver["max_iterations"] = *scene.max_iterations;
  if (!solver.empty()) json["solver"] = std::move(solver);
  return json;
}

}  // namespace supple
