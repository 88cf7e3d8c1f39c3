#pragma once
/// \file Reduced models from meshes: `supple reduce`.

#include <app/commands/problem_options.hpp>

namespace CLI {
class App;
}

namespace supple {

/// `supple reduce`.
struct ReduceCommand : ProblemOptions {
  ReduceCommand() { relaxes = true; }

  std::filesystem::path model;

  std::optional<Index> points;
  std::optional<double> target_error;
  std::optional<std::string> selector;
  std::optional<std::string> full_error, step_time;  ///< what the model is to reach, instead of a size; at most one
  std::filesystem::path candidates, must_keep, warm_start;  ///< lists of components, a model; empty: none

  int threads = 0;
  std::filesystem::path json, picture, plots;  ///< empty: none

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
