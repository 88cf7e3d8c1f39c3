#pragma once
/// \file Built-in meshes of solids, by name, for demonstrations, tests and benchmarks: no file needed.

#include <io/mesh/mesh_reader.hpp>

#include <string_view>

namespace supple {

/// What builtin_mesh understands, one a line.
inline constexpr std::string_view builtin_mesh_help =
    "bar:NXxNYxNZ            a bar of so many cells, its longest side 1 m; 6 tets a cell\n"
    "cube:N                  the unit cube of N x N x N cells\n"
    "menger:BASE,LEVEL,SUB   a Menger sponge of BASE^LEVEL cells a side (classic: 3), each cut in SUB^3\n"
    "ball:N                  a ball of diameter 1 m, N cells of 12 tets across\n"
    "octopus[:N]             an octopus 1 m wide, N cells a metre (44: 95 000 tets); fix it by y<4%\n"
    "hexbox:NXxNYxNZ         the bar, of hexahedra\n"
    "tet10:...               any of the others with tets of second order, a node amid each edge, as tet10:bar:8x2x2\n";

/// Whether a text means a built-in mesh of a solid: it does if what stands before the first ':' is one of their names.
bool is_builtin(std::string_view spec);

/// Makes the mesh that a text such as "bar:80x20x10" or "octopus" describes; y is up.
/// Cells of bar, cube and sponge are cut in six tets about their diagonal (Kuhn 1960); nodes are numbered
/// with z fastest. The sponge fills the unit cube and drops a cell where at some level at least two of its
/// three digits to BASE are neither the first nor the last. Ball and octopus come from stuff_isosurface.
/// \throws InputError that names the text and what was expected, also for more than 3·10⁷ tets or lattice
///   cells.
/// \note 0.2 s for the octopus.
TetMesh builtin_mesh(std::string_view spec);

/// The same for every built-in solid: "hexbox:40x10x10" is a bar of hexahedra, "tet10:ball:8" a ball of quadratic tets.
SolidMesh builtin_solid_mesh(std::string_view spec);

}  // namespace supple
