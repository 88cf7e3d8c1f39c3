#pragma once
/// \file The frames of a trajectory to look at.

#include <app/trajectory.hpp>
#include <core/progress.hpp>

#include <filesystem>
#include <string>

namespace supple {

/// Writes series.pvd with its .vtu files for ParaView and picture.png of telling frames.
/// \param frames  "surface", "tets" (for solids) or "none" (the picture alone).
/// \return seconds of the reconstruction of all nodes alone.
double write_frames(const std::filesystem::path& folder, const std::string& frames, const ReducedModel& model,
                    const Trajectory& trajectory, const Progress& progress);

}  // namespace supple
