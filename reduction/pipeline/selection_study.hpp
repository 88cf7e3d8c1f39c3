#pragma once
/// \file Study of many selections on one problem: what each is worth beyond its training error.

#include <core/progress.hpp>
#include <physics/body/body.hpp>
#include <reduction/pipeline/reduce_options.hpp>
#include <reduction/training/pull_scene.hpp>
#include <sparse/problem/any_problem.hpp>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace supple {

/// A selection, measured with the weights that reduce() would refit. NaN where it was not asked for or cannot be told
/// (motions with negative weights).
struct SelectionMeasure {
  std::vector<std::pair<double, double>> held_out;  ///< share of the amplitude (1, 0.3, 0.1) and error
  double softest_eigenvalue = 0;                    ///< of the fitted stiffness at rest, relative to the exact one
  std::vector<double> trajectory_errors;            ///< one for each scene
  double force_seconds = 0;                         ///< of one evaluation of the reduced force, median
};

/// The fitting problem that reduce() would solve for a solid, held once for many selectors. The selector,
/// points and target_error of the options play no role.
class SelectionStudy {
 public:
  /// \param scenes  pulls whose trajectories are compared; the reference evaluates all components, which
  /// takes minutes for 10⁵ of them. None by default.
  SelectionStudy(const Body& body, const ReduceOptions& options, std::vector<PullScene> scenes = {},
                 const Progress& progress = {});
  ~SelectionStudy();
  SelectionStudy(SelectionStudy&&) noexcept;
  SelectionStudy& operator=(SelectionStudy&&) noexcept;

  const AnyProblem& problem() const;  ///< on the training poses; refers to the study
  /// On held-out poses at the full amplitude; NaN if there are none.
  double held_out_error(const std::vector<Index>& indices, VectorIn weights) const;
  SelectionMeasure measure(const Selection& selection) const;

  const ReduceReport& report() const;  ///< of the stages up to the training forces
  const std::vector<PullScene>& scenes() const;
  const std::vector<double>& largest_displacements() const;  ///< reached by the reference in each scene

 private:
  struct Interface;
  template <typename AnyTraining>
  struct Model;

  std::unique_ptr<Interface> self_;
};

}  // namespace supple
