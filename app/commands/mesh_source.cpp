#include <app/commands/mesh_source.hpp>
#include <app/report/terminal.hpp>
#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/builtin/builtin_surfaces.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/mesh_repairs.hpp>
#include <io/surface/surface_reader.hpp>
#include <io/text/unit.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>

namespace supple {

namespace {

bool is_surface_file(const std::filesystem::path& path) {
  constexpr std::array surfaces{".obj", ".off", ".ply", ".stl"};
  return std::any_of(surfaces.begin(), surfaces.end(), [&](const char* known) { return has_extension(path, known); });
}

/// Nodes amid edges stand behind all that the file lists.
QuadraticTetMesh with_places(QuadraticTetMesh mesh, const NodePlaces& of_corners) {
  if (of_corners.of_node.empty()) return mesh;
  mesh.places = of_corners;
  for (Index v = static_cast<Index>(of_corners.of_node.size()); v < mesh.num_nodes(); ++v)
    mesh.places.of_node.push_back(mesh.places.count++);
  return mesh;
}

}  // namespace

NamedMesh load_mesh(const std::string& spec, const std::string& unit) {
  const double metres = conversion_factor(unit, "m");
  NamedMesh result;
  constexpr std::string_view raised = "tet10:";
  if (spec.starts_with(raised) && !is_builtin(spec.substr(raised.size()))) {
    result = load_mesh(spec.substr(raised.size()), unit);
    const auto* tets = std::get_if<TetMesh>(&result.mesh);
    if (!tets) throw InputError(spec + ": expected a mesh of tets with four nodes");
    result.mesh = with_places(quadratic_mesh(*tets), tets->places);
    return result;
  }
  if (is_builtin(spec) || is_builtin_surface(spec)) {
    if (metres != 1) throw InputError("--mesh-unit " + unit + ": built-in meshes are in metres");
    result.notes.format = "built-in";
    if (is_builtin(spec))
      std::visit([&](auto&& mesh) { result.mesh = std::move(mesh); }, builtin_solid_mesh(spec));
    else
      result.mesh = builtin_surface(spec);
    return result;
  }
  if (std::error_code none; !std::filesystem::exists(spec, none))
    throw InputError(spec +
                     ": there is no such file, and no built-in mesh of this name (bar, cube, menger, ball, "
                     "octopus, hexbox, tet10; plate, cylinder, sphere)");
  if (is_surface_file(spec))
    result.mesh = read_triangle_mesh(spec, &result.notes);
  else
    std::visit([&](auto&& mesh) { result.mesh = std::move(mesh); }, read_solid_mesh(spec, &result.notes));
  if (metres != 1) std::visit([&](auto& mesh) { mesh.nodes *= metres; }, result.mesh);
  for (const std::string& warning : result.notes.warnings) warn(spec + ": " + warning);
  return result;
}

bool is_model(const std::string& source) {
  if (is_builtin(source) || is_builtin_surface(source)) return false;
  std::ifstream file(source, std::ios::binary);
  char head[9] = {};
  return file.read(head, sizeof head) && head[8] == '{' && head[4] == 0 && head[5] == 0 && head[6] == 0 && head[7] == 0;
}

std::string builtin_help() {
  return "Built-in meshes:\n" + std::string(builtin_mesh_help) + std::string(builtin_surface_help);
}

}  // namespace supple
