#pragma once
/// \file Where simulations stay sane: `supple stress`.

#include <filesystem>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace supple {

/// `supple stress`.
struct StressCommand {
  std::filesystem::path model;
  bool full = false;                     ///< the unreduced system
  bool brief = false;                    ///< two steps a period only
  std::vector<std::string> integrators;  ///< as --integrator of `simulate`; none: all there are
  std::vector<double> steps_per_period;  ///< none: 1000 to 10, brief: 60 and 10
  std::vector<std::string> hardships;    ///< names; none: all
  std::filesystem::path output, json;
  int threads = 0;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
