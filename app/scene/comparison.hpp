#pragma once
/// \file Distance of a motion from another one of the same object, the reference.

#include <app/scene/trajectory.hpp>
#include <core/progress.hpp>

#include <span>
#include <utility>

namespace supple {

/// How far a quantity is from that of the reference, and how large that is, in every frame.
struct Deviation {
  Vector difference, reference;

  explicit Deviation(Index frames) : difference(frames), reference(frames) {}
  /// Root mean square over the frames, relative; NaN against nothing.
  double relative() const { return ratio(difference.norm(), reference.norm()); }
  /// The worst frame against the largest reference.
  double largest() const { return ratio(difference.maxCoeff(), reference.maxCoeff()); }
  /// Of the largest reference, in every frame; not a number if that is zero.
  Vector share() const;

 private:
  static double ratio(double error, double size);
};

struct Comparison {
  Vector time;                   ///< of the frames [s]
  Deviation position, velocity;  ///< of displacements [m √kg] and velocities, in the norm of the masses
  Deviation energy;              ///< kinetic and elastic [J]
  Vector largest_distance;       ///< of any node, in every frame [m]

  explicit Comparison(Index frames)
      : time(frames), position(frames), velocity(frames), energy(frames), largest_distance(frames) {}
};

/// A trajectory and the model whose coordinates its frames are.
struct Motion {
  const Trajectory& trajectory;
  const ReducedModel& model;
};

/// \param frames  pairs at the same times, of the motion and of the reference, of one mesh.
Comparison compare(const Motion& motion, const Motion& reference, std::span<const std::pair<Index, Index>> frames,
                   const Progress& progress = {});

}  // namespace supple
