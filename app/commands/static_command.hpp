#pragma once
/// \file Static equilibrium under the loads of a scene: `supple static`.

#include <app/commands/problem_options.hpp>

namespace CLI {
class App;
}

namespace supple {

/// `supple static`: of a model, reduced or full, or of a mesh with the options of `supple reduce` for objects.
struct StaticCommand : ProblemOptions {
  std::filesystem::path scene;
  bool full = false;                ///< of a model; a mesh is full in any case
  std::optional<std::string> time;  ///< when the scene's loads are taken
  Index steps = 1;
  double tolerance = 1e-9;
  std::optional<std::string> solver;
  std::vector<Index> track;      ///< places of nodes
  std::vector<std::string> cut;  ///< planes
  std::filesystem::path output;  ///< folder; empty: only the report
  std::filesystem::path json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;

 private:
  const CLI::App* declared_ = nullptr;  // knows which options were given
};

}  // namespace supple
