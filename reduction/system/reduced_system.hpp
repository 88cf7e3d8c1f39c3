#pragma once
/// \file Reduced system: selected components in a subspace, dense matrices.

#include <core/check.hpp>
#include <physics/system/dynamical_system.hpp>
#include <reduction/system/pose_sweep.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/row_precision.hpp>
#include <reduction/system/subspace_load.hpp>
#include <reduction/system/weighted_components.hpp>

#include <memory>
#include <span>

namespace supple {

/// The unknowns q of u = U q under the forces F̃(q) = Σ wᵢ Uᵀ fᵢ(U q) over the selected components (Eq. 4).
/// Nothing here touches the full mesh but loads, which read the rows of U they act on.
template <ForceModel Model, Subspace S>
class ReducedSystem {
 public:
  using MatrixType = Matrix;
  static constexpr bool symmetric_tangent = has_symmetric_tangent<Model>();

  /// \param indices, weights  the selection; weights > 0.
  /// \param rest_stiffness    UᵀK(0)U, exact, d × d: what Rayleigh damping uses.
  /// \param nodal_mass        n [kg], for gravity in ℝ³.
  ReducedSystem(std::shared_ptr<const Model> model, std::shared_ptr<const S> subspace, std::span<const Index> indices,
                VectorIn weights, Matrix rest_stiffness, const Vector& nodal_mass,
                RowPrecision precision = RowPrecision::Double)
      : subspace_(std::move(subspace)),
        mass_(Vector::Ones(subspace_->dim())),
        rest_stiffness_(std::move(rest_stiffness)),
        components_(
            model, indices, weights, subspace_->num_fields(),
            [&](Index k) { return component_rows(*model, *subspace_, indices[k]); }, precision) {
    require_size("rest_stiffness.rows()", rest_stiffness_.rows(), dim());
    require_size("rest_stiffness.cols()", rest_stiffness_.cols(), dim());
    require_size("nodal_mass", nodal_mass.size(), model->num_nodes());
    if constexpr (Model::node_dim == 3) gravity_ = project_gravity(*subspace_, nodal_mass);
  }

  Index dim() const { return subspace_->dim(); }
  const S& subspace() const { return *subspace_; }
  Index num_components() const { return components_.num_components(); }  ///< rounded up to packs
  const Vector& mass() const { return mass_; }                           ///< ones: U is M-orthonormal
  const Matrix& rest_stiffness() const { return rest_stiffness_; }       ///< exact, not from the selection

  double energy(VectorIn q) const requires PotentialModel<Model> { return components_.energy(q); }
  void force(VectorIn q, VectorOut f) const { components_.force(q, f); }
  Vector force(VectorIn q) const { return components_.force(q); }
  void stiffness(VectorIn q, Matrix& K) const { components_.stiffness(q, K); }
  Matrix stiffness(VectorIn q) const { return components_.stiffness(q); }
  /// \see supple::mean_force
  void mean_force(VectorIn q_0, VectorIn q_1, VectorOut f) const { components_.mean_force(q_0, q_1, f); }
  void mean_stiffness(VectorIn q_0, VectorIn q_1, Matrix& K) const { components_.mean_stiffness(q_0, q_1, K); }

  /// Forces on all nodes, n · node_dim → on the unknowns.
  SystemLoad<Matrix> project(VectorIn nodal_forces) const { return {subspace_->project(nodal_forces), {}}; }
  SystemLoad<Matrix> project(const Loads& loads) const requires(Model::node_dim == 3) {
    return project_loads(*subspace_, gravity_, loads);
  }

  /// Displacements of all nodes, n · node_dim.
  Vector expand(VectorIn q) const { return subspace_->reconstruct(q); }
  /// Displacement of a node [m].
  Point displacement(VectorIn q, Index node) const requires(Model::node_dim == 3) {
    return {subspace_->at(3 * node, q), subspace_->at(3 * node + 1, q), subspace_->at(3 * node + 2, q)};
  }
  Index num_nodes() const { return subspace_->full_dim() / Model::node_dim; }

 private:
  std::shared_ptr<const S> subspace_;
  Vector mass_;
  Matrix rest_stiffness_;
  Matrix gravity_;  // d × 3: Uᵀ M times a unit acceleration along each axis
  WeightedComponents<Model, S::block> components_;
};

}  // namespace supple
