#pragma once
/// \file Sweep of all components of a model over many poses of a subspace, eight poses at a time.

#include <core/pack.hpp>
#include <core/parallel.hpp>
#include <physics/model/term_pack.hpp>
#include <reduction/subspace/subspace.hpp>

#include <Eigen/StdVector>

#include <atomic>
#include <functional>
#include <memory>
#include <thread>
#include <vector>

namespace supple {

/// Reduced vectors at many poses in the order in which packs read them: p × (block · 8 · number of packs of
/// poses); within a pack of poses first component x, then the pose. Missing poses of the last pack are zero.
template <int block>
RowMatrix pack_poses(MatrixIn Q) {
  const Index p = Q.rows() / block, num_packs = (Q.cols() + Pack::size - 1) / Pack::size;
  RowMatrix packed = RowMatrix::Zero(p, num_packs * block * Pack::size);
  for (Index t = 0; t < Q.cols(); ++t)
    for (Index a = 0; a < p; ++a)
      for (int x = 0; x < block; ++x)
        packed(a, ((t / Pack::size) * block + x) * Pack::size + t % Pack::size) = Q(a * block + x, t);
  return packed;
}
template <int block>
Matrix unpack_poses(const RowMatrix& packed, Index num_poses) {
  Matrix Q(packed.rows() * block, num_poses);
  for (Index t = 0; t < num_poses; ++t)
    for (Index a = 0; a < packed.rows(); ++a)
      for (int x = 0; x < block; ++x)
        Q(a * block + x, t) = packed(a, ((t / Pack::size) * block + x) * Pack::size + t % Pack::size);
  return Q;
}

/// Rows ordered by axes: coordinate x of field a, row a block + x of M, becomes row x p + a of p block rows.
template <int block>
Matrix rows_by_axis(MatrixIn M) {
  Matrix result(M.rows(), M.cols());
  const Index p = M.rows() / block;
  for (int x = 0; x < block; ++x) result.middleRows(x * p, p) = M(Eigen::seqN(x, p, block), Eigen::all);
  return result;
}

/// Doubles aligned for packs.
using AlignedBuffer = std::vector<double, Eigen::aligned_allocator<double>>;

/// Eight displacement fields at once: entry (node · node_dim + x) · 8 + pose.
template <ForceModel Model>
Local<Model::local_dofs, Pack> gather_poses(const Model& model, Index component, const double* fields) {
  Local<Model::local_dofs, Pack> u;
  const std::span<const Index, Model::stencil_size> nodes = model.stencil(component);
  for (int a = 0; a < Model::stencil_size; ++a)
    for (int c = 0; c < Model::node_dim; ++c)
      u[a * Model::node_dim + c] = Pack::load(fields + (nodes[a] * Model::node_dim + c) * Pack::size);
  return u;
}

/// The rows of W that determine component i, relative to its first node if it is translation invariant:
/// num_active_dofs / block rows, p columns.
template <ForceModel Model, Subspace S>
RowMatrix component_rows(const Model& model, const S& subspace, Index i) {
  static_assert(S::block == 1 || S::block == Model::node_dim,
                "the subspace has a structure that the model does not have");
  constexpr int rows_per_node = Model::node_dim / S::block;
  constexpr int first_node = Model::stencil_size - num_active_nodes<Model>;
  const std::span<const Index, Model::stencil_size> nodes = model.stencil(i);
  RowMatrix E(num_active_nodes<Model> * rows_per_node, subspace.num_fields());
  for (int a = 0; a < num_active_nodes<Model>; ++a) {
    E.middleRows(a * rows_per_node, rows_per_node) =
        subspace.W.middleRows(nodes[first_node + a] * rows_per_node, rows_per_node);
    if constexpr (first_node > 0)
      E.middleRows(a * rows_per_node, rows_per_node) -= subspace.W.middleRows(nodes[0] * rows_per_node, rows_per_node);
  }
  return E;
}

/// The rows of a subspace that determine a component, as those of a dense basis: num_active_dofs × d.
template <ForceModel Model, Subspace S>
Matrix dense_component_rows(const Model& model, const S& subspace, Index i) {
  return KroneckerBasis<S::block>{component_rows(model, subspace, i), {}}.dense();
}

/// fields = U q for a pack of eight poses: W times p × (block · 8).
template <Subspace S>
void reconstruct_poses(const S& subspace, const RowMatrix& packed, Index pack, Index begin, Index end, double* fields) {
  constexpr Index width = S::block * Pack::size;
  Eigen::Map<RowMatrix, Eigen::Aligned64>(fields + begin * width, end - begin, width).noalias() =
      subspace.W.middleRows(begin, end - begin) * packed.middleCols(pack * width, width);
}

/// Forces summed over all components and projected, d × T: F̄(q_t) = Uᵀ Σᵢ fᵢ(U q_t) for every column of Q.
/// \note O(T (m + n d)); memory of two fields of eight poses a thread.
template <ForceModel Model, Subspace S>
Matrix reduced_forces(const std::shared_ptr<const Model>& model, const S& subspace, MatrixIn Q,
                      const std::function<void(double)>& tell_share = {}) {
  require_size("Q.rows()", Q.rows(), subspace.dim());
  const RowMatrix packed = pack_poses<S::block>(Q);
  const Index num_packs = (Q.cols() + Pack::size - 1) / Pack::size, m = model->num_components();
  constexpr Index width = S::block * Pack::size;
  RowMatrix result(packed.rows(), packed.cols());
  std::atomic<Index> done{0};
  const auto main_thread = std::this_thread::get_id();
  parallel_for(num_packs, [&](Index pack) {
    AlignedBuffer u(subspace.full_dim() * Pack::size), f(subspace.full_dim() * Pack::size, 0.0);
    reconstruct_poses(subspace, packed, pack, 0, subspace.W.rows(), u.data());
    for (Index i = 0; i < m; ++i) {
      const auto f_i = TermPack<Model>(model, i).force(gather_poses(*model, i, u.data()));
      const std::span<const Index, Model::stencil_size> nodes = model->stencil(i);
      for (int a = 0; a < Model::stencil_size; ++a)
        for (int c = 0; c < Model::node_dim; ++c) {
          double* at = f.data() + (nodes[a] * Model::node_dim + c) * Pack::size;
          (Pack::load(at) + f_i[a * Model::node_dim + c]).store(at);
        }
    }
    result.middleCols(pack * width, width).noalias() =
        subspace.W.transpose() * Eigen::Map<const RowMatrix, Eigen::Aligned64>(f.data(), subspace.W.rows(), width);
    ++done;
    if (tell_share && std::this_thread::get_id() == main_thread) tell_share(static_cast<double>(done) / num_packs);
  });
  return unpack_poses<S::block>(result, Q.cols());
}

/// Number of inverted components (volume ≤ 0) at each pose, T; zeros for models without a volume.
template <ForceModel Model, Subspace S>
std::vector<Index> count_inverted(const std::shared_ptr<const Model>& model, const S& subspace, MatrixIn Q) {
  std::vector<Index> inverted(Q.cols(), 0);
  if constexpr (requires(const TermPack<Model>& terms, const Local<Model::local_dofs, Pack>& u) {
                  terms.jacobian(u);
                }) {
    if constexpr (requires { model->has_jacobian(); })
      if (!model->has_jacobian()) return inverted;
    const RowMatrix packed = pack_poses<S::block>(Q);
    parallel_for((Q.cols() + Pack::size - 1) / Pack::size, [&](Index pack) {
      AlignedBuffer u(subspace.full_dim() * Pack::size);
      reconstruct_poses(subspace, packed, pack, 0, subspace.W.rows(), u.data());
      for (Index i = 0; i < model->num_components(); ++i) {
        const Pack J = TermPack<Model>(model, i).jacobian(gather_poses(*model, i, u.data()));
        for (Index k = 0; k < std::min<Index>(Pack::size, Q.cols() - pack * Pack::size); ++k)
          if (!(J[static_cast<int>(k)] > 0)) ++inverted[pack * Pack::size + k];
      }
    });
  }
  return inverted;
}

}  // namespace supple
