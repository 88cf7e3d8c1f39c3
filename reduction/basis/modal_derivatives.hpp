#pragma once
/// \file Modal derivatives, by which vibration modes change as the object deforms: subspaces for large deformations.

#include <physics/system/rest_state.hpp>
#include <reduction/basis/modal_basis.hpp>

#include <array>

namespace supple {

/// θ_ij = −K⁻¹ H(φ_i, φ_j) with the second derivative H of the internal force at rest (see ForceCurvature):
/// the static response u(s, t) to the load K (s φ_i + t φ_j) is s φ_i + t φ_j + ½ s² θ_ii + s t θ_ij +
/// ½ t² θ_jj + … Symmetric in i and j. Where motions without energy exist, loads and θ_ij are taken
/// M-orthogonal to them.
struct ModalDerivativeVectors {
  Matrix vectors;                           ///< 3n × r (r + 1) / 2, zero at fixed nodes [1/kg, as φ φ]
  std::vector<std::array<Index, 2>> pairs;  ///< (i, j), i ≤ j, of each column: columns of modes.vectors
  double residual = 0;                      ///< largest ‖K θ + H‖ / ‖H‖
};

/// The derivatives of all modes with energy. One factorisation, and for each of r (r + 1) / 2 pairs a solve with refinement
/// and four evaluations of the force; equal bits for any num_threads().
/// \param num_pairs  only of so many, those with the smallest λ_i λ_j; 0: of all.
/// \throws SolverError if K is not positive semi-definite, or a residual cannot be made small.
ModalDerivativeVectors modal_derivatives(const RestState& object, const VibrationModes& modes, double tolerance = 1e-8,
                                         const Progress& progress = {}, Index num_pairs = 0);

/// Linear modes and their modal derivatives (Idelsohn & Cardona 1985; Barbič & James 2005): r modes give up
/// to r (r + 3) / 2 dimensions, free parts six more each.
struct ModalDerivatives {
  Index num_modes = 15;  ///< r, beside the rigid ones; 10 to 20. The derivatives grow as r²
  /// d, rigid motions and modes included; 0: all derivatives. Fewer are the leading principal components of
  /// what the derivatives add to the modes, in the mass norm, with θ_ij weighted by λ₁² / (λ_i λ_j), λ = ω²:
  /// the spread of a response to loads that excite low frequencies most. Subspaces of growing d are nested.
  Index dimension = 0;
  Index num_derivatives = 0;  ///< where `dimension` is 0: of these components, whatever else there is; 0: all
  /// Derivatives computed: of the pairs of modes with the largest weights; 0: of twice `num_derivatives`, or of all.
  Index num_pairs = 0;
  bool affine_fields = false;          ///< free parts bring all 12 affine motions instead of the 6 rigid ones
  double tolerance = 1e-8;             ///< of modes, relative residuals
  double derivative_tolerance = 1e-5;  ///< of derivatives, ‖K θ + H‖ / ‖H‖
  std::uint64_t seed = 1;
  Progress progress = {};
  Checkpoint checkpoint = {};  ///< keeps the modes and the basis

  /// \throws std::invalid_argument if `dimension` has no room for the modes.
  DenseBasis operator()(const RestState& object) const;

 private:
  DenseBasis with_derivatives(const RestState& object, const VibrationModes& modes) const;
};

static_assert(SubspaceBuilder<ModalDerivatives>);

}  // namespace supple
