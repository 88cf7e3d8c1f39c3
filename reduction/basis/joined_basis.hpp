#pragma once
/// \file Sum of two subspaces.

#include <reduction/basis/affine_basis.hpp>
#include <reduction/basis/modal_basis.hpp>

#include <type_traits>

namespace supple {

/// W ⊗ I_block if both have that structure, else dense.
template <Subspace A, Subspace B>
using JoinedSubspace = KroneckerBasis<A::block == B::block ? A::block : 1>;

/// The subspace that both span, M-orthonormal: first the columns of `first`, then what `second` adds.
/// Dependent directions are dropped, and counted as the caller sees them, in columns of U. The report has the
/// modes of the one that was made from more of them, `first` if in doubt.
template <Subspace A, Subspace B>
JoinedSubspace<A, B> join(const A& first, const B& second, const Vector& nodal_mass) {
  constexpr int block = JoinedSubspace<A, B>::block;
  require_size("second.full_dim()", second.full_dim(), first.full_dim());
  const auto fields = [](const auto& basis) -> RowMatrix {
    if constexpr (std::remove_cvref_t<decltype(basis)>::block == block)
      return basis.W;
    else
      return basis.dense();
  };
  const RowMatrix W_first = fields(first), W_second = fields(second);
  RowMatrix both(W_first.rows(), W_first.cols() + W_second.cols());
  both << W_first, W_second;
  const Index rows_of_node = both.rows() / nodal_mass.size();
  require_size("nodal_mass", nodal_mass.size() * rows_of_node, both.rows());
  const Vector mass = nodal_mass.replicate(1, rows_of_node).transpose().reshaped();
  Orthonormalized joined = mass_orthonormalize(both, mass);

  SubspaceReport report = first.report;
  if (second.report.omega.size() > first.report.omega.size()) {
    report.omega = second.report.omega;
    report.residuals = second.report.residuals;
    report.rigid_modes = second.report.rigid_modes;
    report.zero_modes = second.report.zero_modes;
  }
  report.dropped += second.report.dropped + block * joined.dropped;
  report.notes.insert(report.notes.end(), second.report.notes.begin(), second.report.notes.end());
  return {std::move(joined.W), std::move(report)};
}

/// What two builders span together: JoinedBasis{ModalBasis{.num_modes = 20}, AffineBasis{}}. Builders may be
/// joined ones themselves.
template <SubspaceBuilder First, SubspaceBuilder Second>
struct JoinedBasis {
  First first;
  Second second;

  auto operator()(const RestState& object) const { return join(first(object), second(object), object.nodal_mass); }
};
template <typename First, typename Second>
JoinedBasis(First, Second) -> JoinedBasis<First, Second>;

static_assert(SubspaceBuilder<JoinedBasis<ModalBasis, AffineBasis>> &&
              SubspaceBuilder<JoinedBasis<AffineBasis, JoinedBasis<ExtendedModalBasis, AffineBasis>>>);

}  // namespace supple
