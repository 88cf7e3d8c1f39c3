#pragma once
/// \file Reduced model made ready to be viewed: what is drawn of it, and its measures.

#include <core/types.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <reduction/model/reduced_model.hpp>
#include <reduction/system/error_estimator.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supple {

/// What a viewer draws. Its nodes are those of the surface, followed by those that only selected components have; all
/// indices here count in that list, and `nodes` leads to the mesh.
struct ViewGeometry {
  using Floats = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  std::vector<Index> nodes;   ///< indices in the mesh
  std::vector<Index> number;  ///< of each node of the mesh in `nodes`, −1 where it is not drawn
  Index num_surface_nodes = 0;
  Points rest;                      ///< positions X of the nodes [m]
  std::vector<Triangle> triangles;  ///< the surface, outward
  int block = 3;                    ///< of the basis, see KroneckerBasis
  Floats basis;                ///< the rows of W at the nodes: nodes × fields, or 3 · nodes × fields with block 1
  int component_nodes = 0;     ///< corners of a component
  std::vector<Index> corners;  ///< of all selected components in a row
  Vector weights;              ///< of these
  std::vector<Index> fixed;    ///< nodes that the model holds, ascending

  explicit ViewGeometry(const ReducedModel& model);

  Index num_nodes() const { return static_cast<Index>(nodes.size()); }
  /// Those nodes in the mesh. \throws std::invalid_argument for nodes that do not exist.
  std::vector<Index> in_mesh(const std::vector<Index>& some) const;
  /// x − X of the surface's nodes, one a row, in the precision in which they are drawn. \param q  reduced coordinates.
  Floats surface_displacements(VectorIn q) const;
};

/// A motion that was computed before, as far as it is drawn.
struct ViewRecording {
  std::string name;             ///< for people, such as "full"
  Vector time;                  ///< of each frame, ascending [s]
  ViewGeometry::Floats frames;  ///< frames × (3 · surface nodes), interleaved: x − X [m]

  Index num_frames() const { return time.size(); }
};
/// First and last time that all recordings have [s]. \pre there is one.
std::pair<double, double> common_time(const std::vector<ViewRecording>& recordings);

/// A model with what sessions and pages ask of it again and again; fixed from the start, so that several threads may read it.
struct ViewModel {
  ReducedModel model;
  std::string name;                ///< for titles
  std::vector<std::string> notes;  ///< what a user should know of it
  /// Motions of the same mesh to play again: none, one, or one and what it ought to have been.
  std::vector<ViewRecording> recordings;
  ViewGeometry geometry;
  AnySystem<Matrix> system;
  std::optional<ErrorEstimator> estimator;  ///< if the model has an indicator
  ReducedModes modes;
  double mass = 0;      ///< [kg]
  BoundingBox box;      ///< around the object at rest [m]
  double diagonal = 0;  ///< of the box [m]

  /// \throws SolverError for a model that has no flexible mode.
  /// \throws std::invalid_argument for recordings of another surface, without frames or without a time in common.
  ViewModel(ReducedModel model, std::string name, std::vector<std::string> notes = {},
            std::vector<ViewRecording> recordings = {});

  Index dim() const { return system.dim(); }
  const Points& rest() const { return node_positions(model.body); }  ///< of all nodes of the mesh [m]
  double softest_eigenvalue() const { return modes.softest_stiffness(); }
  /// How stiff the whole object is against its softest mode, λ₁ M [N/m]: the measure of springs on it.
  double softness() const { return softest_eigenvalue() * mass; }
  Index num_flexible_modes() const { return dim() - modes.num_zero; }
  /// Shape of flexible mode k, of unit mass.
  Vector mode(Index k) const { return modes.Phi.col(modes.num_zero + k); }
  double frequency(Index k) const;  ///< [Hz]
  /// A sixtieth of the softest period, and no more than a frame of a screen takes [s].
  double default_step() const;
};

}  // namespace supple
