#pragma once
/// \file Meshes written for ParaView: `supple mesh`.

#include <filesystem>
#include <string>

namespace CLI {
class App;
}

namespace supple {

/// `supple mesh`: a built-in or a file as .vtu.
struct MeshCommand {
  std::string source;
  std::filesystem::path output;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
