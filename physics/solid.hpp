#pragma once
/// \file A solid object as plain data: what commands and files hand around.

#include <physics/mass.hpp>
#include <physics/material_law.hpp>
#include <physics/newmark.hpp>
#include <physics/tet_elasticity.hpp>

#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A mesh with materials, density, supports and damping. Cells may have different materials of one law.
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
  RayleighDamping damping = {};

  Vector nodal_mass() const {  ///< n [kg]
    if constexpr (std::same_as<Mesh, TetMesh>)
      return lumped_mass(mesh, density);
    else
      return lumped_mass<Element>(mesh, density);
  }
};

using Solid = SolidOf<TetMesh>;
using HexSolid = SolidOf<HexMesh>;
using QuadraticTetSolid = SolidOf<QuadraticTetMesh>;

/// A solid of one material. \throws std::invalid_argument for an unknown law or impossible moduli.
/// \param mesh  a TetMesh, HexMesh or QuadraticTetMesh.  \param density  [kg/m³].
template <typename Mesh>
SolidOf<Mesh> isotropic_solid(Mesh mesh, const IsotropicModuli& moduli, std::vector<Index> fixed_nodes = {},
                              std::string_view law = "stvk", double density = 1000) {
  const std::vector<double> parameters = material_law(law).values(moduli);
  SolidOf<Mesh> solid{.mesh = std::move(mesh), .law = std::string(law)};
  solid.parameters = Eigen::Map<const RowMatrix>(parameters.data(), 1, static_cast<Index>(parameters.size()));
  solid.density = Vector::Constant(1, density);
  solid.fixed_nodes = std::move(fixed_nodes);
  return solid;
}

/// The force model of a solid whose law is `Material`: of its own type, where the law is known when compiling.
template <template <typename> class Material, SolidComponent component = SolidComponent::Element, typename Mesh>
SolidElasticity<ElementOf<Mesh>, Material, component> make_model(const SolidOf<Mesh>& solid) {
  return {solid.mesh, materials_of_cells<Material>(num_cells(solid.mesh), solid.parameters, solid.material_of_cell)};
}

/// The force model of a solid, its law by name. \throws std::invalid_argument for data that make no model, such as cells
/// without volume or an unknown law, or one that has no model of such cells.
std::shared_ptr<const AnyModel<4>> force_model(const Solid& solid);
std::shared_ptr<const AnyModel<8>> force_model(const HexSolid& solid);
std::shared_ptr<const AnyModel<10>> force_model(const QuadraticTetSolid& solid);

}  // namespace supple
