#pragma once
/// \file Selectors by name for problems whose type is known at run time: all compiled once, in one place.

#include <sparse/problem/any_problem.hpp>
#include <sparse/selection/selection.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// Names that select_by_name understands, the default first.
const std::vector<std::string>& known_selectors();

/// Runs the selector of this name with its default options and this seed.
/// \throws std::invalid_argument for a name that is not known, listing those that are.
Selection select_by_name(std::string_view name, const AnyProblem& problem, const SelectionRequest& request,
                         std::uint64_t seed);

}  // namespace supple
