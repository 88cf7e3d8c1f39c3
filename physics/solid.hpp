#pragma once
/// \file A solid object as plain data: what commands and files hand around.

#include <physics/mass.hpp>
#include <physics/material_law.hpp>
#include <physics/newmark.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A mesh with materials, density, supports and damping. Tets may have different materials of one law.
struct Solid {
  TetMesh mesh;
  std::string law = "stvk";  ///< one of material_laws()
  RowMatrix parameters = {};  ///< one row a material, columns as material_law(law).parameters
  std::vector<std::int32_t> material_of_tet = {};  ///< a row of `parameters` a tet; empty: row 0 for all
  Vector density = Vector::Constant(1, 1000);  ///< [kg/m³], one for all tets or one each
  std::vector<Index> fixed_nodes = {};         ///< ascending
  RayleighDamping damping = {};

  Vector nodal_mass() const { return lumped_mass(mesh, density); }  ///< n [kg]
};

/// A solid of one material. \throws std::invalid_argument for an unknown law or impossible moduli.
/// \param density  [kg/m³].
Solid isotropic_solid(TetMesh mesh, const IsotropicModuli& moduli, std::vector<Index> fixed_nodes = {},
                      std::string_view law = "stvk", double density = 1000);

/// The force model of a solid whose law is `Material`: of its own type, where the law is known when compiling.
template <template <typename> class Material>
TetElasticity<Material> make_model(const Solid& solid) {
  return {solid.mesh, materials_of_tets<Material>(solid.mesh.num_tets(), solid.parameters, solid.material_of_tet)};
}

}  // namespace supple
