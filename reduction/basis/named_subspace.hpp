#pragma once
/// \file Subspaces by name, for commands and comparisons.

#include <reduction/basis/joined_basis.hpp>
#include <reduction/basis/modal_derivatives.hpp>
#include <reduction/basis/pca_basis.hpp>
#include <reduction/basis/skinning_modes.hpp>

#include <memory>
#include <string>
#include <variant>
#include <vector>

namespace supple {

/// A subspace as words and numbers tell it.
struct SubspaceChoice {
  std::string name = "extended";  ///< one of known_subspaces(), or several with '+' between: what they span together
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

/// "extended+pca" → "extended", "pca". \throws std::invalid_argument for an unknown name or one that comes twice.
std::vector<std::string> parts_of_subspace(const std::string& name);

/// \throws std::invalid_argument as parts_of_subspace, for a negative dimension, one of a union, or "pca" without
/// snapshots.
void check(const SubspaceChoice& choice);

/// Number of weights of the skinning modes of a choice.
Index skinning_weights(const SubspaceChoice& choice);

/// A basis whose structure is known at run time.
using NamedSubspace = std::variant<std::shared_ptr<const NodalBasis>, std::shared_ptr<const DenseBasis>>;

/// The basis of a system that one of known_subspaces() names.
/// \param stage  runs a named stage: stage("vibration modes", [](auto share) { … }).
template <typename System, typename Stage>
NamedSubspace single_subspace(const System& system, const SubspaceChoice& choice, const Progress& progress,
                              Stage&& stage) {
  const auto share = [](auto&& basis) -> NamedSubspace {
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
    return stage("subspace", [&](auto) {
      return share(extend_modes(vibration, system.model().rest_positions(), system.nodal_mass()));
    });
  }
  if (choice.name == "modal") {
    VibrationModes vibration = modes(choice.dimension > 0 ? choice.dimension : choice.modes);
    return share(DenseBasis{std::move(vibration.vectors), vibration.report()});
  }
  if (choice.name == "derivatives")
    return stage("modes and derivatives", [&](auto) {
      return share(ModalDerivatives{.num_modes = choice.modes,
                                    .dimension = choice.dimension,
                                    .affine_fields = true,
                                    .tolerance = choice.tolerance,
                                    .seed = choice.seed,
                                    .progress = progress}(system));
    });
  if (choice.name == "skinning")
    return stage("skinning modes", [&](auto) {
      return share(SkinningModes{.num_weights = skinning_weights(choice),
                                 .tolerance = choice.tolerance,
                                 .seed = choice.seed,
                                 .progress = progress}(system));
    });
  return stage("subspace", [&](auto) {
    return share(PcaBasis{.snapshots = choice.snapshots, .dimension = choice.dimension}(system));
  });
}

/// Calls visit(subspace) with a shared pointer to a NodalBasis or a DenseBasis of the system: that of the choice, or
/// what several span together, M-orthonormal.
/// \param stage  as of single_subspace.
template <typename System, typename Stage, typename Visitor>
void with_subspace(const System& system, const SubspaceChoice& choice, const Progress& progress, Stage&& stage,
                   Visitor&& visit) {
  const std::vector<std::string> parts = parts_of_subspace(choice.name);
  const auto part = [&](const std::string& name) {
    SubspaceChoice one = choice;
    one.name = name;
    return single_subspace(system, one, progress, stage);
  };
  NamedSubspace sum = part(parts.front());
  for (std::size_t k = 1; k < parts.size(); ++k)
    sum = std::visit(
        [&](const auto& first, const auto& second) -> NamedSubspace {
          auto joined = join(*first, *second, system.nodal_mass());
          return std::make_shared<const decltype(joined)>(std::move(joined));
        },
        sum, part(parts[k]));
  std::visit(visit, sum);
}

}  // namespace supple
