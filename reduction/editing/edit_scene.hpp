#pragma once
/// \file Scripted edits as data: handles on an object and their motions.

#include <numerics/optimize/warm_solver.hpp>
#include <physics/load/loads.hpp>
#include <reduction/editing/handles.hpp>

#include <optional>
#include <string>
#include <vector>

namespace supple {

/// A handle region as the scene names it.
struct HandleRegion {
  std::string name;
  std::vector<Index> nodes;
  std::optional<Index> samples;
  std::optional<double> weight;  ///< [N/m]
  bool movable = true;           ///< whether a viewer lets one drag it
};

/// Moves some handles to new places (from rest, not from the last edit), on the way through `increments` solves.
struct Edit {
  std::vector<std::pair<Index, RigidMotion>> moves;  ///< handle and motion
  Index increments = 1;
};

struct EditScene {
  std::string description;
  std::vector<HandleRegion> handles;
  std::vector<Edit> edits;
  Loads loads = {};  ///< what acts beside the handles, in every solve
  std::optional<NonlinearSolver> solver;
  std::optional<double> tolerance;
  std::optional<Index> max_iterations;
  std::uint64_t seed = 1;  ///< of the samples
};

/// The handles, ready to grasp. Samples not stated: 100 a handle. Weights not stated: such that all springs of a handle
/// together have the default_handle_stiffness().
/// \param softest_eigenvalue  λ₁ [1/s²].  \param mass  M [kg].
std::vector<Handle> make_handles(const EditScene& scene, double softest_eigenvalue, double mass);

/// The motions of all handles in every solve: solves × handles.
std::vector<std::vector<RigidMotion>> handle_paths(const EditScene& scene, const std::vector<Handle>& handles,
                                                   const Points& rest_positions);

}  // namespace supple
