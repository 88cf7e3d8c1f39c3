#pragma once
/// \file Stress, strain and energy in the cells of a solid.

#include <physics/body/body.hpp>

namespace supple {

/// Of each cell, the mean over its Gauss points, each with its share of the volume at rest. Tensors are symmetric, in the
/// order xx, yy, zz, xy, yz, xz.
struct CellStress {
  RowMatrix cauchy;    ///< σ = P Fᵀ / det F, m × 6 [Pa]
  Vector von_mises;    ///< √(3/2 s : s) with the deviator s of that mean σ, m [Pa]
  RowMatrix strain;    ///< Green–Lagrange, E = (FᵀF − I) / 2, m × 6
  Vector energy;       ///< ψ, m [J/m³ at rest]
  Vector rest_volume;  ///< m [m³]
};

/// Whether cell_stress() has an answer: a solid whose law tells its stress.
bool has_cell_stress(const Body& body);

/// In a state, exact for what the elements interpolate; NaN in cells whose energy is not finite there.
/// \param u  displacements of all nodes, 3n [m].
/// \throws std::invalid_argument for a shell, whose flaps have energies and no stress, and for a law that tells none.
CellStress cell_stress(const Body& body, VectorIn u);

/// Values of cells as means at nodes, each cell with its volume at rest: n, for pictures.
Vector at_nodes(const Body& body, VectorIn of_cells, VectorIn rest_volume);

}  // namespace supple
