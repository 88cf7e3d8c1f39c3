#pragma once
/// \file Frames of a trajectory to look at.

#include <app/scene/trajectory.hpp>
#include <core/progress.hpp>
#include <core/registry.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace supple {

class VtuSeries;
struct Surface;

/// One frame of a trajectory.
struct FrameToWrite {
  const Body& body;
  const Surface& surface;
  double time;
  const Vector &u, &v;  ///< displacements [m] and velocities [m/s] of all nodes
};

/// What ParaView gets of a frame, by name.
struct NamedFrames {
  std::string name, description;
  std::vector<OptionInfo> options = {};
  std::function<void(const FrameToWrite& frame, VtuSeries& series)> write;  ///< empty: nothing
};

/// "surface", the default; "cells" and, the same, "tets"; "none"; and what was added.
Registry<NamedFrames>& frame_writers();

/// Writes series.pvd with its .vtu files for ParaView and picture.png of telling frames.
/// \param caption  of a frame in the picture, from its time.
/// \param frames  one of frame_writers().
/// \return seconds of the reconstruction of all nodes alone.
double write_frames(const std::filesystem::path& folder, const std::string& frames, const ReducedModel& model,
                    const Trajectory& trajectory, const std::function<std::string(double)>& caption,
                    const Progress& progress);

}  // namespace supple
