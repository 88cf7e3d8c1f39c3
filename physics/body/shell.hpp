#pragma once
/// \file A shell as plain data: what commands and files hand around.

#include <physics/material/shell_material.hpp>
#include <physics/mesh/triangle_mesh.hpp>
#include <physics/system/damping.hpp>
#include <physics/system/held_axes.hpp>

#include <vector>

namespace supple {

/// A surface with materials, thickness, density, supports and damping.
struct Shell {
  TriangleMesh mesh;
  std::vector<ShellMaterial> materials = {};     ///< one for all triangles, or one each
  Vector thickness = Vector::Constant(1, 0.01);  ///< [m], one for all triangles or one each; what the mass needs
  Vector density = Vector::Constant(1, 1000);    ///< [kg/m³], one for all triangles or one each
  std::vector<Index> fixed_nodes = {};           ///< ascending
  std::vector<HeldAxes> held_axes = {};          ///< of nodes that slide, ascending, none of them fixed
  RayleighDamping damping = {};

  Vector nodal_mass() const;  ///< n [kg], lumped
};

/// A shell of one material. \throws std::invalid_argument for impossible moduli or thickness.
/// \param thickness  [m].  \param density  [kg/m³].
Shell isotropic_shell(TriangleMesh mesh, const IsotropicModuli& moduli, double thickness,
                      std::vector<Index> fixed_nodes = {}, double density = 1000);

}  // namespace supple
