#pragma once
/// \file Test of how far a selection leads a motion astray: pulls of an object, beside the same subspace with all
/// components.

#include <core/parallel.hpp>
#include <core/stopwatch.hpp>
#include <physics/system/any_system.hpp>
#include <physics/time/newmark.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/training/pull_scene.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

namespace supple {

/// One motion, a column for each step, and what its steps took.
struct PulledMotion {
  Matrix q;                              ///< d × steps
  std::vector<double> seconds;           ///< by step
  double iterations = 0, refreshes = 0;  ///< means over the steps
  double worst_residual = 0;             ///< relative, over the steps
  int missed_steps = 0;                  ///< that did not reach the tolerance
};

/// Pulls one object with any of its selections. A reference costs O(m) a force; compute it once.
template <ObjectSystem System>
class PullTest {
 public:
  /// \param modes     of the exact reduced stiffness.  \param diagonal  of the object [m].
  /// \param sample    a system to scale the pulls by, so that its motions reach their targets; a rough
  /// selection will do.
  PullTest(std::vector<PullScene> scenes, const ReducedModes& modes, double diagonal, const System& sample)
      : scenes_(std::move(scenes)), omega_(modes.omega[modes.num_zero]), diagonal_(diagonal) {
    const Vector compliance = modes.omega.tail(modes.omega.size() - modes.num_zero).array().square().inverse();
    const auto Phi = modes.Phi.rightCols(compliance.size());  // modes with energy
    for (const PullScene& scene : scenes_) {
      Vector& pull = pulls_.emplace_back(
          modes.num_zero > 0 ? Vector(Phi.col(0)) : sample.project({.gravity = scene.direction.normalized()}).force);
      pull *= scene.target / reach(sample, Phi * compliance.cwiseProduct(Phi.transpose() * pull));
      // large motions are not proportional to the pull; a solver that misses its tolerance leaves the object behind
      for (int moved = 0, tries = 0; moved < 3 && tries < 12; ++tries) {
        const PulledMotion motion = move(sample, pulls_.size() - 1);
        pull *= motion.missed_steps == 0 ? scene.target / reach(sample, motion.q) : 0.5;
        moved += motion.missed_steps == 0;
      }
    }
  }

  const std::vector<PullScene>& scenes() const { return scenes_; }
  double step() const { return 2 * std::numbers::pi / omega_ / 60; }  ///< [s]

  PulledMotion move(const System& system, std::size_t scene, const NonlinearSolver& solver = Bfgs{}) const;
  /// Motions in all scenes, by all threads.
  std::vector<PulledMotion> move(const System& system) const {
    std::vector<PulledMotion> motions(scenes_.size());
    parallel_for(static_cast<Index>(scenes_.size()), [&](Index k) { motions[k] = move(system, k); });
    return motions;
  }

  /// Largest displacement of a node in a motion, as a share of the diagonal.
  double reach(const System& system, const Matrix& q) const {
    double largest = 0;
    for (Index j = 0; j < q.cols(); ++j) {
      const Vector u = system.expand(q.col(j));
      largest = std::max(largest, Eigen::Map<const Points>(u.data(), u.size() / 3, 3).rowwise().norm().maxCoeff());
    }
    return largest / diagonal_;
  }

 private:
  std::vector<PullScene> scenes_;
  double omega_, diagonal_;
  std::vector<Vector> pulls_;  // reduced forces, d
};

/// ‖q − q*‖ / ‖q*‖ over all steps: the mass-weighted L² distance of the displacements, relative.
inline double deviation(const PulledMotion& motion, const PulledMotion& reference) {
  return (motion.q - reference.q).norm() / reference.q.norm();
}

// ---------------------------------------------------------------------------------------------------------------------

template <ObjectSystem System>
PulledMotion PullTest<System>::move(const System& system, std::size_t index, const NonlinearSolver& solver) const {
  const PullScene& scene = scenes_[index];
  const RayleighDamping damping{.alpha = scene.damping * omega_, .beta = scene.damping / omega_};
  Newmark newmark(system, step(), {.damping = damping, .solver = solver});
  State state = State::at_rest(system.dim());
  const auto load_at = [&](int step) {
    const double share = scene.ramp > 0 ? std::min(1.0, step / scene.ramp) : 1.0;
    return SystemLoad<Matrix>{share * pulls_[index], {}};
  };
  newmark.balance(load_at(0), state);
  PulledMotion motion;
  motion.q.resize(system.dim(), scene.steps);
  for (int k = 0; k < scene.steps; ++k) {
    const auto load = load_at(k + 1);
    const Stopwatch watch;
    const StepReport report = newmark.step(load, state);
    motion.seconds.push_back(watch.seconds());
    motion.iterations += static_cast<double>(report.iterations) / scene.steps;
    motion.refreshes += static_cast<double>(report.tangents) / scene.steps;
    motion.worst_residual = std::max(motion.worst_residual, report.residual);
    motion.missed_steps += report.status != Status::Converged;
    motion.q.col(k) = state.u;
  }
  return motion;
}

}  // namespace supple
