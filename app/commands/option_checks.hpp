#pragma once
/// \file Checks of what is typed after an option, beyond those of CLI11: each says what it expected.

#include <core/registry.hpp>
#include <core/types.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace supple {

/// A whole number of at least `least` that fits into 63 bits, without sign, point or exponent.
CLI::Validator whole_number(Index least = 1);
/// Finite, too.
CLI::Validator positive_number();
CLI::Validator number_between(double low, double high);
/// Names of subspaces, with options and in sums.
CLI::Validator subspace_name();
/// Models, see ModelWords.
CLI::Validator model_words();

/// A name of the registry, with options that its entry has: "nn-sp:patience=3". Asked while the line is read, when
/// plug-ins have added theirs.
template <typename Entry>
CLI::Validator known_in(const Registry<Entry>& registry) {
  return {[&registry](std::string& text) -> std::string {
            try {
              const Choice choice = Choice::parse(text);
              const std::vector<OptionInfo>& options = registry.at(choice.name).options;
              for (const auto& [name, value] : choice.options)
                require(std::ranges::find(options, name, &OptionInfo::name) != options.end(),
                        registry.kind() + " " + choice.name + " has no option '" + name + "', see --help");
              return "";
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
          },
          ""};
}

}  // namespace supple
