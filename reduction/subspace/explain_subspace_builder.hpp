#pragma once
/// \file Check that says in words, as the compiler's first error, what a builder of subspaces lacks.

#include <reduction/subspace/subspace_builder.hpp>

namespace supple {

/// True; or compilation ends at the first requirement of SubspaceBuilder that B does not meet, with a sentence that
/// names it: `static_assert(explain_subspace_builder<MyBasis>());`.
template <typename B>
consteval bool explain_subspace_builder() {
  static_assert(
      requires(B & build, const RestState& object) { build(object); },
      "SubspaceBuilder: `operator()(const RestState& object) const` is missing");
  static_assert(
      requires(const B& build, const RestState& object) { build(object); },
      "SubspaceBuilder: operator()(object) must be const");
  static_assert(SubspaceBuilder<B>,
                "SubspaceBuilder: operator()(object) must return a Subspace, such as a DenseBasis or a NodalBasis");
  return true;
}

}  // namespace supple
