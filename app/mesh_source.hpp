#pragma once
/// \file Meshes as the command line names them.

#include <io/mesh_reader.hpp>

#include <string>

namespace supple {

struct NamedMesh {
  TetMesh mesh;
  MeshNotes notes;  ///< of a file; for a built-in only the format
};

/// A built-in such as "bar:80x20x10", or else a file.
NamedMesh load_mesh(const std::string& spec);

}  // namespace supple
