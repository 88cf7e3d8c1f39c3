#pragma once

#include <physics/tet_mesh.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace supple {

/// `supple reduce`: the options as typed. What is not given follows from the recipe.
struct ReduceCommand {
  std::string mesh;  ///< file or built-in
  std::filesystem::path model;

  std::string law = "stvk", young = "1e5", poisson = "0.4", density = "1000";
  std::optional<std::filesystem::path> materials;  ///< other values for regions, JSON
  std::string damping_alpha = "0", damping_beta = "0";
  std::vector<std::string> fix, fix_box, fix_region;
  std::vector<std::filesystem::path> fix_file;

  std::string recipe = "default", subspace = "extended";
  std::optional<Index> modes, poses, points, held_out;
  std::optional<double> target_error, omega_exponent;
  std::vector<double> amplitudes;
  std::optional<std::string> selector, norm, inverted;
  std::optional<std::filesystem::path> poses_file;
  std::uint64_t seed = 1;

  int threads = 0;
  std::filesystem::path json, picture, plots;  ///< empty: none

  void run() const;
};

}  // namespace supple
