#include <app/commands/mesh_source.hpp>
#include <app/report/terminal.hpp>
#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/builtin/builtin_surfaces.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/mesh_repairs.hpp>
#include <io/surface/surface_reader.hpp>

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

}  // namespace

NamedMesh load_mesh(const std::string& spec) {
  NamedMesh result;
  if (is_builtin(spec) || is_builtin_surface(spec)) {
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
