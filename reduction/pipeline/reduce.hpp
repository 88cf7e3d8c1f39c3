#pragma once
/// \file Main job in one call: from a solid or a shell to a reduced model with a measured error.

#include <core/progress.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <reduction/pipeline/reduced_model.hpp>

#include <string_view>

namespace supple {

/// As many as the options say; otherwise a third of the random poses, none beside given ones nor for free shells, whose
/// forces would be a quarter further off.
Index num_equilibria(const Body& body, const ReduceOptions& options);

/// What becomes of poses with inverted tets of a material law: as asked for; otherwise Keep where the law's energy
/// is finite in such tets, else Shrink. \throws std::invalid_argument if Keep is asked for where it is not.
InvertedPoses inverted_rule(std::string_view law, std::optional<InvertedPoses> asked);

/// \throws std::invalid_argument for options out of range; InputError for poses without finite force;
/// SolverError.
ReducedModel reduce(const Body& body, const ReduceOptions& options = {}, ReduceReport* report = nullptr,
                    const Progress& progress = {});

}  // namespace supple
