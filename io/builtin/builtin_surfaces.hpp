#pragma once
/// \file Built-in triangle meshes, by name, for demonstrations, tests and benchmarks: no file needed.

#include <physics/mesh/triangle_mesh.hpp>

#include <string_view>

namespace supple {

/// What builtin_surface understands, one a line.
inline constexpr std::string_view builtin_surface_help =
    "plate:NXxNY             a flat plate of NY rows of triangles with NX edges along a row, 1 m long or "
    "wide\n"
    "cylinder:NxM            an open tube of diameter 1 m, N edges around, M rows of triangles high\n"
    "sphere:N                a sphere of diameter 1 m: an icosahedron, each edge cut in N\n";

/// Whether a text means a built-in surface: it does if what stands before the first ':' is one of their
/// names.
bool is_builtin_surface(std::string_view spec);

/// Makes the surface that a text such as "plate:40x20" or "sphere:16" describes; y is up.
/// Triangles are equilateral, on the sphere nearly so, and at the two ragged ends of every other row of the
/// plate halves of such: on these meshes a discrete shell has no preferred direction. The plate lies in the
/// plane y = 0 with x along its rows and normals up, its longer side 1 m; rows are √¾ edges apart. Cylinder
/// (about the y axis) and sphere have their normals outward. Nodes are numbered row by row.
/// \throws InputError that names the text and what was expected, also for more than 3·10⁷ triangles.
TriangleMesh builtin_surface(std::string_view spec);

}  // namespace supple
