#pragma once
/// \file Thin plates that the tests of the reduction floor share.

#include <physics/mesh/mass.hpp>
#include <physics/model/discrete_shell.hpp>
#include <physics/system/full_system.hpp>
#include <tests/support/meshes.hpp>

namespace supple::test {

using Plate = FullSystem<DiscreteShell>;

/// 4 rows of 12 triangles with edges of about 0.1 m in the plane z = 0, 1 cm thick; held along x = 0 or free.
inline Plate plate(bool held) {
  TriangleMesh mesh = perturbed(equilateral_grid(6, 4, 0.1), 0.01, 5);
  mesh.nodes.col(2).setZero();
  const std::vector<Index> side = nodes_where(mesh, [](const Point& x) { return x[0] < 0.08; });
  return {DiscreteShell(mesh, ShellMaterial::from({.young = 1e6, .poisson = 0.35}, 0.01)),
          lumped_mass(mesh, 1000.0, 0.01), held ? side : std::vector<Index>{}};
}
inline Plate held_plate() {
  return plate(true);
}
inline Plate free_plate() {
  return plate(false);
}

}  // namespace supple::test
