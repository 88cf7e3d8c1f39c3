#pragma once
/// \file Subspaces from linear vibration modes: the modes themselves, and the modes extended by linear maps.

#include <core/checkpoint.hpp>
#include <core/progress.hpp>
#include <numerics/eigen/eigensolver.hpp>
#include <reduction/subspace/rigid_modes.hpp>
#include <reduction/subspace/subspace_builder.hpp>

namespace supple {

/// The lowest modes of K φ = ω² M φ of a system, over all nodes.
struct VibrationModes {
  Matrix vectors;    ///< n · node_dim × r, M-orthonormal, rigid modes first, zero at fixed nodes
  Vector omega;      ///< [rad/s]
  Vector residuals;  ///< relative, see EigenPairs
  FreeComponents components;
  Index num_rigid = 0;
  Index num_zero = 0;  ///< leading modes without energy: rigid ones and hinges
  std::vector<std::string> notes;

  /// Of a subspace that is made from them.
  SubspaceReport report() const { return {omega, residuals, num_rigid, num_zero, 0, notes}; }
};

struct ModeOptions {
  Index num_modes = 15;     ///< rigid ones included, as the paper counts
  double tolerance = 1e-8;  ///< relative residual of each pair
  std::uint64_t seed = 1;
  Progress progress = {};
  Checkpoint checkpoint = {};  ///< keeps the pairs
};

/// Where the object does not know its positions, rigid modes are not known beforehand and have to be found.
/// \throws SolverError when the eigensolver does not converge; std::invalid_argument for more modes than
/// unknowns.
VibrationModes vibration_modes(const RestState& object, const ModeOptions& options);

/// The linear modes, nothing else: d = num_modes. For heat, the fields that decay slowest, with rates ω².
struct ModalBasis {
  Index num_modes = 15;
  double tolerance = 1e-8;
  std::uint64_t seed = 1;
  Progress progress = {};
  Checkpoint checkpoint = {};  ///< keeps the modes

  DenseBasis operator()(const RestState& object) const {
    const VibrationModes modes = vibration_modes(object, {num_modes, tolerance, seed, progress, checkpoint});
    return {modes.vectors, modes.report()};
  }
};

/// Modes under all linear maps of ℝ³ (Sec. 5, Alg. 2). Applying the nine matrices B_kl to a mode spans its
/// x-, y- and z-part as scalar fields, times I₃; so the basis is W ⊗ I₃ with three fields a mode. Each free
/// component of the object contributes the fields 1, X, Y, Z, its affine motions, instead of its six rigid
/// modes. d = 9 r for a held object, 9 (r − 6) + 12 for a free one, less what is linearly dependent.
NodalBasis extend_modes(const VibrationModes& modes, const Points& rest_positions, const Vector& nodal_mass);

struct ExtendedModalBasis {
  Index num_modes = 15;     ///< r, rigid ones included; 15 to 20 in the paper. More for motions with finer detail
  double tolerance = 1e-8;  ///< of the modes
  std::uint64_t seed = 1;
  Progress progress = {};
  Checkpoint checkpoint = {};  ///< keeps the modes

  /// \throws std::invalid_argument for an object that is not in ℝ³.
  NodalBasis operator()(const RestState& object) const {
    object.require_space();
    return extend_modes(vibration_modes(object, {num_modes, tolerance, seed, progress, checkpoint}), object.positions,
                        object.nodal_mass);
  }
};

static_assert(SubspaceBuilder<ModalBasis> && SubspaceBuilder<ExtendedModalBasis>);

}  // namespace supple
