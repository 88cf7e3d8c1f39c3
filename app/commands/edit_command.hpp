#pragma once
/// \file Edits by handles along a script: `supple edit`.

#include <core/types.hpp>

#include <filesystem>
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace supple {

/// `supple edit`: the shapes that an object takes as handles on it move.
struct EditCommand {
  std::filesystem::path model, scene;
  bool full = false;  ///< the unreduced system
  std::optional<std::string> solver;
  std::optional<double> tolerance;
  std::string frames = "surface";  ///< surface, cells (or tets) or none
  std::filesystem::path output;    ///< folder; empty: only the report
  std::filesystem::path json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
