#pragma once
/// \file Registry of subspaces, for commands and comparisons.

#include <core/checkpoint.hpp>
#include <core/progress.hpp>
#include <core/registry.hpp>
#include <reduction/basis/subspace_choice.hpp>
#include <reduction/subspace/subspace_builder.hpp>

#include <functional>
#include <string>
#include <vector>

namespace supple {

/// How a subspace is being made: what tells of its progress and runs its named stages.
struct SubspaceRun {
  using Work = std::function<void()>;

  Progress progress = {};
  std::function<void(const std::string& stage, const Work& work)> stage = [](const std::string&, const Work& work) {
    work();
  };
  Checkpoint checkpoint = {};
};

/// A subspace by name.
struct NamedSubspace {
  std::string name, description;
  std::vector<OptionInfo> options;
  /// \throws as the builder; std::invalid_argument for options that it has not.
  std::function<AnyBasis(const RestState& object, const SubspaceChoice& choice, const OptionValues& options,
                         const SubspaceRun& run)>
      build;
};

/// The entry of a builder of one's own. Its members num_modes, dimension, snapshots, tolerance, seed, progress and checkpoint,
/// if it has them, take what the choice and the run say. \param stage  what reports call its time.
///
///     subspaces().add(named_subspace<MyBasis>("my-basis", "what it spans"));
template <SubspaceBuilder Builder>
NamedSubspace named_subspace(std::string name, std::string description,
                             OptionsOf<Builder> options = OptionsOf<Builder>(), std::string stage = "subspace") {
  NamedSubspace entry{name, std::move(description), options.info(), {}};
  entry.build = [name, options, stage](const RestState& object, const SubspaceChoice& choice,
                                       const OptionValues& values, const SubspaceRun& run) -> AnyBasis {
    Builder build = options.make(values, "subspace " + name);
    if constexpr (requires { build.num_modes = choice.modes; }) build.num_modes = choice.modes;
    if constexpr (requires { build.dimension = choice.dimension; }) build.dimension = choice.dimension;
    if constexpr (requires { build.snapshots = choice.snapshots; }) build.snapshots = choice.snapshots;
    if constexpr (requires { build.tolerance = choice.tolerance; }) build.tolerance = choice.tolerance;
    if constexpr (requires { build.seed = choice.seed; }) build.seed = choice.seed;
    if constexpr (requires { build.progress = run.progress; }) build.progress = run.progress;
    if constexpr (requires { build.checkpoint = run.checkpoint; }) build.checkpoint = run.checkpoint;
    AnyBasis result;
    run.stage(stage, [&] {
      auto basis = build(object);
      result = std::make_shared<const decltype(basis)>(std::move(basis));
    });
    return result;
  };
  return entry;
}

/// All subspaces by name, the default first:
///   "extended"     modes under all linear maps (Alg. 2)
///   "modal"        the linear modes alone; `dimension` of them, if that is given
///   "derivatives"  modes, the affine fields of free parts, and the best of the modes' derivatives
///   "skinning"     skinning eigenmodes, as many weights as fit in `dimension`; else (modes + 1) / 2
///   "pca"          principal components of the snapshots
Registry<NamedSubspace>& subspaces();
/// Their names.
std::vector<std::string> known_subspaces();

/// "extended+pca" → "extended", "pca", without options. \throws std::invalid_argument for an unknown name or one that
/// comes twice.
std::vector<std::string> parts_of_subspace(const std::string& name);

/// \throws std::invalid_argument as parts_of_subspace, for a negative dimension, one of a union, or "pca" without
/// snapshots.
void check(const SubspaceChoice& choice);

/// Number of weights of the skinning modes of a choice.
Index skinning_weights(const SubspaceChoice& choice);

/// How many of the rigid motions of the parts that nothing holds, translations and infinitesimal rotations, are not in a
/// subspace: 0 for all that span modes or affine fields, which snapshots (PCA) need not.
Index missing_rigid_motions(const RestState& object, const AnyBasis& basis);

/// The basis of a choice: of one name, or what several span together, M-orthonormal. A note in its report says where a free
/// part lacks rigid motions. \throws as the builders;
/// SolverError for a basis that is none: not finite or orthonormal, or moving nodes that are held.
AnyBasis build_subspace(const RestState& object, const SubspaceChoice& choice, const SubspaceRun& run = {});

}  // namespace supple
