#pragma once
/// \file Bars of irregular tets that the tests of the reduction floor share.

#include <physics/mesh/mass.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <tests/support/meshes.hpp>

namespace supple::test {

/// 6 × 2 × 2 cubes of 0.1 m, their nodes moved a little so that nothing is symmetric.
inline TetMesh bar_mesh() {
  return perturbed(kuhn_box(6, 2, 2, 0.1), 0.01, 7);
}
/// The nodes of its end at x = 0.
inline std::vector<Index> bar_end(const TetMesh& mesh) {
  return nodes_where(mesh, [](const Point& x) { return x[0] < 0.05; });
}

using StvkBar = FullSystem<TetElasticity<StVenantKirchhoff>>;
inline StvkBar stvk_bar(const std::vector<Index>& fixed_nodes) {
  const TetMesh mesh = bar_mesh();
  return {TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.35})),
          lumped_mass(mesh, 1000.0), fixed_nodes};
}
inline StvkBar clamped_bar() {
  return stvk_bar(bar_end(bar_mesh()));
}
inline StvkBar free_bar() {
  return stvk_bar({});
}

/// Two bars apart from each other: the first clamped or free, the second free.
inline StvkBar two_bars(bool first_is_clamped) {
  TetMesh mesh = bar_mesh();
  const TetMesh other = perturbed(kuhn_box(2, 2, 3, 0.1), 0.01, 9);
  const Index n = mesh.num_nodes();
  const std::vector<Index> fixed = first_is_clamped ? bar_end(mesh) : std::vector<Index>{};
  mesh.nodes.conservativeResize(n + other.num_nodes(), 3);
  mesh.nodes.bottomRows(other.num_nodes()) = other.nodes.rowwise() + Eigen::RowVector3d(2, 1, 0);
  for (Tet tet : other.cells) {
    for (Index& v : tet) v += n;
    mesh.cells.push_back(tet);
  }
  return {TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.35})),
          lumped_mass(mesh, 1000.0), fixed};
}
inline StvkBar clamped_and_free_bars() {
  return two_bars(true);
}
inline StvkBar free_bars() {
  return two_bars(false);
}

/// All components, each with weight one.
inline std::vector<Index> all_components(Index count) {
  std::vector<Index> all(count);
  for (Index i = 0; i < count; ++i) all[i] = i;
  return all;
}

}  // namespace supple::test
