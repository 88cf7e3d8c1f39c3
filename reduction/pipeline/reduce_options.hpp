#pragma once
/// \file Options and report of reduce(), as plain data.

#include <core/checkpoint.hpp>
#include <core/types.hpp>
#include <reduction/basis/subspace_choice.hpp>
#include <reduction/system/stiffness_range.hpp>
#include <reduction/training/pose_options.hpp>
#include <sparse/selection/selection.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supple {

/// What becomes of a selection that leaves a direction without stiffness at rest, see StiffnessRange::is_singular(): a model
/// with a note, for studies that measure such models, too; or a SolverError with the number of components that it takes.
enum class SingularModels { Note, Refuse };

struct ReduceOptions {
  std::string subspace = "extended";  ///< one of known_subspaces() or a sum of some, see SubspaceChoice
  Index modes = 15;                   ///< r, rigid ones included
  Index dimension = 0;                ///< d to aim at, where the modes leave a choice
  Matrix snapshots = {};              ///< 3n × T displacements, for the subspace "pca"
  PoseOptions poses = {};             ///< training poses
  ForceNorm norm = ForceNorm::Stiffness;
  Matrix given_poses = {};  ///< d × T, instead of random ones; or 3n × T displacements, projected to the subspace
  /// Further poses, in equilibrium under random loads, where errors of the force count by the displacement that they
  /// cause (see EquilibriumFitting): motions come out about twice as accurate. Loads are 3, 1 and 0.3 times those of the
  /// largest poses, a third of that for shells, which buckle; all together weigh as much as the other poses. None: see
  /// num_equilibria().
  std::optional<Index> equilibria = {};
  /// Instead of these; where forces relax, of linear responses exactly, by default 0.12, 0.06, 0.03 and for shells a third.
  std::vector<double> equilibrium_amplitudes = {};
  double equilibrium_weight = 1;  ///< of all their rows together, beside all rows of the other poses
  /// Whether the forces at the equilibria are those of the full object whose displacements outside of the subspace have
  /// relaxed (see Relaxation), instead of those of all components in the subspace: a model can be nearer to the full
  /// object than its subspace with all components.
  bool relaxed = false;
  std::string selector = "nn-sp";  ///< one of known_selectors(), with options as in "nn-sp:patience=3"
  /// s, largest number of components; 0: four thirds of the dimension, shells: eight; more if these leave it weak.
  Index points = 150;
  /// If positive: as few components as reach this training error and leave no direction weak, see StiffnessRange::is_weak().
  double target_error = 0;
  SingularModels singular = SingularModels::Note;
  std::vector<Index> candidates = {};  ///< components that may be selected beside must_keep; empty: all
  std::vector<Index> must_keep = {};   ///< components that every selection has, unless their weight would be 0
  Selection warm_start = {};           ///< an earlier selection to improve, such as that of a model to update
  Index held_out_poses = 100;          ///< random ones at each of three amplitudes; 0: measure nothing held out
  Index full_loads = 0;                ///< fresh loads under which the model is compared with the full object; 0: none
  std::uint64_t seed = 1;
  /// Keeps modes, derivatives, relaxed forces and selections, to go on from after a stop with the same bits.
  Checkpoint checkpoint = {};

  SubspaceChoice subspace_choice() const {
    return {.name = subspace, .modes = modes, .dimension = dimension, .snapshots = snapshots, .seed = seed};
  }

  /// The paper's: 1000 poses with deviations ∝ 1/ω̄, errors in the M-orthonormal basis, NN-HTP. The amplitude,
  /// which the paper leaves open, is the one at which its error for the dragon comes out (7 % of the
  /// diagonal).
  static ReduceOptions paper();
  /// Modal derivatives, and weights fitted to what the full object answers: at the same time a step several times nearer to
  /// the full object than the default-constructed options (docs/decisions). What the command does for solids.
  /// \param modes  r, from which d and s follow.
  static ReduceOptions relaxed_derivatives(Index modes = 20);
  /// Extended modes, and such weights: for shells, whose handles may go far beyond what derivatives hold.
  static ReduceOptions relaxed_extended(Index modes = 15);
};

/// \throws std::invalid_argument for options out of range.
void check(const ReduceOptions& options);

/// Distance of a model's equilibria from those of the full object under the same fresh loads, along the ten softest
/// modes, that displace the object by 8 and 4 % of its diagonal (rms of the linear response; shells: a third). Rms over the
/// loads of ‖u_full − U q‖_M / ‖u_full‖_M and its two parts, which are orthogonal: total² = outside² + inside². NaN if not
/// measured.
struct FullError {
  double total = nan, outside = nan, inside = nan;
  double worst = nan;  ///< of a load, total
  Index loads = 0,
        halved = 0;      ///< how many were compared; of these, after halving, for no equilibrium was found before
  Index unfinished = 0;  ///< left out, for no full equilibrium was found after that either

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
};

/// Everything that was measured on the way.
struct ReduceReport {
  Index nodes = 0, components = 0, fixed_nodes = 0, dimension = 0, points = 0, poses = 0;
  Vector omega;  ///< of the modes [rad/s]
  Index rigid_modes = 0, dropped = 0;
  Index inverted_poses = 0, redrawn_poses = 0, shrunk_poses = 0;
  double training_error = 0;  ///< ε, Eq. 5; where there are equilibria, of their rows and those of the poses together
  double held_out_error = 0;  ///< on fresh poses at the largest amplitude; NaN if none were asked for
  std::vector<std::pair<double, double>> held_out;  ///< share of that amplitude (1, 0.3, 0.1) and error
  /// Softest flexible eigenvalues of the fitted rest stiffness and of the exact reduced one [1/s²].
  Vector fitted_eigenvalues, exact_eigenvalues;
  FullError full_error;  ///< against the full object; the other errors are against all components in the subspace
  /// Rms of ‖Δq‖ / ‖q‖ over equilibria under fresh loads against those of what was fitted to: under loads such as those of the
  /// training equilibria all components in the subspace, or, where forces relaxed, the full object: full_error.inside.
  /// NaN if not measured: without a potential, or without full_loads where it is the full object.
  double equilibrium_error = nan;
  Index equilibrium_loads = 0,
        equilibrium_unfinished = 0;         ///< compared; left out, for the reference found no equilibrium
  double equilibrium_training_error = nan;  ///< the same over the training equilibria, by the model's own tangents
  /// Of the fitted stiffness at rest against the exact reduced one, over all d directions that have energy.
  StiffnessRange rest_stiffness;
  /// About how many components would make that sound; 0 where it is, or where forces relaxed: what those are fitted to is
  /// not the stiffness of the subspace, and more components come no nearer to it.
  Index points_for_sound_stiffness = 0;
  /// How many components were enough for what was asked, but left a direction weak, so that there are more; 0: none did.
  Index points_too_weak = 0;
  SelectionReport selection;
  std::vector<std::pair<std::string, double>> seconds;  ///< by stage, in order
  double total_seconds = 0;
  double peak_memory = 0;  ///< largest resident size of the process so far [bytes]
  std::vector<std::string> notes;

 private:
  static constexpr double nan = std::numeric_limits<double>::quiet_NaN();
};

}  // namespace supple
