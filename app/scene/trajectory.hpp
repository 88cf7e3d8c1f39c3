#pragma once
/// \file Frames of a simulation in a file, to look at and to compare; see docs/model-file.md.

#include <reduction/model/reduced_model.hpp>

#include <filesystem>
#include <string>

namespace supple {

/// Frames in reduced coordinates of a model, or in displacements of all nodes.
struct Trajectory {
  bool reduced = true;
  std::filesystem::path model;    ///< absolute
  std::string model_checksum;     ///< of the file that it was computed with
  double step = 0;                ///< [s]
  double steps_per_second = 0;    ///< of the integration, for people
  Vector time;                    ///< of each frame [s]
  Vector kinetic, elastic, work;  ///< at each frame [J]
  RowMatrix u, v;  ///< frames × coordinates: q and q̇; or displacements [m] and velocities [m/s], interleaved

  Index num_frames() const { return time.size(); }
};

/// Displacements and velocities of all nodes, interleaved, at a frame.
Vector frame_displacement(const Trajectory& trajectory, const ReducedModel& model, Index frame);
Vector frame_velocity(const Trajectory& trajectory, const ReducedModel& model, Index frame);

/// Displacements of all nodes are kept in single precision.
void save_trajectory(const std::filesystem::path& path, const Trajectory& trajectory);
/// \param path  the file, or the folder that `supple simulate` wrote it to.
/// \throws InputError naming the file and what is wrong with it.
Trajectory load_trajectory(const std::filesystem::path& path);

/// The model of a trajectory. \throws InputError if it is gone, or another than the one it was computed with.
ReducedModel load_model_of(const Trajectory& trajectory, const std::filesystem::path& source);

/// The checksum in the header of a tensor file: two files with the same have the same content.
std::string header_checksum(const std::filesystem::path& path);

constexpr const char* trajectory_file = "trajectory.safetensors";

}  // namespace supple
