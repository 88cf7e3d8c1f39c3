#pragma once
/// \file Training poses from files.

#include <core/types.hpp>
#include <physics/mesh/mesh_numbers.hpp>

#include <filesystem>

namespace supple {

/// One pose a column, as ReduceOptions::given_poses takes them: the array "poses" of a tensor file or a matrix as
/// read_matrix takes it (NumPy, Matrix Market), coordinates in the subspace (d × T) or displacements of all nodes
/// (3n × T); or a trajectory of supple simulate, whose frames become displacements, but for those at rest.
/// \param nodes  of the object to be reduced; a trajectory must be of the same.
/// \param places  of these in the mesh's file: displacements may be those of all its nodes.
/// \throws InputError naming the file, the pose and what was expected; a pose at rest has no force to fit.
Matrix read_poses(const std::filesystem::path& path, const Points& nodes, const NodePlaces& places = {});

/// The same for displacements of all nodes alone: 3n × T. \throws InputError also for another number of rows.
Matrix read_snapshots(const std::filesystem::path& path, const Points& nodes, const NodePlaces& places = {});

}  // namespace supple
