#pragma once
/// \file Lumped masses and heat capacities.

#include <core/check.hpp>
#include <physics/tet_mesh.hpp>
#include <physics/triangle_mesh.hpp>

namespace supple {

/// Mass of each node [kg], n: a quarter of the mass of each tet around it; the sum is the mass of the object.
/// \param density [kg/m³], one for all tets or one a tet; > 0.
Vector lumped_mass(const TetMesh& mesh, VectorIn density);
Vector lumped_mass(const TetMesh& mesh, double density);

/// Heat capacity of each node [J/K], n, likewise. \param density [kg/m³], > 0. \param specific_heat [J/(kg K)], > 0.
Vector lumped_heat_capacity(const TetMesh& mesh, double density, double specific_heat);

/// Mass of each node [kg] of a shell, n: a third of the mass of each triangle around it, density · thickness
/// · area. \param density    [kg/m³], one for all triangles or one a triangle; > 0. \param thickness  [m],
/// likewise.
Vector lumped_mass(const TriangleMesh& mesh, VectorIn density, VectorIn thickness);
Vector lumped_mass(const TriangleMesh& mesh, double density, double thickness);

}  // namespace supple
