#pragma once
/// \file Reader of sets of indices from text files.

#include <core/types.hpp>

#include <filesystem>
#include <string_view>
#include <vector>

namespace supple {

/// Indices of `what` ("node", "column"), of which there are `count`: counted from 0, one a line; '#' begins a
/// comment.
/// \return ascending, each once, at least one.
/// \throws InputError with the line if one is not in 0 … count − 1; or if the file names none.
std::vector<Index> read_indices(const std::filesystem::path& path, std::string_view what, Index count);

}  // namespace supple
