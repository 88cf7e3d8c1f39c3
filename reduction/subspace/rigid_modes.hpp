#pragma once
/// \file Rigid and affine motions of free parts, in closed form.

#include <physics/mesh/node_components.hpp>
#include <physics/system/node_numbering.hpp>

namespace supple {

/// Components of an object that no support holds anywhere.
struct FreeComponents {
  NodeComponents components;
  std::vector<Index> free;          ///< numbers of the components without a node that is fixed or slides
  std::vector<Index> sliding = {};  ///< of those without a fixed node some of whose nodes slide

  Index num_rigid_modes() const { return 6 * static_cast<Index>(free.size()); }
};
FreeComponents find_free_components(std::span<const Index> stencils, Index stencil_size,
                                    const NodeNumbering& numbering);

/// n × 4c: the fields 1, X, Y, Z of each free component about its centre, divided by its size so that all are
/// of order one; zero elsewhere. Times I₃ they span the affine motions.
RowMatrix affine_fields(const Points& rest_positions, const FreeComponents& components);

/// 3n × 6c: three translations and three linearised rotations of each free component, unknowns of all nodes.
Matrix rigid_modes(const Points& rest_positions, const FreeComponents& components);

}  // namespace supple
