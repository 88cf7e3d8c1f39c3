#pragma once
/// \file Registry of selectors, for problems whose type is known at run time: all compiled once, in one place.

#include <core/registry.hpp>
#include <sparse/problem/any_problem.hpp>
#include <sparse/selection/subset_selector.hpp>

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A selector by name, its type erased.
struct NamedSelector {
  using Run = std::function<Selection(const AnyProblem& problem, const SelectionRequest& request)>;

  std::string name, description;
  std::vector<OptionInfo> options;
  /// The selector with some options replaced and a seed. \throws std::invalid_argument for options that it has not.
  std::function<Run(const OptionValues& options, std::uint64_t seed)> make;
};

/// The entry of a selector of one's own; a member `seed` takes the seed.
///
///     selectors().add(named_selector("my-greedy", "columns of largest norm",
///                                    OptionsOf<MyGreedy>().add("batch", &MyGreedy::batch, "columns in each step")));
template <typename Selector>
requires SubsetSelectorFor<Selector, AnyProblem> NamedSelector
named_selector(std::string name, std::string description, OptionsOf<Selector> options = OptionsOf<Selector>()) {
  NamedSelector entry{name, std::move(description), options.info(), {}};
  entry.make = [name, options](const OptionValues& values, std::uint64_t seed) -> NamedSelector::Run {
    return seeded(options.make(values, "selector " + name), seed);
  };
  return entry;
}

/// All selectors by name, the default first.
Registry<NamedSelector>& selectors();
/// Their names.
std::vector<std::string> known_selectors();

/// A selector as a user writes it, "nn-sp:max_iterations=12". Takes problems of any type; a value.
class AnySelector {
 public:
  /// \throws std::invalid_argument for a name or an option that is not known, listing those that are.
  /// Its calls throw SolverError for an answer that is none, such as an index of no column.
  explicit AnySelector(std::string_view choice, std::uint64_t seed = 0);

  template <typename P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    if constexpr (std::same_as<P, AnyProblem>)
      return checked(run_(problem, request), problem.cols());
    else
      return (*this)(AnyProblem(problem), request);
  }
  const std::string& name() const { return name_; }

 private:
  Selection checked(Selection selection, Index cols) const;

  std::string name_;
  NamedSelector::Run run_;
};

/// Runs the selector of this name with this seed.
Selection select_by_name(std::string_view choice, const AnyProblem& problem, const SelectionRequest& request,
                         std::uint64_t seed);

}  // namespace supple
