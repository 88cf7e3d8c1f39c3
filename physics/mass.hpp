#pragma once
/// \file Lumped masses.

#include <core/check.hpp>
#include <physics/tet_mesh.hpp>
#include <physics/triangle_mesh.hpp>

namespace supple {

/// Mass of each node [kg], n: a quarter of the mass of each tet around it; the sum is the mass of the object.
/// \param density [kg/m³], one for all tets or one a tet; > 0.
Vector lumped_mass(const TetMesh& mesh, VectorIn density);
Vector lumped_mass(const TetMesh& mesh, double density);

/// Mass of each node [kg] of a shell, n: a third of the mass of each triangle around it, density · thickness
/// · area. \param density    [kg/m³], one for all triangles or one a triangle; > 0. \param thickness  [m],
/// likewise.
Vector lumped_mass(const TriangleMesh& mesh, VectorIn density, VectorIn thickness);
Vector lumped_mass(const TriangleMesh& mesh, double density, double thickness);

}  // namespace supple
