#pragma once
/// \file The seam where subspaces come in.

#include <physics/system/dynamical_system.hpp>
#include <physics/system/node_numbering.hpp>
#include <reduction/subspace/subspace.hpp>

#include <span>

namespace supple {

/// A small object, called with a system, that answers with a subspace of it. It also promises, and
/// supple::testing checks: UᵀMU = I; rows of fixed nodes are zero; equal inputs give equal bits.
template <typename B, typename S>  // "B for S"
concept SubspaceBuilderFor = DynamicalSystem<S> && requires(const B& build, const S& system) {
  { build(system) } -> Subspace;
};

namespace archetype {
/// The least that a builder of ours asks for; declared only.
struct System {
  using MatrixType = SparseMatrix;
  static constexpr int node_dim = 3;
  Index dim() const;
  Index num_nodes() const;
  const Vector& mass() const;
  const Vector& nodal_mass() const;
  double energy(VectorIn u) const;
  void force(VectorIn u, VectorOut f) const;
  void stiffness(VectorIn u, SparseMatrix& K) const;
  const SparseMatrix& rest_stiffness() const;
  AffineLoad<SparseMatrix> project(const Loads& loads) const;
  std::span<const Index> stencils() const;
  const NodeNumbering& numbering() const;
  struct Model {
    static constexpr int stencil_size = 4;
    const Points& rest_positions() const;
  };
  const Model& model() const;
};
static_assert(DynamicalSystem<System>);
}  // namespace archetype

template <typename B>
concept SubspaceBuilder = SubspaceBuilderFor<B, archetype::System>;

}  // namespace supple
