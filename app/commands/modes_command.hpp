#pragma once
/// \file Vibration modes of an object: `supple modes`.

#include <app/commands/problem_options.hpp>

namespace CLI {
class App;
}

namespace supple {

/// `supple modes`: natural frequencies and shapes of a mesh with the options of `supple reduce` for objects.
struct ModesCommand : ProblemOptions {
  Index count = 10;              ///< of flexible modes, behind the motions without energy
  std::filesystem::path output;  ///< folder; empty: only the report
  std::filesystem::path json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
