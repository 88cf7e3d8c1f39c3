#pragma once
/// \file Object at rest, as the construction of subspaces sees it.

#include <core/check.hpp>
#include <core/types.hpp>
#include <physics/system/node_numbering.hpp>

#include <functional>
#include <span>

namespace supple {

/// What subspaces are made from, whatever the force model: matrices, masses, positions and stencils. A FullSystem converts
/// to it; it refers to that system, which must outlive it.
struct RestState {
  const SparseMatrix& K;     ///< at rest, over the free unknowns [N/m]
  const Vector& mass;        ///< of the free unknowns [kg]
  const Vector& nodal_mass;  ///< n [kg]
  const Points& positions;   ///< n × 3 [m]; no rows where the force model does not know them
  const NodeNumbering& numbering;
  std::span<const Index> stencils;
  Index stencil_size;
  Index node_dim;  ///< unknowns of a node
  /// Of many states over the free unknowns, a column each; safe from several threads.
  std::function<void(MatrixIn U, MatrixOut F)> forces;

  /// Columns over the free unknowns → over all nodes, n · node_dim × k, zero where fixed.
  RowMatrix expand(MatrixIn columns) const {
    RowMatrix full = RowMatrix::Zero(node_dim * numbering.num_nodes(), columns.cols());
    for (Index v = 0; v < numbering.num_free(); ++v)
      full.middleRows(node_dim * numbering.free_nodes()[v], node_dim) = columns.middleRows(node_dim * v, node_dim);
    for (const Index i : numbering.held_unknowns()) full.row(3 * numbering.free_nodes()[i / 3] + i % 3).setZero();
    return full;
  }
  /// And back.
  Matrix restrict(MatrixIn full) const {
    Matrix columns(mass.size(), full.cols());
    for (Index v = 0; v < numbering.num_free(); ++v)
      columns.middleRows(node_dim * v, node_dim) = full.middleRows(node_dim * numbering.free_nodes()[v], node_dim);
    for (const Index i : numbering.held_unknowns()) columns.row(i).setZero();
    return columns;
  }
  /// \throws std::invalid_argument unless the object is in ℝ³ and knows where its nodes are.
  void require_space() const {
    require(node_dim == 3 && positions.rows() == numbering.num_nodes(),
            "this subspace is for objects in space whose force model has rest_positions()");
  }
  /// Masses of all n · node_dim unknowns, fixed ones too.
  Vector mass_of_rows() const { return nodal_mass.replicate(1, node_dim).transpose().reshaped(); }
};

}  // namespace supple
