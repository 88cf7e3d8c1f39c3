#pragma once
/// \file Every selector by its name, for programs that let their user choose.

#include <sparse/selectors/baselines.hpp>
#include <sparse/selectors/ecm.hpp>
#include <sparse/selectors/greedy_cubature.hpp>
#include <sparse/selectors/niht.hpp>
#include <sparse/selectors/nn_htp.hpp>
#include <sparse/selectors/nn_omp.hpp>
#include <sparse/selectors/nn_sp.hpp>
#include <sparse/selectors/row_compression.hpp>

#include <array>
#include <string_view>

namespace supple {

inline constexpr std::array<std::string_view, 13> selector_names{
    "nn-sp",          "nn-htp", "nn-htp-full", "htp", "niht",   "nn-niht", "greedy",
    "batched-greedy", "nn-omp", "ecsw",        "ecm", "random", "all"};

/// Calls use(selector) with the selector of that name, its other options at their defaults.
/// \throws std::invalid_argument naming the known ones.
template <typename Use>
auto with_selector(std::string_view name, std::uint64_t seed, const Use& use) {
  constexpr double all = std::numeric_limits<double>::infinity();
  if (name == "nn-sp") return use(NnSp{.seed = seed});
  if (name == "nn-htp") return use(NnHtp{.seed = seed});
  if (name == "nn-htp-full") return use(NnHtp{.candidates_per_size = all, .seed = seed});
  if (name == "htp") return use(Htp{.seed = seed});
  if (name == "niht") return use(Niht{.seed = seed});
  if (name == "nn-niht") return use(NnNiht{.seed = seed});
  if (name == "greedy") return use(GreedyCubature{.seed = seed});
  if (name == "batched-greedy") return use(BatchedGreedy{.seed = seed});
  if (name == "nn-omp") return use(NnOmp{.seed = seed});
  if (name == "ecsw") return use(Ecsw{.seed = seed});
  if (name == "ecm") return use(Ecm{.seed = seed});
  if (name == "random") return use(UniformRandom{.seed = seed});
  if (name == "all") return use(AllColumns{});
  std::string known;
  for (std::string_view n : selector_names) known += (known.empty() ? "" : ", ") + std::string(n);
  throw std::invalid_argument("selector is '" + std::string(name) + "', expected one of " + known);
}

/// with_selector(name, seed, …)(problem, request).
template <FittingProblem P>
Selection select_by_name(std::string_view name, const P& problem, const SelectionRequest& request, std::uint64_t seed) {
  return with_selector(name, seed, [&](const auto& select) { return select(problem, request); });
}

}  // namespace supple
