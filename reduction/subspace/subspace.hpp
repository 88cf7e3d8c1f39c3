#pragma once
/// \file Subspaces of displacements u = U q.

#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/types.hpp>

#include <concepts>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace supple {

/// What the construction of a subspace has to say.
struct SubspaceReport {
  Vector omega;           ///< angular frequencies of the modes it was made from [rad/s], rigid ones first; may be none
  Vector residuals;       ///< relative residuals of these modes, in the same order
  Index rigid_modes = 0;  ///< how many of them are rigid motions
  Index zero_modes = 0;   ///< how many of them have no energy: rigid motions, and those of hinges
  Index dropped = 0;      ///< linearly dependent vectors that were left out
  std::vector<std::string> notes;  ///< what a user should know: missing or surplus rigid modes, …
  /// Of the principal component analysis that chose the columns, descending; none if there was none.
  Vector singular_values = {};

  /// The number of motions without energy in the subspace, known if a mode with energy follows them.
  std::optional<Index> known_zero_modes() const {
    return zero_modes < omega.size() ? std::optional(zero_modes) : std::nullopt;
  }
};

/// A subspace spanned by U = W ⊗ I_block: every scalar field, a column of W, acts on `block` components
/// alike. Block 3 is the structure of affine fields, extended modal bases and skinning modes; block 1 is any
/// dense U. Vectors over the mesh are interleaved and cover all nodes, fixed ones with zeros: row (v, x) of U
/// reads row ⌊(v·node_dim + x) / block⌋ of W; q is interleaved alike. UᵀMU = I for the mass matrix of the
/// system it was built for.
template <int block_size>
struct KroneckerBasis {
  static constexpr int block = block_size;

  RowMatrix W;  ///< (n · node_dim / block) × (d / block)
  SubspaceReport report;

  Index dim() const { return W.cols() * block; }       ///< d
  Index full_dim() const { return W.rows() * block; }  ///< n · node_dim
  Index num_fields() const { return W.cols(); }        ///< p = d / block

  /// u = U q.
  void reconstruct(VectorIn q, VectorOut u) const {
    require_size("q", q.size(), dim());
    require_size("u", u.size(), full_dim());
    const Eigen::Map<const Fields> fields(q.data(), num_fields(), block);
    Eigen::Map<Fields> nodes(u.data(), W.rows(), block);
    parallel_ranges(W.rows(), 16384, [&](Index begin, Index end) {
      nodes.middleRows(begin, end - begin).noalias() = W.middleRows(begin, end - begin) * fields;
    });
  }
  Vector reconstruct(VectorIn q) const {
    Vector u(full_dim());
    reconstruct(q, u);
    return u;
  }

  /// Uᵀ f.
  Vector project(VectorIn f) const {
    require_size("f", f.size(), full_dim());
    Vector result(dim());
    Eigen::Map<Fields>(result.data(), num_fields(), block).noalias() =
        W.transpose() * Eigen::Map<const Fields>(f.data(), W.rows(), block);
    return result;
  }

  /// result += scale · (row `dof` of U)ᵀ: what a unit force on one unknown of the mesh does.
  void add_row(Index dof, double scale, VectorOut result) const {
    Eigen::Map<Fields>(result.data(), num_fields(), block).col(dof % block) += scale * W.row(dof / block).transpose();
  }
  /// (U q) at one unknown of the mesh.
  double at(Index dof, VectorIn q) const {
    return W.row(dof / block) * Eigen::Map<const Fields>(q.data(), num_fields(), block).col(dof % block);
  }

  /// U itself, full_dim × d; for tests and small meshes.
  Matrix dense() const {
    Matrix U = Matrix::Zero(full_dim(), dim());
    for (Index r = 0; r < W.rows(); ++r)
      for (Index c = 0; c < W.cols(); ++c)
        for (int x = 0; x < block; ++x) U(r * block + x, c * block + x) = W(r, c);
    return U;
  }

  /// A vector over fields, seen as num_fields × block.
  using Fields = std::conditional_t<block == 1, Matrix,
                                    Eigen::Matrix<double, Eigen::Dynamic, block == 1 ? 2 : block, Eigen::RowMajor>>;
};

using DenseBasis = KroneckerBasis<1>;
using NodalBasis = KroneckerBasis<3>;

/// A basis whose structure is known at run time.
using AnyBasis = std::variant<std::shared_ptr<const NodalBasis>, std::shared_ptr<const DenseBasis>>;

/// A subspace u = U q with U = W ⊗ I_block, as training, fitting and simulation see it: KroneckerBasis, or a structure of
/// one's own with these members. It also promises that they agree: all of them are views of one U.
template <typename S>
concept Subspace = requires(const S& subspace, VectorIn vector, VectorOut sum, Index dof) {
  requires S::block == 1 || S::block == 3;
  { subspace.W } -> std::convertible_to<const RowMatrix&>;  // (n · node_dim / block) × (d / block)
  { subspace.report } -> std::convertible_to<const SubspaceReport&>;
  { subspace.dim() } -> std::convertible_to<Index>;                 // d
  { subspace.full_dim() } -> std::convertible_to<Index>;            // n · node_dim
  { subspace.num_fields() } -> std::convertible_to<Index>;          // d / block
  { subspace.reconstruct(vector) } -> std::convertible_to<Vector>;  // U q
  { subspace.project(vector) } -> std::convertible_to<Vector>;      // Uᵀ f
  { subspace.at(dof, vector) } -> std::convertible_to<double>;      // (U q) at one unknown of the mesh
  subspace.add_row(dof, 1.0, sum);                                  // sum += 1.0 · row `dof` of U
};

static_assert(Subspace<DenseBasis> && Subspace<NodalBasis>);

/// M-orthonormal columns with the same span as those of W, in the order given; a column whose part outside
/// the span of the earlier ones is below `tolerance` of its length is dropped. \param mass  weight of each
/// row, > 0 where W is not zero; zero rows stay zero. \note O(rows · cols²), in parallel with fixed bits
struct Orthonormalized {
  RowMatrix W;
  Index dropped = 0;
};
Orthonormalized mass_orthonormalize(const RowMatrix& W, VectorIn mass, double tolerance = 1e-6);

}  // namespace supple
