#pragma once
/// \file Reader of meshes of solids, of tets or hexahedra, from files of Gmsh, Abaqus, Medit, TetGen, VegaFEM or VTK.

#include <io/mesh/mesh_notes.hpp>
#include <physics/mesh/cell_mesh.hpp>

#include <filesystem>
#include <variant>

namespace supple {

using SolidMesh = std::variant<TetMesh, HexMesh, QuadraticTetMesh>;

/// Reads the cells of a file, all of one kind, and makes them fit for elasticity: tets, hexahedra of eight nodes, or
/// tets of second order, with ten. Formats, known by their content:
///   - Gmsh .msh 2.x and 4.1, ASCII and binary of either byte order; regions are the physical groups of
///     volumes, else the volume entities
///   - Abaqus and CalculiX .inp: C3D4, C3D10 and C3D8 of all kinds, sets, sections, elastic and neo-Hookean or Mooney–Rivlin
///     materials, boundaries, includes; one part, not moved; regions are the element sets of the solid sections, other sets
///     are groups of nodes
///   - Medit .mesh, ASCII; regions are the references of the cells
///   - TetGen .node with .ele, by the name of either or what they have in common; regions are the last
///     attribute of a tet
///   - VegaFEM .veg (TET and CUBIC); regions are numbered from 1 in order of the file and named after their sets
///   - VTK: legacy .vtk, ASCII and binary; .vtu with inline or appended arrays (text, base64, raw; zlib);
///     regions are the first cell array called region, material, gmsh:physical, medit:ref, …
///
/// `region` stays empty where a file marks no cell. Kept, with a warning: reversed cells (their nodes are reordered),
/// nodes of no cell (dropped), the corners of tets of third or higher order, or of mixed orders, hinges, several
/// components, unmerged nodes, cells of bad shape.
/// \throws InputError with file, place and expectation: unreadable or truncated files; no cells, cells of several kinds
///   or of others; whatever check_mesh refuses (tangled, flat or repeated cells, …).
/// \note A binary .msh of 92 000 tets takes about 50 ms, half of it for the checks. Warnings about hinges
///   and the like are only searched for if notes are wanted.
SolidMesh read_solid_mesh(const std::filesystem::path& path, MeshNotes* notes = nullptr);

/// Tets alone, and of those of second order the corners, with a warning. \throws InputError also for hexahedra.
TetMesh read_tet_mesh(const std::filesystem::path& path, MeshNotes* notes = nullptr);

}  // namespace supple
