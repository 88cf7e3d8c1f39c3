#pragma once
/// \file Ladder of models of one object, coarse to fine: what a sweep measures and a goal chooses from.

#include <physics/body/body.hpp>
#include <reduction/pipeline/reduce_options.hpp>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A model that could be made.
struct ModelRung {
  ReduceOptions options;
  Index dimension = 0;  ///< d, about
};

/// Models of an object, in the order of relative_step_time(), as far as it has unknowns and components for them; at
/// least one. Solids: modal derivatives with (modes, d, s) = (10, 30, 40), (15, 60, 80), (20, 90, 120), 15 extended modes with
/// s = 150, derivatives (30, 135, 180). Shells: derivatives (10, 30, 80), (15, 60, 160), (20, 90, 240), 15 extended modes with
/// s = 150, 250, 400. Derivatives of free objects have 12 more dimensions, and points for them.
/// \param options  whatever is not of the subspace or the number of points.
/// \see docs/decisions/0016-relaxed-forces.md for what d and s of derivatives are worth.
std::vector<ModelRung> model_ladder(const Body& body, const ReduceOptions& options);

/// Subspace and size of a model in words: "derivatives:num_derivatives=70:modes=20:points=120".
std::string in_words(const ReduceOptions& options);

/// What such words say; what they leave open follows from a recipe.
struct ModelWords {
  std::string subspace;  ///< with its own options
  std::optional<Index> modes, dimension, points;

  /// \throws std::invalid_argument for a number that is none, an option that comes twice, or an unknown subspace.
  static ModelWords parse(std::string_view text);
};

/// Time of a step, relative to other models in subspaces of one kind: 1500 + s d + d² for what a step does anyway, the forces
/// and the solver. Of derivatives it grows by 1 : 2.7 : 5.7 : 12 over the ladder, where steps of a bar of 192 tets took 1 : 2.1
/// : 4.8 and those of an octopus of 95 003 tets, with more and more iterations, 1 : 3.0 : 7.5 : 14.
double relative_step_time(Index dimension, Index points);

}  // namespace supple
