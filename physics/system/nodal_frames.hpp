#pragma once
/// \file Rotations of nodes, by which the matter around them has turned.

#include <numerics/linear/block_rotations.hpp>
#include <physics/system/node_numbering.hpp>

#include <span>

namespace supple {

/// For each free node v the rotation closest to F = Σ (x_b − x_v)(X_b − X_v)ᵀ / |X_b − X_v|² over the other corners b of
/// its components: rest positions X, positions x = X + u. Nodes whose neighbours lie along a line have one of the many; nodes that slide
/// keep their axes, I.
/// \param X  n × 3 [m].  \param U  displacements of all nodes, 3n × k [m].  \param stencils  stencil_size nodes a
/// component.  \return one for each of the k states
std::vector<BlockRotations> nodal_frames(const Points& X, const RowMatrix& U, std::span<const Index> stencils,
                                         Index stencil_size, const NodeIncidence& incidence,
                                         const NodeNumbering& numbering);

}  // namespace supple
