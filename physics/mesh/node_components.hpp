#pragma once
/// \file Connected components of an object, through nodes shared by stencils.

#include <core/types.hpp>

#include <span>
#include <vector>

namespace supple {

/// Number of the connected component of each node, 0 … count − 1 in order of their first nodes.
struct NodeComponents {
  std::vector<Index> of_node;
  Index count = 0;
};

/// \param stencils  node numbers, stencil_size at a time.
NodeComponents connected_components(std::span<const Index> stencils, Index stencil_size, Index num_nodes);

}  // namespace supple
