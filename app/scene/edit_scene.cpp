#include <app/scene/edit_scene.hpp>
#include <app/scene/solver_names.hpp>
#include <core/check.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/text/json_fields.hpp>

#include <algorithm>
#include <limits>

namespace supple {

namespace {

int read_label(const JsonFields& fields) {
  using Limits = std::numeric_limits<int>;
  return static_cast<int>(fields.integer("label", between(Limits::min(), Limits::max())));
}

HandleRegion read_handle(const JsonFields& fields, const std::filesystem::path& folder, const Points& nodes) {
  HandleRegion handle;
  handle.name = fields.text("name");
  if (fields.contains("nodes") + fields.contains("box") + fields.contains("file") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'nodes', 'box' and 'file'");
  try {
    if (fields.contains("nodes"))
      handle.nodes = select_nodes(nodes, fields.text("nodes"));
    else if (fields.contains("box"))
      handle.nodes = nodes_in_box(nodes, fields.text("box"));
    else if (fields.contains("label"))
      handle.nodes = nodes_with_label(nodes, folder / fields.text("file"), read_label(fields));
    else
      handle.nodes = read_node_set(nodes, folder / fields.text("file"));
  } catch (const InputError& error) {
    if (std::string_view(error.what()).starts_with(fields.source())) throw;
    throw InputError(fields.source() + ": " + fields.place() + ": " + error.what());
  }
  if (fields.contains("samples")) handle.samples = fields.integer("samples", at_least(1));
  if (fields.contains("weight")) handle.weight = fields.number("weight", positive, "N/m");
  return handle;
}

RigidMotion read_motion(const JsonFields& fields, const HandleRegion& handle, const Points& nodes) {
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
  return RigidMotion::turn(axis, fields.number("angle", any_number, "rad"), fields.point_or("centre", mean),
                           translation);
}

}  // namespace

EditScene read_edit_scene(const std::filesystem::path& path, const Body& body) {
  const JsonFields file = JsonFields::read(path);
  const Points& nodes = node_positions(body);
  EditScene scene;
  scene.description = file.text_or("description", path.filename().string());
  scene.seed = static_cast<std::uint64_t>(file.integer_or("seed", 1, non_negative));
  for (const JsonFields& fields : file.objects("handles")) {
    scene.handles.push_back(read_handle(fields, path.parent_path(), nodes));
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
      edit.moves.emplace_back(handle - scene.handles.begin(), read_motion(move, *handle, nodes));
    }
    scene.edits.push_back(std::move(edit));
  }
  if (scene.edits.empty()) file.fail("edits", "is empty, expected at least one edit");
  if (const auto solver = file.object_if("solver")) {
    if (solver->contains("method"))
      scene.solver = solver_named(static_solvers, solver->choice("method", solver_names(static_solvers)));
    if (solver->contains("tolerance")) scene.tolerance = solver->number("tolerance", positive);
    if (solver->contains("max_iterations")) scene.max_iterations = solver->integer("max_iterations", at_least(1));
  }
  file.finish();
  return scene;
}

std::vector<Handle> make_handles(const EditScene& scene, double softest_eigenvalue, double mass) {
  std::vector<Handle> handles;
  for (const HandleRegion& region : scene.handles) {
    const Index count = std::min<Index>(region.samples.value_or(100), static_cast<Index>(region.nodes.size()));
    const double weight =
        region.weight.value_or(default_handle_stiffness(softest_eigenvalue, mass) / (2 * static_cast<double>(count)));
    handles.emplace_back(region.nodes, count, weight, scene.seed + handles.size());
  }
  return handles;
}

std::vector<std::vector<RigidMotion>> handle_paths(const EditScene& scene, const std::vector<Handle>& handles,
                                                   const Points& rest_positions) {
  std::vector<std::vector<RigidMotion>> path;
  std::vector<RigidMotion> last(handles.size());
  for (const Edit& edit : scene.edits) {
    const std::vector<RigidMotion> start = last;
    for (Index k = 1; k <= edit.increments; ++k) {
      for (const auto& [handle, motion] : edit.moves) {
        const RigidMotion way = motion.after(start[handle].inverse());
        const Point centre = start[handle](handles[handle].centre(rest_positions));
        const double share = static_cast<double>(k) / static_cast<double>(edit.increments);
        last[handle] = k == edit.increments ? motion : way.part(share, centre).after(start[handle]);
      }
      path.push_back(last);
    }
  }
  return path;
}

}  // namespace supple
