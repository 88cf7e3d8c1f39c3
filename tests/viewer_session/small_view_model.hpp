#pragma once
/// \file Small model for the tests of viewers: a bar of tets, clamped or free.

#include <io/builtin/builtin_meshes.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <viewer/session/scaled_system.hpp>
#include <viewer/session/view_model.hpp>

#include <memory>

namespace supple::test {

inline std::shared_ptr<const ViewModel> make_small_view_model(bool clamped) {
  TetMesh mesh = std::get<TetMesh>(builtin_solid_mesh("bar:6x2x2"));
  std::vector<Index> held;
  for (Index v = 0; clamped && v < mesh.num_nodes(); ++v)
    if (mesh.nodes(v, 0) < 1e-9) held.push_back(v);
  const Solid solid = isotropic_solid(std::move(mesh), {.young = 1e5, .poisson = 0.3}, held, "stvk");
  ReduceOptions options{.modes = 9, .points = 60};
  options.poses.count = 40;
  options.held_out_poses = 0;
  options.equilibria = 0;
  return std::make_shared<const ViewModel>(reduce(solid, options), "bar");
}

/// 1 m long, clamped at x = 0; made once.
inline std::shared_ptr<const ViewModel> clamped_view_model() {
  static const auto model = make_small_view_model(true);
  return model;
}
inline std::shared_ptr<const ViewModel> free_view_model() {
  static const auto model = make_small_view_model(false);
  return model;
}

/// A system that tells of more energy than its forces have.
class BoastfulSystem : public ScaledSystem {
 public:
  explicit BoastfulSystem(AnySystem<Matrix> system) : ScaledSystem(std::move(system), 1) {}
  double energy(VectorIn q) const { return 5 * ScaledSystem::energy(q); }
};

/// The clamped bar, where no step that leads far is sound.
inline std::shared_ptr<const ViewModel> boastful_view_model() {
  auto model = std::make_shared<ViewModel>(*clamped_view_model());
  model->system = AnySystem<Matrix>(std::make_shared<const BoastfulSystem>(model->system));
  return model;
}

/// The node of the surface that is nearest to a point.
inline Index surface_node_near(const ViewModel& model, const Point& x) {
  Index node = 0;
  (model.geometry.rest.topRows(model.geometry.num_surface_nodes).rowwise() - x.transpose())
      .rowwise()
      .squaredNorm()
      .minCoeff(&node);
  return node;
}

/// Nodes of the surface that a rule of the first coordinate chooses, as a share of the length.
inline std::vector<Index> surface_nodes_where(const ViewModel& model, auto rule) {
  std::vector<Index> nodes;
  const double low = model.box.lower[0], length = model.box.extent()[0];
  for (Index k = 0; k < model.geometry.num_surface_nodes; ++k)
    if (rule((model.geometry.rest(k, 0) - low) / length)) nodes.push_back(k);
  return nodes;
}

/// Where a node of the geometry is [m].
inline Point place_of(const ViewModel& model, VectorIn q, Index node) {
  return model.geometry.rest.row(node).transpose() + model.system.displacement(q, model.geometry.nodes[node]);
}

}  // namespace supple::test
