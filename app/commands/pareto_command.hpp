#pragma once
/// \file Sweep of models from coarse to fine, in time and error: `supple pareto`.

#include <app/commands/problem_options.hpp>

namespace CLI {
class App;
}

namespace supple {

/// `supple pareto`.
struct ParetoCommand : ProblemOptions {
  ParetoCommand() { relaxes = true; }

  std::vector<std::string> models;             ///< in words, see ModelWords; none: model_ladder()
  std::vector<double> tolerances;              ///< of steps; none: the scene's
  std::optional<std::filesystem::path> scene;  ///< none: pluck_scene() of the first model
  std::optional<std::string> time, step;       ///< instead of the scene's
  bool trajectory = false;                     ///< compare motions with that of the full object

  int threads = 0;
  std::filesystem::path output, json;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
