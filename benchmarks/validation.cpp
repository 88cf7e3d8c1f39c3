// Problems with published answers, as tables in Markdown: what scripts/validate puts into docs/validation.md.

#include <core/parallel.hpp>
#include <core/text.hpp>

#include <CLI/CLI.hpp>
#include <benchmarks/validation/cases.hpp>

#include <cmath>
#include <cstdio>
#include <iostream>

namespace {

using namespace supple;

std::string number(double value) {
  return shown(value, 5);
}
std::string distance(double value, double reference) {
  const double share = 100 * (value / reference - 1);
  return (share >= 0 ? "+" : "") + shown(share, 2) + " %";
}

/// \return whether the finest level is as near as it should be.
bool print_case(const ValidationCase& what, bool finest_too) {
  bool near = true;
  std::printf("## %s\n\n%s. Reference: %s.\n\n", what.name.c_str(), what.setup.c_str(), what.source.c_str());
  std::printf("| cells | unknowns |");
  for (const PublishedValue& value : what.values)
    std::printf(" %s%s |", value.name.c_str(), value.unit.empty() ? "" : (" [" + value.unit + "]").c_str());
  std::printf("\n| ---: | ---: |");
  for (std::size_t k = 0; k < what.values.size(); ++k) std::printf(" --- |");
  std::printf("\n| published | |");
  for (const PublishedValue& value : what.values) std::printf(" %s |", number(value.value).c_str());
  std::printf("\n");
  const std::size_t last = finest_too ? what.levels.size() : 1;
  for (std::size_t level = 0; level < last; ++level) {
    const Validation result = what.run(what.levels[level], level + 1 == last);
    std::printf("| %td | %td |", result.cells, result.unknowns);
    for (std::size_t k = 0; k < what.values.size(); ++k)
      std::printf(" %s, %s |", number(result.full[static_cast<Index>(k)]).c_str(),
                  distance(result.full[static_cast<Index>(k)], what.values[k].value).c_str());
    std::printf("\n");
    if (result.reduced.size() > 0) {
      std::printf("| reduced | %td |", result.reduced_unknowns);
      for (std::size_t k = 0; k < what.values.size(); ++k)
        std::printf(" %s, %s |", number(result.reduced[static_cast<Index>(k)]).c_str(),
                    distance(result.reduced[static_cast<Index>(k)], what.values[k].value).c_str());
      std::printf("\n");
    }
    std::fflush(stdout);
    if (level + 1 < what.levels.size()) continue;
    for (std::size_t k = 0; k < what.values.size(); ++k)
      near = near && std::abs(result.full[static_cast<Index>(k)] - what.values[k].value) <=
                         what.tolerance * std::abs(what.values[k].value);
  }
  std::printf("\n%s", what.remark.empty() ? "" : (what.remark + "\n\n").c_str());
  if (!near) std::fprintf(stderr, "%s is not within %s %%\n", what.name.c_str(), shown(100 * what.tolerance).c_str());
  return near;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Problems with published answers, solved by full and reduced objects", "benchmark_validation"};
  std::string only;
  bool coarse = false;
  app.add_option("--only", only, "Cases whose names have this in them");
  app.add_flag("--coarse", coarse, "The coarsest mesh of each alone");
  CLI11_PARSE(app, argc, argv);
  bool near = true;
  for (const ValidationCase& what : validation_cases())
    if (what.name.find(only) != std::string::npos) near = print_case(what, !coarse) && near;
  return near ? 0 : 1;
}
