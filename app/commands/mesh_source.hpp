#pragma once
/// \file Meshes as the command line names them.

#include <io/mesh/mesh_notes.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <string>
#include <variant>

namespace supple {

struct NamedMesh {
  std::variant<TetMesh, HexMesh, QuadraticTetMesh, TriangleMesh> mesh;
  MeshNotes notes;  ///< of a file; for a built-in only the format

  const Points& nodes() const {
    return std::visit([](const auto& m) -> const Points& { return m.nodes; }, mesh);
  }
  const NodePlaces& places() const {
    return std::visit([](const auto& m) -> const NodePlaces& { return m.places; }, mesh);
  }
};

/// A built-in such as "bar:80x20x10" or "sphere:16", or else a file: a surface by its extension (.obj, .off, .ply,
/// .stl), anything else a solid; "tet10:FILE": the tets of a file with a node amid each edge.
/// Tells the terminal of the notes' warnings.
/// \param unit  of the file's lengths; built-ins are in metres.
NamedMesh load_mesh(const std::string& spec, const std::string& unit = "m");
/// Whether a file, not a mesh, is named, and begins as a model does: with the length of a header, and its brace.
bool is_model(const std::string& source);
/// The built-ins and their sizes, for the foot of a help text.
std::string builtin_help();

}  // namespace supple
