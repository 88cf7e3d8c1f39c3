#pragma once
/// \file Small irregular meshes of every element type, and solids on them.

#include <physics/mesh/cell_mesh.hpp>
#include <physics/mesh/elements.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/solid_elasticity.hpp>
#include <tests/support/meshes.hpp>

#include <numbers>

namespace supple::test {

inline constexpr IsotropicModuli rubber{.young = 1e5, .poisson = 0.35};

/// A box of cells, `cells` along each axis of its extent, nodes not moved yet.
template <typename Element>
CellMesh<Element::num_nodes> box_of(const std::array<Index, 3>& cells, double edge) {
  const auto [nx, ny, nz] = cells;
  if constexpr (std::same_as<Element, TrilinearHex>)
    return hex_box(nx, ny, nz, edge * Point(static_cast<double>(nx), static_cast<double>(ny), static_cast<double>(nz)));
  else if constexpr (std::same_as<Element, QuadraticTet>)
    return quadratic_mesh(kuhn_box(nx, ny, nz, edge));
  else
    return kuhn_box(nx, ny, nz, edge);
}

/// Mid-edge nodes back amid their corners.
inline void straighten(QuadraticTetMesh& mesh) {
  for (const auto& cell : mesh.cells)
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = QuadraticTet::edges[k];
      mesh.nodes.row(cell[4 + k]) = (mesh.nodes.row(cell[a]) + mesh.nodes.row(cell[b])) / 2;
    }
}
template <int n>
void straighten(CellMesh<n>&) {}

/// The same with every node moved at random: hexes with curved faces, quadratic tets with curved edges.
template <typename Element>
CellMesh<Element::num_nodes> irregular_box(const std::array<Index, 3>& cells, double edge, std::uint64_t seed = 21) {
  return perturbed(box_of<Element>(cells, edge), (std::same_as<Element, QuadraticTet> ? 0.05 : 0.1) * edge, seed);
}

/// A few irregular cells, a material for each: for conformance suites.
template <typename Element_, template <typename> class Material, SolidComponent component>
struct CellBar {
  using Element = Element_;
  using Model = SolidElasticity<Element, Material, component>;
  static constexpr bool is_quadratic = std::same_as<Element, QuadraticTet>;
  static constexpr double length = 0.1;  // a quadratic tet has two nodes an edge
  static CellMesh<Element::num_nodes> mesh() {
    return irregular_box<Element>({std::same_as<Element, TrilinearHex> ? 2 : 1, 1, 1}, (is_quadratic ? 2 : 1) * length);
  }
  static Model make() {
    std::vector<Material<double>> materials;
    for (Index e = 0; e < mesh().num_cells(); ++e) {
      const double k = static_cast<double>(e);
      materials.push_back(Material<double>::from({.young = 1e5 * (1 + k), .poisson = 0.2 + 0.02 * k}));
    }
    return {mesh(), materials};
  }
  static Vector nodal_mass() { return lumped_mass<Element>(mesh(), 1000.0); }
};

}  // namespace supple::test
