#pragma once
/// \file Training poses from files.

#include <core/types.hpp>

#include <filesystem>

namespace supple {

/// One pose a column, as ReduceOptions::given_poses takes them: the array "poses" of a tensor file (rows ×
/// T), the frames of a trajectory, or a matrix of rows × T as read_matrix takes it (NumPy, Matrix Market).
/// \throws InputError naming the file and what was expected.
Matrix read_poses(const std::filesystem::path& path);

}  // namespace supple
