#pragma once
/// \file Subspaces from affine motions blended by smooth weights.

#include <core/checkpoint.hpp>
#include <core/progress.hpp>
#include <physics/system/rest_state.hpp>
#include <reduction/subspace/subspace_builder.hpp>

#include <cstdint>

namespace supple {

/// Scalar fields that vary as slowly as the stiffness lets them: L w = λ M w with L_ab = tr K_ab, the traces
/// of the 3 × 3 blocks of the rest stiffness, so wᵀ L w is the energy of w along x, y and z together.
struct SkinningWeights {
  Matrix W;          ///< n × num_weights, M-orthonormal, zero at fixed nodes; constants on free parts first
  Vector lambda;     ///< ascending [1/s²], zero for each free part
  Vector residuals;  ///< relative, see EigenPairs
};

/// Skinning eigenmodes (Benchekroun, Zhang, Chaudhuri, Grinspun, Zhou, Jacobson 2023, "Fast complementary
/// dynamics via skinning eigenmodes"): every weight blends an affine motion, so the fields w, w X, w Y, w Z
/// span W ⊗ I₃, d = 12 · num_weights less what is linearly dependent. Turns with the object; free parts have
/// all their affine motions. Subspaces of more weights contain those of fewer.
struct SkinningModes {
  Index num_weights = 10;   ///< at least one for each free part. More for motions with finer detail
  double tolerance = 1e-8;  ///< of the weights, relative residual
  std::uint64_t seed = 1;
  Progress progress = {};
  Checkpoint checkpoint = {};  ///< keeps the weights

  /// \throws std::invalid_argument for fewer weights than free parts or more than free nodes; SolverError
  /// when the eigensolver does not converge.
  SkinningWeights weights(const RestState& object) const;

  NodalBasis operator()(const RestState& object) const;
};

static_assert(SubspaceBuilder<SkinningModes>);

}  // namespace supple
