#pragma once
/// \file Lumped masses.

#include <core/check.hpp>
#include <physics/tet_mesh.hpp>

namespace supple {

/// Mass of each node [kg], n: a quarter of the mass of each tet around it; the sum is the mass of the object.
/// \param density [kg/m³], one for all tets or one a tet; > 0.
Vector lumped_mass(const TetMesh& mesh, VectorIn density);
Vector lumped_mass(const TetMesh& mesh, double density);

}  // namespace supple
