#pragma once
/// \file Reader of triangle meshes from OBJ, OFF, PLY and STL files.

#include <io/mesh/mesh_notes.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <filesystem>

namespace supple {

/// Reads the surface of a file and makes it fit for shells. Formats, known by their content (OBJ also by
/// name):
///   - Wavefront OBJ: v and f, with any of the forms v, v/vt, v/vt/vn, v//vn, and negative indices
///   - OFF, also with normals, colours, texture coordinates (COFF, NOFF, …), ASCII
///   - PLY, ASCII and binary of either byte order, with any properties and further elements
///   - STL, ASCII and binary; corners with exactly the same position become one node
///
/// Nodes keep their order. Kept, with a warning: polygons (cut into fans of triangles, from a corner that
/// sees all of the polygon), triangles turned over in an otherwise consistent surface (turned back), nodes of
/// no triangle (dropped), several components, parts that hang together by a node, unmerged nodes, needles.
/// Nodes are numbered in messages as the format does: from 1 in OBJ and STL, else from 0.
/// \throws InputError with file, place and expectation: unreadable or truncated files; no triangles; polygons
///   that are no fan from any corner; whatever check_mesh and orient_consistently refuse (three triangles at
///   an edge, flat or repeated triangles, a Möbius strip, …).
TriangleMesh read_triangle_mesh(const std::filesystem::path& path, MeshNotes* notes = nullptr);

}  // namespace supple
