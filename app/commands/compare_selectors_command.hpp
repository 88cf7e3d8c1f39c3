#pragma once
/// \file Selectors over sizes and seeds on one problem: `supple compare-selectors`.

#include <app/commands/problem_options.hpp>

namespace CLI {
class App;
}

namespace supple {

/// `supple compare-selectors`.
struct CompareSelectorsCommand : ProblemOptions {
  std::vector<std::string> selectors{"nn-sp", "nn-htp", "greedy", "batched-greedy", "ecm", "random"};
  std::vector<Index> sizes;           ///< none: 50, 100, 150 and 250, as far as there are so many components
  Index runs = 3;                     ///< seeds for each selector and size
  std::optional<Index> train_groups;  ///< poses that "greedy" compares components on; none: all
  bool trajectories = false;          ///< compare pulled motions, too

  int threads = 0;
  std::filesystem::path output, json;

  void declare(CLI::App& app);  ///< adds the subcommand, which writes into this object and calls run()
  void run() const;
};

}  // namespace supple
