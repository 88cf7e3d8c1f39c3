#include <core/check.hpp>
#include <core/pack.hpp>
#include <core/parallel.hpp>
#include <physics/system/node_numbering.hpp>

#include <algorithm>

namespace supple {

NodeNumbering::NodeNumbering(Index num_nodes, const std::vector<Index>& fixed_nodes,
                             const std::vector<HeldAxes>& held_axes)
    : free_index_(num_nodes, 0) {
  for (const Index v : fixed_nodes) {
    require(v >= 0 && v < num_nodes,
            "fixed node " + std::to_string(v) + " does not exist, expected 0 to " + std::to_string(num_nodes - 1));
    free_index_[v] = -1;
  }
  for (Index v = 0; v < num_nodes; ++v)
    if (free_index_[v] == 0) {
      free_index_[v] = num_free();
      free_nodes_.push_back(v);
    }
  for (const auto& [v, axes] : held_axes) {
    require(v >= 0 && v < num_nodes,
            "held node " + std::to_string(v) + " does not exist, expected 0 to " + std::to_string(num_nodes - 1));
    require(axes >= 1 && axes <= HeldAxes::all, "axes of node " + std::to_string(v) + " are " + std::to_string(axes) +
                                                    ", expected a sum of 1, 2 and 4 for x, y and z");
    if (free_index_[v] < 0) continue;
    for (int c = 0; c < 3; ++c)
      if (axes >> c & 1) held_unknowns_.push_back(3 * free_index_[v] + c);
  }
  std::ranges::sort(held_unknowns_);
  held_unknowns_.erase(std::unique(held_unknowns_.begin(), held_unknowns_.end()), held_unknowns_.end());
  require(static_cast<Index>(held_unknowns_.size()) < 3 * num_free(), "all nodes are fixed, nothing can move");
}

std::vector<Index> NodeNumbering::fixed_nodes() const {
  std::vector<Index> fixed;
  for (Index v = 0; v < num_nodes(); ++v)
    if (free_index_[v] < 0) fixed.push_back(v);
  return fixed;
}

Vector NodeNumbering::expand(VectorIn free, int node_dim) const {
  require_size("u", free.size(), num_free() * node_dim);
  if (num_free() == num_nodes() && held_unknowns_.empty()) return free;
  Vector full = Vector::Zero(num_nodes() * node_dim);
  for (Index f = 0; f < num_free(); ++f)
    full.segment(free_nodes_[f] * node_dim, node_dim) = free.segment(f * node_dim, node_dim);
  for (const Index i : held_unknowns_) full[3 * free_nodes_[i / 3] + i % 3] = 0;
  return full;
}

Vector NodeNumbering::restrict(VectorIn full, int node_dim) const {
  require_size("the vector over all nodes", full.size(), num_nodes() * node_dim);
  if (num_free() == num_nodes() && held_unknowns_.empty()) return full;
  Vector free(num_free() * node_dim);
  for (Index f = 0; f < num_free(); ++f)
    free.segment(f * node_dim, node_dim) = full.segment(free_nodes_[f] * node_dim, node_dim);
  for (const Index i : held_unknowns_) free[i] = 0;
  return free;
}

NodeIncidence::NodeIncidence(const std::vector<Index>& stencils, Index stencil_size, Index num_nodes)
    : first_(num_nodes + 1, 0), slots_(stencils.size()) {
  for (std::size_t slot = 0; slot < stencils.size(); ++slot) {
    const Index v = stencils[slot];
    require(v >= 0 && v < num_nodes, "component " + std::to_string(slot / stencil_size) + " names node " +
                                         std::to_string(v) + ", expected 0 to " + std::to_string(num_nodes - 1));
    ++first_[v + 1];
  }
  for (Index v = 0; v < num_nodes; ++v) first_[v + 1] += first_[v];
  std::vector<Index> next(first_.begin(), first_.end() - 1);
  for (std::size_t slot = 0; slot < stencils.size(); ++slot) slots_[next[stencils[slot]]++] = static_cast<Index>(slot);
}

void NodeBlockPattern::build(const std::vector<Index>& stencils, Index stencil_size, const NodeIncidence& incidence) {
  stencil_size_ = stencil_size;
  const Index num_free = numbering_.num_free();
  std::vector<std::vector<std::int32_t>> lists(num_free);
  parallel_ranges(num_free, 1024, [&](Index begin, Index end) {
    for (Index f = begin; f < end; ++f) {
      std::vector<std::int32_t>& list = lists[f];
      list.push_back(static_cast<std::int32_t>(f));  // the diagonal exists even for a node without components
      for (const Index slot : incidence.of(numbering_.free_nodes()[f])) {
        const Index* nodes = stencils.data() + slot / stencil_size * stencil_size;
        for (Index b = 0; b < stencil_size; ++b)
          if (const Index g = numbering_.free_index(nodes[b]); g >= 0) list.push_back(static_cast<std::int32_t>(g));
      }
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
  });
  first_.assign(num_free + 1, 0);
  for (Index f = 0; f < num_free; ++f) first_[f + 1] = first_[f] + static_cast<Index>(lists[f].size());
  require(first_[num_free] * node_dim_ * node_dim_ < std::numeric_limits<int>::max(),
          "the stiffness matrix has more than 2^31 nonzeros");
  neighbors_.reserve(first_[num_free]);
  for (const auto& list : lists) neighbors_.insert(neighbors_.end(), list.begin(), list.end());

  const Index m = static_cast<Index>(stencils.size()) / stencil_size;
  column_node_.resize(stencils.size());
  block_.resize(stencils.size() * stencil_size);
  parallel_ranges(m, 4096, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      const Index* nodes = stencils.data() + i * stencil_size;
      for (Index a = 0; a < stencil_size; ++a) {
        const Index column = numbering_.free_index(nodes[a]);
        column_node_[i * stencil_size + a] = static_cast<std::int32_t>(column);
        for (Index b = 0; b < stencil_size; ++b) {
          const Index row = numbering_.free_index(nodes[b]);
          std::int32_t place = -1;
          if (column >= 0 && row >= 0) {
            const auto list_begin = neighbors_.begin() + first_[column];
            place = static_cast<std::int32_t>(
                std::lower_bound(list_begin, neighbors_.begin() + first_[column + 1], static_cast<std::int32_t>(row)) -
                list_begin);
          }
          block_[(i * stencil_size + a) * stencil_size + b] = place;
        }
      }
    }
  });
}

