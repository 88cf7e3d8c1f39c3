#pragma once
/// \file Lumped masses and heat capacities.

#include <core/check.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/mesh/elements.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <string>

namespace supple {

/// Mass of each node [kg], n: a quarter of the mass of each tet around it; the sum is the mass of the object.
/// \param density [kg/m³], one for all tets or one a tet; > 0.
Vector lumped_mass(const TetMesh& mesh, VectorIn density);
Vector lumped_mass(const TetMesh& mesh, double density);

/// Heat capacity of each node [J/K], n, likewise. \param density [kg/m³], > 0. \param specific_heat [J/(kg K)], > 0.
Vector lumped_heat_capacity(const TetMesh& mesh, double density, double specific_heat);

/// Mass of each node [kg], n, of a solid of any element: the mass of each cell, shared by its nodes as the
/// element's MassLumping says. All are > 0 and the sum is the mass of the object, by the element's
/// mass_points. \param density [kg/m³], one for all cells or one a cell; > 0. \throws std::invalid_argument
/// for other densities, and for cells as SolidElasticity does.
template <SolidElement Element>
Vector lumped_mass(const CellMesh<Element::num_nodes>& mesh, VectorIn density) {
  if (density.size() != 1) require_size("density", density.size(), mesh.num_cells());
  Vector mass = Vector::Zero(mesh.num_nodes());
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    const double rho = density[density.size() == 1 ? 0 : e];
    if (!(rho > 0))
      throw std::invalid_argument("density of " + std::string(Element::name) + " " + std::to_string(e) + " is " +
                                  std::to_string(rho) + " kg/m^3, expected > 0");
    const auto points =
        cell_points<Element>(cell_positions<Element>(mesh.nodes, mesh.cells, e), e, Element::mass_points);
    Local<Element::num_nodes> share = Local<Element::num_nodes>::Zero();
    double volume = 0;
    for (std::size_t g = 0; g < points.size(); ++g) {
      const QuadraturePoint& at = Element::mass_points[g];
      const Local<Element::num_nodes> N = Element::shape(Point(at.xi[0], at.xi[1], at.xi[2]));
      const double volume_g = at.weight * points[g].det_J;
      volume += volume_g;
      share += volume_g * (Element::lumping == MassLumping::RowSum ? N : Local<Element::num_nodes>(N.cwiseAbs2()));
    }
    share *= rho * volume / share.sum();
    for (int a = 0; a < Element::num_nodes; ++a) mass[mesh.cells[e][a]] += share[a];
  }
  return mass;
}
template <SolidElement Element>
Vector lumped_mass(const CellMesh<Element::num_nodes>& mesh, double density) {
  return lumped_mass<Element>(mesh, Vector::Constant(1, density));
}

/// Mass of each node [kg] of a shell, n: a third of the mass of each triangle around it, density · thickness
/// · area. \param density    [kg/m³], one for all triangles or one a triangle; > 0. \param thickness  [m],
/// likewise.
Vector lumped_mass(const TriangleMesh& mesh, VectorIn density, VectorIn thickness);
Vector lumped_mass(const TriangleMesh& mesh, double density, double thickness);

}  // namespace supple
