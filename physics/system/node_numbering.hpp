#pragma once
/// \file Numbering of free nodes, axes that supports hold, components at each node, and the sparsity pattern that follows.

#include <core/types.hpp>
#include <physics/system/held_axes.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace supple {

/// Free nodes in ascending order are numbered 0 … num_free − 1; fixed nodes have no number. A free node that slides, held
/// along one or two axes, keeps an unknown for each of its axes; those of held ones are zero in every state.
class NodeNumbering {
 public:
  /// \param held_axes  of nodes that slide; what they say of fixed nodes changes nothing.
  /// \throws std::invalid_argument for a node outside 0 … num_nodes − 1, other axes than there are, or when nothing can move.
  NodeNumbering(Index num_nodes, const std::vector<Index>& fixed_nodes, const std::vector<HeldAxes>& held_axes = {});

  Index num_nodes() const { return static_cast<Index>(free_index_.size()); }
  Index num_free() const { return static_cast<Index>(free_nodes_.size()); }
  Index free_index(Index node) const { return free_index_[node]; }  ///< −1: fixed
  const std::vector<Index>& free_nodes() const { return free_nodes_; }
  std::vector<Index> fixed_nodes() const;
  /// Unknowns that supports hold, 3 f + axis of free node f, ascending.
  const std::vector<Index>& held_unknowns() const { return held_unknowns_; }

  /// Unknowns → values at all nodes, zero where held, and back. Only nodes with three unknowns slide.
  Vector expand(VectorIn free, int node_dim) const;
  Vector restrict(VectorIn full, int node_dim) const;

 private:
  std::vector<Index> free_index_, free_nodes_, held_unknowns_;
};

/// For each node the places where it occurs in the stencils: component · stencil_size + corner, ascending.
class NodeIncidence {
 public:
  NodeIncidence() = default;
  NodeIncidence(const std::vector<Index>& stencils, Index stencil_size, Index num_nodes);

  std::span<const Index> of(Index node) const {
    return {slots_.data() + first_[node], static_cast<std::size_t>(first_[node + 1] - first_[node])};
  }

 private:
  std::vector<Index> first_, slots_;
};

/// Sparsity pattern of a stiffness matrix, analysed once: dense node_dim × node_dim blocks between free nodes
/// that share a component; and where in it the entries of each component go.
class NodeBlockPattern {
 public:
  NodeBlockPattern(const NodeNumbering& numbering, Index node_dim) : numbering_(numbering), node_dim_(node_dim) {}
  void build(const std::vector<Index>& stencils, Index stencil_size, const NodeIncidence& incidence);

  Index num_nonzeros() const { return node_dim_ * node_dim_ * static_cast<Index>(neighbors_.size()); }
  SparseMatrix zero_matrix() const;

  /// Adds the local matrices of components begin … end − 1 (in packs of eight, local_dofs² packs each, by
  /// columns) to `values`, but only columns of nodes that belong to `owner` of `owners`.
  void scatter(Index owner, Index owners, Index begin, Index end, const double* packed, double* values) const;

 private:
  NodeNumbering numbering_;
  Index node_dim_;
  Index stencil_size_ = 0;
  std::vector<Index> first_;               // of each free node's list in neighbors_
  std::vector<std::int32_t> neighbors_;    // free numbers, ascending
  std::vector<std::int32_t> column_node_;  // per component and corner: free number or −1
  std::vector<std::int32_t> block_;  // per component, column corner, row corner: place in the neighbour list, or −1
};

}  // namespace supple
