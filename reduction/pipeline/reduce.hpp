#pragma once
/// \file Main job in one call: from a solid or a shell to a reduced model with a measured error.

#include <core/progress.hpp>
#include <reduction/model/reduced_model.hpp>
#include <reduction/pipeline/object_traits.hpp>
#include <reduction/pipeline/reduce_options.hpp>

namespace supple {

/// \throws std::invalid_argument for options out of range; InputError for poses without finite force;
/// SolverError.
ReducedModel reduce(const Body& body, const ReduceOptions& options = {}, ReduceReport* report = nullptr,
                    const Progress& progress = {});

}  // namespace supple
