#pragma once
/// \file A solid object as plain data: what commands and files hand around.

#include <core/check.hpp>
#include <physics/mass.hpp>
#include <physics/newmark.hpp>
#include <physics/tet_elasticity.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A mesh with materials, density, supports and damping. Tets may have different materials of one law.
struct Solid {
  TetMesh mesh;
  std::string law = "stvk";  ///< one of material_laws()
  RowMatrix parameters = {};  ///< one row a material, columns in the order of the law's members [Pa]
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

/// "stvk" (St. Venant–Kirchhoff) and "mooney-rivlin".
const std::vector<std::string>& material_laws();

/// The law's parameters that agree with these moduli at rest, in the order of its members.
/// \param mooney_share  c₀₁ / (c₁₀ + c₀₁), for Mooney–Rivlin only.
/// \throws std::invalid_argument for an unknown law or impossible moduli.
std::vector<double> law_parameters(std::string_view law, const IsotropicModuli& moduli,
                                   double mooney_share = 0.25);

/// Calls visit.template operator()<Material>() with the class template of the law.
template <typename Visitor>
decltype(auto) with_law(std::string_view law, Visitor&& visit) {
  if (law == "stvk") return visit.template operator()<StVenantKirchhoff>();
  if (law == "mooney-rivlin") return visit.template operator()<MooneyRivlin>();
  std::string known;
  for (const std::string& name : material_laws()) known += (known.empty() ? "" : ", ") + name;
  throw std::invalid_argument("material law '" + std::string(law) + "' is not known, expected one of " +
                              known);
}

/// The force model of a solid whose law is `Material`.
template <template <typename> class Material>
TetElasticity<Material> make_model(const Solid& solid) {
  constexpr Index num_parameters = sizeof(Material<double>) / sizeof(double);
  require_size("solid.parameters.cols()", solid.parameters.cols(), num_parameters);
  std::vector<Material<double>> materials;
  for (Index k = 0; k < solid.parameters.rows(); ++k) {
    std::array<double, num_parameters> row;
    for (Index j = 0; j < num_parameters; ++j) row[j] = solid.parameters(k, j);
    materials.push_back(std::bit_cast<Material<double>>(row));
  }
  if (solid.material_of_tet.empty()) {
    require_size("solid.parameters.rows()", solid.parameters.rows(), 1);
    return {solid.mesh, materials};
  }
  require_size("solid.material_of_tet", static_cast<Index>(solid.material_of_tet.size()),
               solid.mesh.num_tets());
  std::vector<Material<double>> of_tet;
  of_tet.reserve(solid.material_of_tet.size());
  for (const std::int32_t k : solid.material_of_tet) {
    require(k >= 0 && k < solid.parameters.rows(), "material " + std::to_string(k) +
                                                       " does not exist, expected 0 to " +
                                                       std::to_string(solid.parameters.rows() - 1));
    of_tet.push_back(materials[k]);
  }
  return {solid.mesh, of_tet};
}

}  // namespace supple
