#pragma once
/// \file Writes surfaces in every format that Supple reads, each straight from its specification and sharing
/// no code with the readers.

#include <physics/mesh/triangle_mesh.hpp>
#include <tests/io/mesh_files.hpp>

namespace supple::test {

/// The surface in every format. Coordinates keep every bit if they are numbers of 32 bits, else those that
/// "float" in a format's name does not spoil. No node may be in the place of another one.
std::vector<MeshFile> in_every_format(const TriangleMesh& mesh);

}  // namespace supple::test
