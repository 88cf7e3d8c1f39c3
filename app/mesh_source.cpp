#include <app/mesh_source.hpp>
#include <core/check.hpp>
#include <io/builtin_meshes.hpp>

namespace supple {

NamedMesh load_mesh(const std::string& spec) {
  NamedMesh result;
  if (is_builtin(spec)) {
    result.mesh = builtin_mesh(spec);
    result.notes.format = "built-in";
    return result;
  }
  if (!std::filesystem::exists(spec))
    throw InputError(
        spec +
        ": there is no such file, and no built-in mesh of this name (bar, cube, menger, ball, octopus)");
  result.mesh = read_tet_mesh(spec, &result.notes);
  return result;
}

}  // namespace supple
