#pragma once
/// \file What a builder of subspaces lacks, in words, as the compiler's first error.

#include <reduction/subspace/subspace_builder.hpp>

namespace supple {

/// True; or compilation ends at the first requirement of SubspaceBuilderFor<B, S> that is not met, with a sentence that
/// names it: `static_assert(explain_subspace_builder<MyBasis>());`.
template <typename B, typename S = archetype::System>
consteval bool explain_subspace_builder() {
  static_assert(DynamicalSystem<S>, "SubspaceBuilder: what it is called with must be a DynamicalSystem");
  static_assert(
      requires(B & build, const S& system) { build(system); },
      "SubspaceBuilder: `operator()(const System& system) const` is missing, or does not take every system");
  static_assert(
      requires(const B& build, const S& system) { build(system); },
      "SubspaceBuilder: operator()(system) must be const");
  static_assert(SubspaceBuilderFor<B, S>,
                "SubspaceBuilder: operator()(system) must return a Subspace: a DenseBasis or a NodalBasis");
  return true;
}

}  // namespace supple
