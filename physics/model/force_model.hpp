#pragma once
/// \file Force models: forces between nodes, or fluxes, that are sums of local terms.

#include <core/types.hpp>

#include <concepts>
#include <span>

namespace supple {

/// f(u) = Σᵢ fᵢ(uᵢ): m local terms ("components"); term i reads the nodes of its stencil, node_dim unknowns each,
/// node after node. For deformable objects u are displacements [m] and f forces [N]; for heat, temperatures [K] and
/// heat flows [W]. Units below are those of deformable objects.
///
/// A model also promises, and supple::testing checks: Kᵢ = ∂fᵢ/∂uᵢ, symmetric unless the model says otherwise (see
/// has_symmetric_tangent), symmetric and positive semi-definite at rest in any case; fᵢ(0) = 0 (the rest state is an
/// equilibrium of every term); stencil nodes distinct and in range; const calls safe from several threads.
template <typename F>
concept ForceModel = requires(const F& model, Index i, const Local<F::local_dofs>& u_i) {
  requires F::local_dofs == F::stencil_size* F::node_dim;                                // e.g. 12 = 4 · 3
  { model.num_nodes() } -> std::convertible_to<Index>;                                   // n
  { model.num_components() } -> std::convertible_to<Index>;                              // m
  { model.stencil(i) } -> std::convertible_to<std::span<const Index, F::stencil_size>>;  // the nodes in u_i
  { model.force(i, u_i) } -> std::convertible_to<Local<F::local_dofs>>;                  // [N]
  { model.stiffness(i, u_i) } -> std::convertible_to<LocalMatrix<F::local_dofs>>;        // [N/m]
};

/// A force model with a potential, E(u) = Σᵢ eᵢ(uᵢ). It also promises fᵢ = ∂eᵢ/∂uᵢ, so the tangent is symmetric.
template <typename F>
concept PotentialModel = ForceModel<F> && requires(const F& model, Index i, const Local<F::local_dofs>& u_i) {
  { model.energy(i, u_i) } -> std::convertible_to<double>;  // [J]
};

/// Whether K = ∂f/∂u is symmetric everywhere, as it is where there is a potential. A model or system whose tangent is
/// not says so by `static constexpr bool symmetric_tangent = false`; matrices are then projected and factorised in
/// full.
template <typename F>
constexpr bool has_symmetric_tangent() {
  if constexpr (requires { F::symmetric_tangent; })
    return F::symmetric_tangent;
  else
    return true;
}

/// True if fᵢ does not change when the same vector is added at all nodes of its stencil. A model says so by
/// `static constexpr bool translation_invariant = true`; work and storage of a reduced term then fall by one
/// node.
template <typename F>
constexpr bool is_translation_invariant() {
  if constexpr (requires { F::translation_invariant; })
    return F::translation_invariant;
  else
    return false;
}

/// Nodes whose displacements (relative to the first node where the term is translation invariant) determine a
/// term.
template <typename F>
constexpr int num_active_nodes = F::stencil_size - (is_translation_invariant<F>() ? 1 : 0);

/// Unknowns that determine a term: 9 for a tet, whose energy depends on three edge vectors.
template <typename F>
constexpr int num_active_dofs = num_active_nodes<F>* F::node_dim;

}  // namespace supple
