#pragma once
/// \file The object and its fitting problem as the command line names them, for all commands that pose one.

#include <app/commands/mesh_source.hpp>
#include <app/report/json_report.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace supple {

/// Options as typed. What is not given follows from the recipe.
struct ProblemOptions {
  std::string mesh;                  ///< file or built-in
  std::string mesh_unit = "m";       ///< of the file's lengths
  std::string components = "cells";  ///< what may be selected: cells or gauss-points

  std::string law = "stvk", young = "1e5", poisson = "0.4", density = "1000";
  std::optional<std::string> thickness;            ///< of a surface: a length, or a share of the diagonal
  std::vector<std::string> parameters;             ///< "name=value" of the law, instead of what the moduli give
  std::optional<std::filesystem::path> materials;  ///< law and parameters, and other values for regions, JSON
  std::string damping_alpha = "0", damping_beta = "0";
  std::vector<std::string> fix, fix_box, fix_region;
  std::vector<std::filesystem::path> fix_file;

  std::string recipe = "default";  ///< see recipe_of()
  bool relaxes = false;            ///< whether the default recipe may be "relaxed"
  std::optional<std::string> subspace;
  std::optional<Index> modes, dimension, poses, held_out, equilibria, full_loads;
  std::optional<std::filesystem::path> snapshots;  ///< for the subspace "pca"
  std::optional<double> omega_exponent;
  std::vector<double> amplitudes;
  std::optional<std::string> norm, inverted;
  std::optional<std::filesystem::path> poses_file;
  std::filesystem::path checkpoint;  ///< folder that keeps long stages; empty: none
  std::uint64_t seed = 1;
};

/// The mesh with the materials, damping and held nodes of the options.
Body load_body(const ProblemOptions& problem, const NamedMesh& named);
/// What to know of an object whose elements lock, and which do not; see locking_poisson().
std::optional<std::string> locking_note(const ProblemOptions& problem, const Body& body);
/// The recipe by name, "relaxed", "subspace" or "paper": that of the options, or else the best that the command has.
std::string recipe_of(const ProblemOptions& problem);
/// The recipe with what the options change; selector and size are left to the command.
/// \param named  the object's mesh, which a file of poses must fit.
ReduceOptions reduce_options(const ProblemOptions& problem, const NamedMesh& named, const Body& body);
/// Makes the folder of a checkpoint, if it keeps anything, and says on an interrupt that the same command goes on from it.
void keep_stages(const Checkpoint& checkpoint);
/// How many components the selector "all" would weight. \throws InputError if NNLS on so many is out of reach.
Index num_components_to_weight(const Body& body, const ReduceOptions& options);
/// What poses the problem, and nothing that differs between two runs of the same job.
Json problem_json(const ProblemOptions& problem, const ReduceOptions& options, const Body& body);

}  // namespace supple
