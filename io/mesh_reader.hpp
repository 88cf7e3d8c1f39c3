#pragma once
/// \file Tetrahedral meshes from files.

#include <io/mesh_notes.hpp>
#include <physics/tet_mesh.hpp>

#include <filesystem>

namespace supple {

/// Reads the tetrahedra of a file and makes them fit for elasticity. Formats, known by their content:
///   - Gmsh .msh 2.x and 4.1, ASCII and binary of either byte order; regions are the physical groups of
///     volumes, else the volume entities
///   - Medit .mesh, ASCII; regions are the references of the tets
///   - TetGen .node with .ele, by the name of either or what they have in common; regions are the last
///     attribute of a tet
///   - VegaFEM .veg; regions are numbered from 1 in order of the file and named after their sets
///   - VTK: legacy .vtk, ASCII and binary; .vtu with inline or appended arrays (text, base64, raw; zlib);
///     regions are the first cell array called region, material, gmsh:physical, medit:ref, …
///
/// `region` stays empty where a file marks no tet. Kept, with a warning: reversed tets (two nodes are
/// swapped), nodes of no tet (dropped), the corners of tets of higher order, hinges, several components,
/// unmerged nodes, nearly flat tets.
/// \throws InputError with file, place and expectation: unreadable or truncated files; no tets, or other
///   solid elements beside them; whatever check_mesh refuses (tangled, flat or repeated tets, …).
/// \note A binary .msh of 92 000 tets takes about 50 ms, half of it for the checks. Warnings about hinges
///   and the like are only searched for if notes are wanted.
TetMesh read_tet_mesh(const std::filesystem::path& path, MeshNotes* notes = nullptr);

}  // namespace supple
