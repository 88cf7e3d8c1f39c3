#pragma once
/// \file An object at rest, as the construction of subspaces sees it.

#include <core/types.hpp>
#include <physics/node_numbering.hpp>

#include <functional>
#include <span>
#include <type_traits>

namespace supple {

/// What subspaces of objects in ℝ³ are made from, whatever the force model. Refers to the system, which must
/// outlive it.
struct RestState {
  const SparseMatrix& K;     ///< at rest, over the free unknowns [N/m]
  const Vector& mass;        ///< of the free unknowns [kg]
  const Vector& nodal_mass;  ///< n [kg]
  const Points& positions;   ///< n × 3 [m]
  const NodeNumbering& numbering;
  std::span<const Index> stencils;
  Index stencil_size;
  std::function<void(VectorIn u, VectorOut f)> force;  ///< over the free unknowns; safe from several threads

  /// Columns over the free unknowns → over all nodes, 3n × k, zero where fixed.
  RowMatrix expand(MatrixIn columns) const {
    RowMatrix full = RowMatrix::Zero(3 * numbering.num_nodes(), columns.cols());
    for (Index v = 0; v < numbering.num_free(); ++v)
      full.middleRows<3>(3 * numbering.free_nodes()[v]) = columns.middleRows<3>(3 * v);
    return full;
  }
  /// And back.
  Matrix restrict(MatrixIn full) const {
    Matrix columns(mass.size(), full.cols());
    for (Index v = 0; v < numbering.num_free(); ++v)
      columns.middleRows<3>(3 * v) = full.middleRows<3>(3 * numbering.free_nodes()[v]);
    return columns;
  }
  /// Masses of all 3n unknowns, fixed ones too.
  Vector mass_of_rows() const { return nodal_mass.replicate(1, 3).transpose().reshaped(); }
};

template <typename System>
requires(System::node_dim == 3) RestState rest_state(const System& system) {
  using Model = std::remove_cvref_t<decltype(system.model())>;
  return {system.rest_stiffness(), system.mass(),
          system.nodal_mass(),     system.model().rest_positions(),
          system.numbering(),      system.stencils(),
          Model::stencil_size,     [&system](VectorIn u, VectorOut f) { system.force(u, f); }};
}

}  // namespace supple
