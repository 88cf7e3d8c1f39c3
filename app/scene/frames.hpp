#pragma once
/// \file The frames of a trajectory to look at.

#include <app/scene/trajectory.hpp>
#include <core/progress.hpp>

#include <filesystem>
#include <functional>
#include <string>

namespace supple {

/// Writes series.pvd with its .vtu files for ParaView and picture.png of telling frames.
/// \param caption  of a frame in the picture, from its time.
/// \param frames  "surface", "cells" or, the same, "tets" (for solids) or "none" (the picture alone).
/// \return seconds of the reconstruction of all nodes alone.
double write_frames(const std::filesystem::path& folder, const std::string& frames, const ReducedModel& model,
                    const Trajectory& trajectory, const std::function<std::string(double)>& caption,
                    const Progress& progress);

}  // namespace supple
