#pragma once
/// \file Subspaces from observed displacements, or temperatures.

#include <physics/system/rest_state.hpp>
#include <reduction/subspace/subspace_builder.hpp>

namespace supple {

/// The d-dimensional subspace closest to given states: Σ_t ‖u_t − U Uᵀ M u_t‖²_M is smallest
/// (principal component analysis about the rest state; Krysl, Lall & Marsden 2001). By QR and SVD, so small
/// components keep their digits. d ends at the first of these: `dimension`, the `energy` share, the rank of
/// the snapshots (singular values above 1e-12 of the largest).
struct PcaBasis {
  Matrix snapshots;     ///< n · node_dim × T displacements (temperatures) of all nodes [m] ([K]), zero at fixed nodes
  Index dimension = 0;  ///< 0: no bound
  double energy = 1;    ///< share of Σ_t ‖u_t‖²_M that the subspace has to hold, in (0, 1]; 0.9999 leaves 1 % rms

  /// \return report.singular_values are all min(n · node_dim, T) [m √kg]; `dropped` counts snapshots that bring no dimension,
  /// and a note those of them that are no zeros but too small.
  /// \throws std::invalid_argument if snapshots do not fit the system, are not finite or all zero, or move
  /// fixed nodes; for a negative dimension or another share.
  DenseBasis operator()(const RestState& object) const;
};

static_assert(SubspaceBuilder<PcaBasis>);

}  // namespace supple
