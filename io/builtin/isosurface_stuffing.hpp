#pragma once
/// \file Mesher that fills a smooth solid, given by a function, with tetrahedra of good shape.

#include <physics/mesh/tet_mesh.hpp>

#include <functional>

namespace supple {

/// Isosurface stuffing on a uniform body-centred cubic lattice: lattice nodes close to the surface are moved
/// onto it, lattice tets that it crosses are cut along a fixed pattern.
/// \param depth    > 0 inside, 0 on the surface, < 0 outside; continuous, called from several threads.
/// \param box      contains the solid.
/// \param spacing  side of a lattice cell [m], 12 tets a cell; parts thinner than two cells may be lost, and
///   surfaces closer than that may touch (see boundary_hinges).
/// \return boundary nodes lie on the surface. Radius ratios are above 0.2 where the surface is smooth at that
///   spacing (0.23 … 0.35 for balls of 10 … 40 cells across).
/// \throws std::invalid_argument if the spacing is not positive, the box holds more than 2³⁰ cells, or no
///   lattice node is inside.
/// \see Labelle and Shewchuk 2007, "Isosurface Stuffing: Fast Tetrahedral Meshes with Good Dihedral Angles".
TetMesh stuff_isosurface(const std::function<double(const Point&)>& depth, const BoundingBox& box, double spacing);

}  // namespace supple