SparseMatrix NodeBlockPattern::zero_matrix() const {
  const Index num_free = numbering_.num_free(), dim = num_free * node_dim_;
  SparseMatrix K(dim, dim);
  K.resizeNonZeros(num_nonzeros());
  int* outer = K.outerIndexPtr();
  int* inner = K.innerIndexPtr();
  outer[0] = 0;
  for (Index f = 0; f < num_free; ++f) {
    const Index count = first_[f + 1] - first_[f];
    for (Index c = 0; c < node_dim_; ++c) {
      const Index column = f * node_dim_ + c;
      int* at = inner + outer[column];
      for (Index k = 0; k < count; ++k)
        for (Index r = 0; r < node_dim_; ++r) *at++ = static_cast<int>(neighbors_[first_[f] + k] * node_dim_ + r);
      outer[column + 1] = outer[column] + static_cast<int>(count * node_dim_);
    }
  }
  std::fill_n(K.valuePtr(), K.nonZeros(), 0.0);
  return K;
}

void NodeBlockPattern::scatter(Index owner, Index owners, Index begin, Index end, const double* packed,
                               double* values) const {
  const Index local_dofs = stencil_size_ * node_dim_;
  const Index first_own = numbering_.num_free() * owner / owners,
              last_own = numbering_.num_free() * (owner + 1) / owners;
  for (Index i = begin; i < end; ++i) {
    const Index j = i - begin;
    const double* local = packed + j / Pack::size * local_dofs * local_dofs * Pack::size + j % Pack::size;
    for (Index a = 0; a < stencil_size_; ++a) {
      const Index f = column_node_[i * stencil_size_ + a];
      if (f < first_own || f >= last_own) continue;
      const Index count = first_[f + 1] - first_[f];
      double* block_column = values + node_dim_ * node_dim_ * first_[f];
      for (Index b = 0; b < stencil_size_; ++b) {
        const Index place = block_[(i * stencil_size_ + a) * stencil_size_ + b];
        if (place < 0) continue;
        for (Index c = 0; c < node_dim_; ++c)
          for (Index r = 0; r < node_dim_; ++r)
            block_column[c * count * node_dim_ + place * node_dim_ + r] +=
                local[((a * node_dim_ + c) * local_dofs + b * node_dim_ + r) * Pack::size];
      }
    }
  }
}

}  // namespace supple
