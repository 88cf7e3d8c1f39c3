#pragma once
/// \file Selected components that stand for all, in a subspace.

#include <core/types.hpp>
#include <reduction/system/error_indicator.hpp>

#include <optional>
#include <vector>

namespace supple {

/// What a reduction finds: F̃(q) = Σ wᵢ Uᵀ fᵢ(U q) over a selection.
/// \tparam Basis  a shared pointer to a Subspace, or AnyBasis.
template <typename Basis>
struct ReducedForces {
  Basis subspace;
  Matrix rest_stiffness;                         ///< UᵀK(0)U, exact, d × d
  std::vector<Index> indices;                    ///< selected components of the force model, ascending
  Vector weights;                                ///< of these, > 0
  std::optional<ErrorIndicator> indicator = {};  ///< of its error at run time
};

}  // namespace supple
