#pragma once
/// \file Vibration modes inside a subspace.

#include <physics/model/force_model.hpp>
#include <physics/system/node_numbering.hpp>
#include <reduction/subspace/subspace.hpp>

#include <optional>

namespace supple {

/// UᵀKU, d × d, for a tangent K over the free unknowns of `system`. \note O(d · nonzeros(K))
template <Subspace S, typename System>
Matrix project_stiffness(const S& subspace, const System& system, const SparseMatrix& K);
/// The same for the stiffness at rest.
template <Subspace S, typename System>
Matrix project_stiffness(const S& subspace, const System& system) {
  return project_stiffness(subspace, system, system.rest_stiffness());
}

/// K̄ φ̄ = ω̄² φ̄ for the reduced stiffness K̄ at rest, which is symmetric (the reduced mass is I). For heat, ω̄² are
/// the rates at which modes decay.
struct ReducedModes {
  Vector omega;        ///< d, ascending [rad/s]
  Matrix Phi;          ///< d × d, orthonormal
  Index num_zero = 0;  ///< leading modes without energy (rigid motions)

  /// ω̄ with the energy-free modes given the lowest frequency that is not zero, so that it can be divided by.
  Vector positive_omega() const;
  /// The lowest eigenvalue that is not zero [1/s²].
  double softest_stiffness() const;
};
/// \param num_zero  how many motions have no energy, where that is known. Otherwise those count with ω̄ up to 1e-5 of the
/// largest and ω̄² up to 1e-3 of the one that follows them: the soft part of a very stiff object lies low, but not alone.
ReducedModes reduced_modes(const Matrix& reduced_stiffness, std::optional<Index> num_zero = {});

// ---------------------------------------------------------------------------------------------------------------------

template <Subspace S, typename System>
Matrix project_stiffness(const S& subspace, const System& system, const SparseMatrix& K) {
  constexpr int block = S::block;
  require_size("subspace.full_dim()", subspace.full_dim(), system.num_nodes() * System::node_dim);
  const NodeNumbering& numbering = system.numbering();
  const auto full_dof = [&](Index i) {
    return numbering.free_nodes()[i / System::node_dim] * System::node_dim + i % System::node_dim;
  };
  const Index p = subspace.num_fields(), dim = K.cols(), pieces = 16;
  std::vector<Matrix> partial(pieces);
  parallel_for(pieces, [&](Index piece) {
    constexpr Index at_once = 192 * block;  // a multiple of block, so that rows of K come in whole blocks
    Matrix& sum = partial[piece] = Matrix::Zero(p * block, p * block);  // block (x, y) of p × p: fields a, b
    const Index blocks = dim / block, begin = blocks * piece / pieces * block,
                end = blocks * (piece + 1) / pieces * block;
    for (Index first = begin; first < end; first += at_once) {
      const Index count = std::min(at_once, end - first);
      RowMatrix W(count / block, p),
          KU = RowMatrix::Zero(count, block * p);  // row i: Σ_j K_ij W_j, sorted by axis of j
      for (Index r = 0; r < count / block; ++r) W.row(r) = subspace.W.row(full_dof(first + r * block) / block);
      for (Index i = 0; i < count; ++i)
        for (SparseMatrix::InnerIterator it(K, first + i); it; ++it) {  // a column of K is a row
          const Index dof = full_dof(it.row());
          KU.row(i).segment(dof % block * p, p) += it.value() * subspace.W.row(dof / block);
        }
      for (int x = 0; x < block; ++x)
        sum.middleRows(x * p, p).noalias() += W.transpose() * Eigen::Map<const RowMatrix, 0, Eigen::OuterStride<>>(
                                                                  KU.data() + x * KU.cols(), count / block, KU.cols(),
                                                                  Eigen::OuterStride<>(block * KU.cols()));
    }
  });
  Matrix sum = Matrix::Zero(p * block, p * block), result(p * block, p * block);
  for (const Matrix& part : partial) sum += part;
  for (Index b = 0; b < p; ++b)
    for (int y = 0; y < block; ++y)
      for (Index a = 0; a < p; ++a)
        for (int x = 0; x < block; ++x) result(a * block + x, b * block + y) = sum(x * p + a, y * p + b);
  if constexpr (has_symmetric_tangent<System>()) return 0.5 * (result + result.transpose());
  return result.transpose();  // columns of K were read as rows
}

}  // namespace supple
