#pragma once
/// \file Facts of a model or a mesh: `supple info`.

#include <filesystem>
#include <string>

namespace CLI {
class App;
}

namespace supple {

/// `supple info`: what a model or a mesh holds.
struct InfoCommand {
  std::string source;  ///< model, mesh file or built-in
  std::filesystem::path json;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
