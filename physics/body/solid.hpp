#pragma once
/// \file A solid object as plain data: what commands and files hand around.

#include <physics/material/moduli.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/model/solid_component.hpp>
#include <physics/system/damping.hpp>
#include <physics/system/held_axes.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A mesh with materials, density, supports and damping. Cells may have different materials of one law.
/// \tparam MeshType  TetMesh, HexMesh or QuadraticTetMesh.
template <typename MeshType>
struct SolidOf {
  using Mesh = MeshType;
  using Element = ElementOf<Mesh>;

  Mesh mesh = {};
  std::string law = "stvk";                            ///< one of material_laws()
  RowMatrix parameters = {};                           ///< one row a material, columns as material_law(law).parameters
  std::vector<std::int32_t> material_of_cell = {};     ///< a row of `parameters` a cell; empty: row 0 for all
  Vector density = Vector::Constant(1, 1000);          ///< [kg/m³], one for all cells or one each
  SolidComponent component = SolidComponent::Element;  ///< of its force model; a linear tet is its one Gauss point
  std::vector<Index> fixed_nodes = {};                 ///< ascending
  std::vector<HeldAxes> held_axes = {};                ///< of nodes that slide, ascending, none of them fixed
  RayleighDamping damping = {};

  Vector nodal_mass() const;  ///< n [kg], lumped
};

using Solid = SolidOf<TetMesh>;
using HexSolid = SolidOf<HexMesh>;
using QuadraticTetSolid = SolidOf<QuadraticTetMesh>;

/// Parameters of a law that agree at rest with the moduli, 1 × k. \throws as isotropic_solid.
RowMatrix isotropic_parameters(std::string_view law, const IsotropicModuli& moduli);

/// A solid of one material. \throws std::invalid_argument for an unknown law or impossible moduli.
/// \param mesh  a TetMesh, HexMesh or QuadraticTetMesh.  \param density  [kg/m³].
template <typename Mesh>
SolidOf<Mesh> isotropic_solid(Mesh mesh, const IsotropicModuli& moduli, std::vector<Index> fixed_nodes = {},
                              std::string_view law = "stvk", double density = 1000) {
  SolidOf<Mesh> solid{.mesh = std::move(mesh), .law = std::string(law)};
  solid.parameters = isotropic_parameters(law, moduli);
  solid.density = Vector::Constant(1, density);
  solid.fixed_nodes = std::move(fixed_nodes);
  return solid;
}

}  // namespace supple
