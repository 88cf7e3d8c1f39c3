#pragma once
/// \file Galerkin system, the exact reduced one: every component, in a subspace.

#include <physics/system/full_system.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/subspace_load.hpp>

#include <memory>

namespace supple {

/// F̄(q) = Uᵀ f(U q) by way of the full system: what a selection approximates. Costs O(m + d n), so it is no system for
/// real time, but the judge of subspaces; keeps nothing but U and the full system.
template <ForceModel Model, Subspace S>
class GalerkinSystem {
 public:
  using MatrixType = Matrix;
  static constexpr bool symmetric_tangent = has_symmetric_tangent<Model>();

  GalerkinSystem(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace)
      : system_(std::move(system)),
        subspace_(std::move(subspace)),
        mass_(Vector::Ones(subspace_->dim())),
        rest_stiffness_(project_stiffness(*subspace_, *system_)) {}

  Index dim() const { return subspace_->dim(); }
  const S& subspace() const { return *subspace_; }
  const Vector& mass() const { return mass_; }  ///< ones: U is M-orthonormal
  const Matrix& rest_stiffness() const { return rest_stiffness_; }

  double energy(VectorIn q) const requires PotentialModel<Model> {
    return system_->energy(system_->restrict(subspace_->reconstruct(q)));
  }
  void force(VectorIn q, VectorOut f) const {
    const Vector full = system_->expand(system_->force(system_->restrict(subspace_->reconstruct(q))));
    f = subspace_->project(full);
  }
  void stiffness(VectorIn q, Matrix& K) const {
    K = project_stiffness(*subspace_, *system_, system_->stiffness(system_->restrict(subspace_->reconstruct(q))));
  }

  Index num_nodes() const { return system_->num_nodes(); }
  /// Displacements of all nodes, n · node_dim.
  Vector expand(VectorIn q) const { return subspace_->reconstruct(q); }
  /// Displacement of a node [m].
  Point displacement(VectorIn q, Index node) const requires(Model::node_dim == 3) {
    return {subspace_->at(3 * node, q), subspace_->at(3 * node + 1, q), subspace_->at(3 * node + 2, q)};
  }

  /// Forces on all nodes, n · node_dim → on the unknowns.
  SystemLoad<Matrix> project(VectorIn nodal_forces) const { return {subspace_->project(nodal_forces), {}}; }
  SystemLoad<Matrix> project(const Loads& loads) const requires(Model::node_dim == 3) {
    const SystemLoad<SparseMatrix> full = system_->project(loads);
    SystemLoad<Matrix> result{subspace_->project(system_->expand(full.force)), {}};
    if (full.has_stiffness()) result.stiffness = project_stiffness(*subspace_, *system_, full.stiffness);
    if (!full.springs.empty()) result.springs = subspace_springs(*subspace_, loads.springs);
    result.others = outside_terms(loads.others, subspace_->W, S::block);
    return result;
  }

 private:
  std::shared_ptr<const FullSystem<Model>> system_;
  std::shared_ptr<const S> subspace_;
  Vector mass_;
  Matrix rest_stiffness_;
};

}  // namespace supple
