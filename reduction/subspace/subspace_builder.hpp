#pragma once
/// \file Builders of subspaces as a seam.

#include <physics/system/rest_state.hpp>
#include <reduction/subspace/subspace.hpp>

#include <concepts>

namespace supple {

/// A small object, called with an object at rest, that answers with a subspace of it. It also promises, and
/// supple::testing checks: UᵀMU = I; rows of fixed nodes are zero; equal inputs give equal bits.
template <typename B>
concept SubspaceBuilder = requires(const B& build, const RestState& object) {
  { build(object) } -> Subspace;
};

}  // namespace supple
