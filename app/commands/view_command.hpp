#pragma once
/// \file Simulation and editing in the browser: `supple view`.

#include <app/commands/problem_options.hpp>

#include <cstdint>

namespace CLI {
class App;
}

namespace supple {

/// `supple view`: of a model, or of a mesh, which it reduces first as `supple reduce` does.
struct ViewCommand : ProblemOptions {
  ViewCommand() { relaxes = true; }

  std::optional<Index> points;
  std::string listen = "127.0.0.1";
  std::uint16_t port = 0;                     ///< 0: a free one
  std::optional<std::filesystem::path> page;  ///< folder of the built page; none: where it is built or installed
  std::optional<std::filesystem::path> replay, beside;  ///< folders or trajectory files of `supple simulate`
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;             ///< until a signal ends it

 private:
  const CLI::App* declared_ = nullptr;  // knows which options were given
};

}  // namespace supple
