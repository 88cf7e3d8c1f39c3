#pragma once
/// \file Table of all selectors with their names and options, of their own types.

#include <core/registry.hpp>
#include <sparse/selectors/baselines.hpp>
#include <sparse/selectors/ecm.hpp>
#include <sparse/selectors/greedy_cubature.hpp>
#include <sparse/selectors/niht.hpp>
#include <sparse/selectors/nn_htp.hpp>
#include <sparse/selectors/nn_omp.hpp>
#include <sparse/selectors/nn_sp.hpp>
#include <sparse/selectors/row_compression.hpp>

#include <array>
#include <optional>
#include <string_view>
#include <tuple>

namespace supple {

template <>
inline constexpr std::array names_of<StepLength>{Named{StepLength::Paper, "paper"}, Named{StepLength::Exact, "exact"}};
template <>
inline constexpr std::array names_of<NihtStep>{Named{NihtStep::Normalized, "normalized"},
                                               Named{NihtStep::Paper, "paper"}, Named{NihtStep::Exact, "exact"}};

/// A selector of its own type by its name.
template <typename Selector>
struct SelectorEntry {
  using type = Selector;
  std::string_view name, description;
  OptionsOf<Selector> options;
};

/// Every selector, the default first. What commands choose from, selectors(), begins with these.
inline const auto& selector_table() {
  constexpr double all = std::numeric_limits<double>::infinity();
  static const auto htp = []<typename S>(S defaults) {
    return OptionsOf<S>(std::move(defaults))
        .add("tolerance", &S::tolerance, "relative error to stop at")
        .add("max_iterations", &S::max_iterations, "iterations at most")
        .add("candidates_per_size", &S::candidates_per_size, "columns drawn in each, over the size; inf: all")
        .add("step", &S::step, "along the gradient, one of " + listed(all_names_of<decltype(S::step)>()))
        .add("patience", &S::patience, "draws in a row that change nothing before it stops");
  };
  static const std::tuple table{
      SelectorEntry<NnSp>{
          "nn-sp", "non-negative subspace pursuit: grows, prunes and exchanges",
          OptionsOf<NnSp>()
              .add("tolerance", &NnSp::tolerance, "relative error to stop at")
              .add("max_iterations", &NnSp::max_iterations, "iterations at most; 0: 6000 / size, but at least 24")
              .add("candidates_per_size", &NnSp::candidates_per_size, "columns drawn in each, over the size")
              .add("added_per_size", &NnSp::added_per_size, "share of the size that each tries to exchange")
              .add("patience", &NnSp::patience, "draws in a row that change nothing before it stops")},
      SelectorEntry<NnHtp>{"nn-htp", "non-negative hard thresholding pursuit, the paper's", htp(NnHtp{})},
      SelectorEntry<NnHtp>{"nn-htp-full", "the same on all columns in each iteration",
                           htp(NnHtp{.candidates_per_size = all})},
      SelectorEntry<Htp>{"htp", "hard thresholding pursuit, weights of any sign", htp(Htp{})},
      SelectorEntry<Niht>{"niht", "normalised iterative hard thresholding, weights of any sign", htp(Niht{})},
      SelectorEntry<NnNiht>{"nn-niht", "the same, non-negative", htp(NnNiht{})},
      SelectorEntry<GreedyCubature>{
          "greedy", "greedy cubature: the best of some random columns, one by one",
          OptionsOf<GreedyCubature>()
              .add("tolerance", &GreedyCubature::tolerance, "relative error to stop at")
              .add("candidates", &GreedyCubature::candidates, "columns drawn in each step")
              .add("subset_groups", &GreedyCubature::subset_groups, "poses to train on; 0: all")},
      SelectorEntry<BatchedGreedy>{
          "batched-greedy", "several columns between two fits",
          OptionsOf<BatchedGreedy>()
              .add("tolerance", &BatchedGreedy::tolerance, "relative error to stop at")
              .add("added_per_size", &BatchedGreedy::added_per_size, "share of the size that joins in each step")
              .add("candidates_per_added", &BatchedGreedy::candidates_per_added, "columns drawn for each that joins")},
      SelectorEntry<NnOmp>{"nn-omp", "non-negative orthogonal matching pursuit: the best of all columns, one by one",
                           OptionsOf<NnOmp>()
                               .add("tolerance", &NnOmp::tolerance, "relative error to stop at")
                               .add("overshoot", &NnOmp::overshoot, "share of the size to grow to before pruning")
                               .add("batch", &NnOmp::batch, "columns added in each step")
                               .add("candidates", &NnOmp::candidates, "columns looked at in each step")},
      SelectorEntry<Ecsw>{"ecsw", "energy-conserving sampling and weighting",
                          OptionsOf<Ecsw>().add("tolerance", &Ecsw::tolerance, "relative error to stop at")},
      SelectorEntry<Ecm>{"ecm", "empirical cubature on a basis of the rows",
                         OptionsOf<Ecm>()
                             .add("tolerance", &Ecm::tolerance, "relative error on the basis to stop at")
                             .add("num_modes", &Ecm::num_modes, "rows of the basis; 0: as many as columns")},
      SelectorEntry<UniformRandom>{"random", "columns at random, weighted: what others have to beat",
                                   OptionsOf<UniformRandom>()},
      SelectorEntry<AllColumns>{"all", "all columns, weighted: what none can beat", OptionsOf<AllColumns>()}};
  return table;
}

/// Names of the selectors of the table.
inline const auto selector_names =
    std::apply([](const auto&... entries) { return std::array{entries.name...}; }, selector_table());

/// Calls use(selector) with the selector of that name in the table, its other options at their defaults.
/// \throws std::invalid_argument naming the known ones.
template <typename Use>
auto with_selector(std::string_view name, std::uint64_t seed, const Use& use) {
  using Result = decltype(use(NnSp{}));
  std::optional<Result> result;
  std::apply(
      [&](const auto&... entries) {
        const auto try_one = [&](const auto& entry) {
          if (entry.name != name) return false;
          result.emplace(use(seeded(entry.options.make({}, std::string(name)), seed)));
          return true;
        };
        (void)(try_one(entries) || ...);
      },
      selector_table());
  require(result.has_value(), "selector is '" + std::string(name) + "', expected one of " + listed(selector_names));
  return *std::move(result);
}

/// with_selector(name, seed, …)(problem, request).
template <FittingProblem P>
Selection select_by_name(std::string_view name, const P& problem, const SelectionRequest& request, std::uint64_t seed) {
  return with_selector(name, seed, [&](const auto& select) { return select(problem, request); });
}

}  // namespace supple
