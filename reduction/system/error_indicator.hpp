#pragma once
/// \file Data that tells how far a reduced state is from the full object.

#include <core/types.hpp>

#include <vector>

namespace supple {

/// What estimates the distance of reduced states from those of the full object: a second selection, disjoint from that of
/// the model and fitted to the same, for forces in the subspace and along few displacements V outside of it, UᵀMV = 0. Where
/// the two selections disagree, the fit is off; what the second says along V is what the subspace cannot hold.
struct ErrorIndicator {
  std::vector<Index> indices;  ///< ascending, none of the model's
  Vector weights;              ///< > 0
  RowMatrix rows;              ///< (s₂ · a) × (d + k): rows of [U V] behind these components, a of each [kg^-½]
  Vector outside_stiffness;    ///< k, the diagonal of VᵀK(0)V, which has nothing else [1/s²]
  double scale = 1;            ///< median of what was measured under fresh loads over what was estimated
  double trained_size = 0;     ///< ‖q‖ that nine in ten poses do not exceed that forces were fitted to [kg^½ m]

  Index num_outside() const { return outside_stiffness.size(); }  ///< k
};

}  // namespace supple
