#pragma once
/// \file Name and numbers of a subspace, as a user gives them.

#include <core/types.hpp>

#include <cstdint>
#include <string>

namespace supple {

/// A subspace as words and numbers tell it.
struct SubspaceChoice {
  /// One of known_subspaces(), with options as in "derivatives:affine_fields=no", or several with '+' between: what they
  /// span together.
  std::string name = "extended";
  Index modes = 15;         ///< vibration modes, rigid ones included; of "derivatives" the flexible ones
  Index dimension = 0;      ///< d to aim at, where the modes leave a choice; 0: what they give
  Matrix snapshots = {};    ///< 3n × T displacements [m], for "pca"
  double tolerance = 1e-8;  ///< of modes, relative residual
  std::uint64_t seed = 1;
};

}  // namespace supple
