#pragma once
/// \file Writes meshes in every format that Supple reads, each straight from its specification and sharing no
/// code with the readers.

#include <physics/mesh/cell_mesh.hpp>
#include <tests/support/test_folder.hpp>

#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

namespace supple::test {

/// The text of a file, or of the two of TetGen.
struct MeshFile {
  std::string format;     ///< "gmsh_22_binary"; also a file name that is unique among the formats
  std::string extension;  ///< ".msh"
  std::string bytes;      ///< of FORMAT.EXTENSION
  std::string ele_bytes;  ///< of FORMAT.ele, where the extension is ".node"
};

inline void PrintTo(const MeshFile& file, std::ostream* out) {
  *out << file.format;
}

/// The mesh in every format that has such cells; coordinates keep every bit. Where a format leaves the order of
/// mid-edge nodes open, they come in one of their own.
std::vector<MeshFile> in_every_format(const TetMesh& mesh);
std::vector<MeshFile> in_every_format(const HexMesh& mesh);
std::vector<MeshFile> in_every_format(const QuadraticTetMesh& mesh);

/// Writes the file into a folder. \return its path.
std::filesystem::path write(const MeshFile& file, const std::filesystem::path& folder);
std::filesystem::path write(const std::string& bytes, const std::filesystem::path& path);

}  // namespace supple::test
