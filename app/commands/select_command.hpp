#pragma once
/// \file Selections for a matrix and a vector: `supple select`.

#include <core/types.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace supple {

/// `supple select`: few columns of a matrix from a file, with weights. The options as typed.
struct SelectCommand {
  std::filesystem::path matrix, rhs;  ///< A, and b; no rhs: b = A·1
  std::optional<Index> points;
  std::optional<double> target_error;
  std::string selector;
  std::uint64_t seed = 1;

  std::filesystem::path candidates, must_keep;          ///< column indices; empty: all, none
  std::filesystem::path warm_start;                     ///< an earlier report of this command
  std::filesystem::path validate_matrix, validate_rhs;  ///< held-out rows
  Index group_size = 1;                                 ///< rows of a training pose
  std::optional<Index> train_groups;                    ///< of greedy; none: all

  int threads = 0;
  std::filesystem::path json;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
