#pragma once
/// \file Subspaces by name, for commands and comparisons.

#include <reduction/modal_derivatives.hpp>
#include <reduction/pca_basis.hpp>
#include <reduction/skinning_modes.hpp>

#include <memory>
#include <string>
#include <vector>

namespace supple {

/// A subspace as words and numbers tell it.
struct SubspaceChoice {
  std::string name = "extended";  ///< one of known_subspaces()
  Index modes = 15;               ///< vibration modes, rigid ones included; of "derivatives" the flexible ones
  Index dimension = 0;            ///< d to aim at, where the modes leave a choice; 0: what they give
  Matrix snapshots = {};          ///< 3n × T displacements [m], for "pca"
  double tolerance = 1e-8;        ///< of modes, relative residual
  std::uint64_t seed = 1;
};

///   "extended"     modes under all linear maps (Alg. 2)
///   "modal"        the linear modes alone; `dimension` of them, if that is given
///   "derivatives"  modes, the affine fields of free parts, and the best of the modes' derivatives
///   "skinning"     skinning eigenmodes, as many weights as fit in `dimension`; else (modes + 1) / 2
///   "pca"          principal components of the snapshots
const std::vector<std::string>& known_subspaces();

/// \throws std::invalid_argument for an unknown name, a negative dimension, or "pca" without snapshots.
void check(const SubspaceChoice& choice);

/// Number of weights of the skinning modes of a choice.
Index skinning_weights(const SubspaceChoice& choice);

/// Calls visit(subspace) with a shared pointer to a NodalBasis or a DenseBasis of the system.
/// \param stage  runs a named stage: stage("vibration modes", [](auto share) { … }).
template <typename System, typename Stage, typename Visitor>
void with_subspace(const System& system, const SubspaceChoice& choice, const Progress& progress, Stage&& stage,
                   Visitor&& visit) {
  const auto share = [](auto&& basis) {
    using Basis = std::remove_cvref_t<decltype(basis)>;
    return std::make_shared<const Basis>(std::forward<decltype(basis)>(basis));
  };
  const auto modes = [&](Index count) {
    return stage("vibration modes", [&](auto) {
      return vibration_modes(
          system, {.num_modes = count, .tolerance = choice.tolerance, .seed = choice.seed, .progress = progress});
    });
  };
  if (choice.name == "extended") {
    const VibrationModes vibration = modes(choice.modes);
    visit(stage("subspace", [&](auto) {
      return share(extend_modes(vibration, system.model().rest_positions(), system.nodal_mass()));
    }));
  } else if (choice.name == "modal") {
    VibrationModes vibration = modes(choice.dimension > 0 ? choice.dimension : choice.modes);
    visit(share(DenseBasis{std::move(vibration.vectors),
                           {vibration.omega, vibration.residuals, vibration.num_rigid, 0, vibration.notes}}));
  } else if (choice.name == "derivatives") {
    visit(stage("modes and derivatives", [&](auto) {
      return share(ModalDerivatives{.num_modes = choice.modes,
                                    .dimension = choice.dimension,
                                    .affine_fields = true,
                                    .tolerance = choice.tolerance,
                                    .seed = choice.seed,
                                    .progress = progress}(system));
    }));
  } else if (choice.name == "skinning") {
    visit(stage("skinning modes", [&](auto) {
      return share(SkinningModes{.num_weights = skinning_weights(choice),
                                 .tolerance = choice.tolerance,
                                 .seed = choice.seed,
                                 .progress = progress}(system));
    }));
  } else {
    visit(stage("subspace", [&](auto) {
      return share(PcaBasis{.snapshots = choice.snapshots, .dimension = choice.dimension}(system));
    }));
  }
}

}  // namespace supple
