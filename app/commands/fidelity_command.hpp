#pragma once
/// \file Shapes in subspaces against the full solution: `supple fidelity`.

#include <app/commands/problem_options.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace supple {

/// `supple fidelity`: how well subspaces of one dimension hold the shapes of scenes (the paper's Table 2, Figure 9).
struct FidelityCommand : ProblemOptions {
  std::vector<std::filesystem::path> scenes;
  std::vector<std::string> subspaces = {"extended", "derivatives", "modal", "skinning"};
  std::filesystem::path output;  ///< folder; empty: only the report
  std::filesystem::path json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
