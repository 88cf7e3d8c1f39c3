#pragma once
/// \file Scenes through time: `supple simulate`.

#include <core/types.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace supple {

/// `supple simulate`: options override the scene, the scene overrides the defaults.
struct SimulateCommand {
  std::filesystem::path model;
  std::optional<std::filesystem::path> scene;  ///< none: pluck_scene
  bool full = false;                           ///< the unreduced system
  std::optional<std::string> time, step;
  std::optional<std::string> integrator, solver;
  std::optional<double> tolerance;
  std::optional<Index> halvings;         ///< StepControl::max_halvings
  std::optional<std::string> precision;  ///< double or single; see complete()
  std::optional<Index> every;
  std::vector<Index> track;
  std::string frames = "surface";  ///< surface, cells (or tets) or none
  std::filesystem::path output;    ///< folder; empty: only the report
  std::filesystem::path json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
