#pragma once
/// \file How far one trajectory is from another: `supple compare`.

#include <filesystem>

namespace CLI {
class App;
}

namespace supple {

/// `supple compare`: how far one trajectory is from another, the reference.
struct CompareCommand {
  std::filesystem::path first, reference;  ///< files or folders of `supple simulate`
  std::filesystem::path output;            ///< folder; empty: only the report
  std::filesystem::path json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
