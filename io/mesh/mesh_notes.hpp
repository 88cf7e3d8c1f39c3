#pragma once
/// \file Notes that the mesh readers hand out beside the mesh: format, warnings, numbers in the file.

#include <physics/mesh/mesh_numbers.hpp>
#include <physics/system/held_axes.hpp>

#include <map>
#include <string>
#include <vector>

namespace supple {

/// The material that a file gives to a region.
struct FileMaterial {
  std::string name;
  std::string law;                                ///< one of material_laws; empty: isotropic, of whatever law
  double density = 0;                             ///< [kg/m³]
  double young = 0, poisson = 0;                  ///< [Pa]; where there is no law
  std::map<std::string, double> parameters = {};  ///< of the law
};

/// What a reader has to say about a mesh that it did read.
struct MeshNotes {
  std::string format;                          ///< "Gmsh 4.1, binary"
  std::vector<std::string> warnings;           ///< what was repaired or left out, what may surprise in a simulation
  MeshNumbers numbers;                         ///< the file's own number of each node and each cell or triangle
  std::map<int, FileMaterial> materials = {};  ///< by region
  std::vector<HeldAxes> held = {};             ///< how the file holds nodes, ascending
};

}  // namespace supple
