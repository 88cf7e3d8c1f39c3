#pragma once
/// \file Notes that the mesh readers hand out beside the mesh: format, warnings, numbers in the file.

#include <physics/mesh/mesh_numbers.hpp>

#include <string>
#include <vector>

namespace supple {

/// What a reader has to say about a mesh that it did read.
struct MeshNotes {
  std::string format;                 ///< "Gmsh 4.1, binary"
  std::vector<std::string> warnings;  ///< what was repaired or left out, what may surprise in a simulation
  MeshNumbers numbers;                ///< the file's own number of each node and each cell or triangle
};

}  // namespace supple
