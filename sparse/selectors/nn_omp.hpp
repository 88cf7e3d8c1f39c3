#pragma once
/// \file Growth over all columns: non-negative orthogonal matching pursuit, and the energy-conserving variant
/// of hyper-reduction.

#include <sparse/selectors/greedy.hpp>

namespace supple {

/// Non-negative orthogonal matching pursuit: adds the column of the best direction among all, and refits by
/// NNLS.
/// \note one Aᵀ r over all columns a step, without evaluating them for a FullGradientProblem.
/// \see Bruckstein, Elad & Zibulevsky 2008; Yaghoobi, Wu & Davies 2015.
struct NnOmp {
  double tolerance = 0;  ///< stop at this relative error, if the request has none
  /// Share of s to grow to before pruning back to s by backward elimination: 1.3 lowers the error a little
  /// further.
  double overshoot = 1;
  Index batch = 1;  ///< columns added in each step: more for few expensive gradients
  /// Columns looked at in each step, drawn at random; default all.
  Index candidates = std::numeric_limits<Index>::max();
  std::uint64_t seed = 0;

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(overshoot >= 1, "overshoot is less than 1, expected 1 to 2");
    require(batch >= 1 && candidates >= 1, "batch or candidates is less than 1");
    return grow({.tolerance = tolerance,
                 .candidates = candidates,
                 .batch = batch,
                 .largest_size = share(overshoot, std::min(request.size, problem.cols())),
                 .measure = Measure::Cosine,
                 .seed = seed},
                problem, request);
  }
};

/// Energy-conserving sampling and weighting: the active-set method of Lawson and Hanson on all columns,
/// stopped early, when the error has its target. The largest entry of Aᵀ r enters, so that large components
/// come first.
/// \note as NnOmp.
/// \see Farhat et al. 2014; Chapman et al. 2017; Lawson & Hanson 1974.
struct Ecsw {
  /// stop at this relative error, if the request has none; in the literature 0.01
  double tolerance = 0;
  std::uint64_t seed = 0;  ///< nothing here is random

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    return grow({.tolerance = tolerance,
                 .candidates = problem.cols(),
                 .batch = 1,
                 .largest_size = 0,
                 .measure = Measure::Correlation,
                 .seed = seed},
                problem, request);
  }
};

static_assert(SubsetSelector<NnOmp> && SubsetSelector<Ecsw>);

}  // namespace supple
