#pragma once
/// \file Material laws by name: what commands, files and plug-ins choose from.

#include <core/registry.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/model/any_model.hpp>
#include <physics/model/solid_elasticity.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// A material law of solids, its type erased.
struct MaterialLaw {
  using Named = std::map<std::string, double>;

  std::string name;
  std::string description = {};         ///< a few words, for helps
  std::vector<std::string> parameters;  ///< names, in the order of the material's members
  bool finite_when_inverted = true;     ///< whether the energy of an inverted element is finite

  /// Values of the parameters that agree at rest with the moduli.
  std::function<std::vector<double>(const IsotropicModuli&)> from;
  /// What is wrong with such values; empty if nothing is.
  std::function<std::string(const std::vector<double>&)> objection;
  /// The model of a mesh. \param materials  one row a material.  \param of_tet  the row of each tet; empty: the first.
  std::function<std::shared_ptr<const AnyModel<4>>(const TetMesh& mesh, const RowMatrix& materials,
                                                   const std::vector<std::int32_t>& of_tet)>
      tets;
  /// The same of other cells, with cells or single Gauss points as components. Empty where `tets` is an element of its own,
  /// which knows no others.
  template <typename Mesh>
  using CellModel = std::function<std::shared_ptr<const AnyModel<Mesh::nodes_per_cell>>(
      const Mesh& mesh, const RowMatrix& materials, const std::vector<std::int32_t>& of_cell,
      SolidComponent component)>;
  CellModel<HexMesh> hexahedra = {};
  CellModel<QuadraticTetMesh> quadratic_tets = {};
  /// Poisson's ratio at rest of such values, see poisson_at_rest(). Empty where a law does not tell.
  std::function<double(const std::vector<double>&)> poisson = {};
  /// ψ(F) [J/m³] of such values, and P = ∂ψ/∂F [Pa]. Empty where a law does not tell.
  std::function<double(const std::vector<double>&, const Matrix3<double>& F, Matrix3<double>& P)> response = {};

  /// Those that agree with the moduli, with some replaced by name.
  /// \throws std::invalid_argument for a name that the law does not have, for values of which rest is no stable
  /// equilibrium, and as from().
  std::vector<double> values(const IsotropicModuli& moduli, const Named& replaced = {}) const;
};

/// A law by name. \throws std::invalid_argument naming those that there are.
const MaterialLaw& material_law(std::string_view name);
/// Names: "stvk", "mooney-rivlin", "neo-hookean", "stable-neo-hookean", "corotational", "ogden", "fung" and what was added.
std::vector<std::string> material_laws();
/// All of them; what the functions above look into.
Registry<MaterialLaw>& material_law_registry();
/// Adds a law for this process. \throws std::invalid_argument if there is one of this name.
void add_material_law(MaterialLaw law);

/// One material a cell, or one for all, of rows of parameters.
/// \throws std::invalid_argument for another number of parameters and a row that does not exist.
template <template <typename> class Material>
std::vector<Material<double>> materials_of_cells(Index num_cells, const RowMatrix& rows,
                                                 const std::vector<std::int32_t>& of_cell) {
  constexpr std::size_t num_parameters = num_material_parameters<Material>;
  require_size("parameters of the material", rows.cols(), static_cast<Index>(num_parameters));
  std::vector<Material<double>> materials;
  for (Index k = 0; k < rows.rows(); ++k) {
    std::array<double, num_parameters> values;
    for (std::size_t j = 0; j < num_parameters; ++j) values[j] = rows(k, static_cast<Index>(j));
    materials.push_back(material_of<Material>(values));
  }
  if (of_cell.empty()) {
    require_size("number of materials", rows.rows(), 1);
    return materials;
  }
  require_size("material of each cell", static_cast<Index>(of_cell.size()), num_cells);
  std::vector<Material<double>> result;
  result.reserve(of_cell.size());
  for (const std::int32_t k : of_cell) {
    require(k >= 0 && k < rows.rows(),
            "material " + std::to_string(k) + " does not exist, expected 0 to " + std::to_string(rows.rows() - 1));
    result.push_back(materials[k]);
  }
  return result;
}

/// The material with these values of its parameters. \throws std::invalid_argument for another number of them.
template <template <typename> class Material>
Material<double> material_with(const std::vector<double>& values) {
  std::array<double, num_material_parameters<Material>> parameters;
  require_size("parameters of the material", static_cast<Index>(values.size()), static_cast<Index>(parameters.size()));
  std::ranges::copy(values, parameters.begin());
  return material_of<Material>(parameters);
}

/// Why a material is not fit to be reduced: energy at rest not a number, stress at rest, or a tangent there that is not
/// positive semi-definite. Empty if it is fit.
template <template <typename> class Material>
std::string objection_to(const Material<double>& material) {
  const Matrix3<double> rest = Matrix3<double>::Identity();
  if (!std::isfinite(material.energy(rest))) return "the energy at rest is not finite";
  const Matrix3<double> P = stress(material, rest);
  const Matrix9<double> C = tangent(material, rest);
  if (!P.allFinite() || !C.allFinite()) return "stress or tangent at rest are not finite";
  if (P.norm() > 1e-9 * C.norm()) return "there is stress at rest";
  if (symmetric_eigenvalues(C)[0] < -1e-9 * C.norm()) return "the rest state is not stable";
  if (C.isZero(0)) return "it resists nothing";
  return "";
}

/// Poisson's ratio of a material at rest, (3 κ − 2 μ) / (6 κ + 2 μ) with κ what resists changes of volume and μ what resists
/// shear, the mean over all of its five directions where the material is anisotropic.
template <template <typename> class Material>
double poisson_at_rest(const Material<double>& material) {
  const Matrix9<double> C = tangent(material, Matrix3<double>::Identity());
  double bulk = 0, trace = 0;  // of C over all symmetric strains: 3 κ + 5 · 2 μ
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int ij = i + 3 * j, ji = j + 3 * i;
      bulk += C(4 * i, 4 * j) / 9;
      trace += 0.5 * (C(ij, ij) + C(ij, ji));
    }
  const double shear = (trace - 3 * bulk) / 10;
  return (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear);
}

/// The model of a mesh, its type erased; see MaterialLaw::tets.
template <template <typename> class Material, SolidComponent component = SolidComponent::Element, typename Mesh>
auto erased_solid(const Mesh& mesh, const RowMatrix& materials, const std::vector<std::int32_t>& of_cell) {
  using Model = SolidElasticity<ElementOf<Mesh>, Material, component>;
  return std::make_shared<const AnyModel<Model::stencil_size>>(
      std::make_shared<const Model>(mesh, materials_of_cells<Material>(mesh.num_cells(), materials, of_cell)));
}

/// The law of a material. `Material` says, beside its formulas (see materials.hpp), the names of its parameters,
/// `static constexpr std::array parameter_names{"mu", …}`, and how they follow from moduli, `static Material
/// from(const IsotropicModuli&)`.
template <template <typename> class Material>
MaterialLaw make_material_law(std::string name, std::string description = "") {
  constexpr auto& names = Material<double>::parameter_names;
  static_assert(std::size(names) == num_material_parameters<Material>, "parameter_names must name every member");
  const Matrix3<double> inverted = Point(-0.5, 1, 1).asDiagonal();
  const auto cells = [](const auto& mesh, const RowMatrix& materials, const std::vector<std::int32_t>& of_cell,
                        SolidComponent component) {
    return component == SolidComponent::GaussPoint
               ? erased_solid<Material, SolidComponent::GaussPoint>(mesh, materials, of_cell)
               : erased_solid<Material>(mesh, materials, of_cell);
  };
  return {
      .name = std::move(name),
      .description = std::move(description),
      .parameters = {names.begin(), names.end()},
      .finite_when_inverted = std::isfinite(Material<double>::from(IsotropicModuli{}).energy(inverted)),
      .from =
          [](const IsotropicModuli& moduli) {
            const auto values = parameters_of(Material<double>::from(moduli));
            return std::vector<double>(values.begin(), values.end());
          },
      .objection =
          [](const std::vector<double>& values) { return objection_to<Material>(material_with<Material>(values)); },
      .tets = [](const TetMesh& mesh, const RowMatrix& materials,
                 const std::vector<std::int32_t>& of_tet) { return erased_solid<Material>(mesh, materials, of_tet); },
      .hexahedra = cells,
      .quadratic_tets = cells,
      .poisson =
          [](const std::vector<double>& values) { return poisson_at_rest<Material>(material_with<Material>(values)); },
      .response =
          [](const std::vector<double>& values, const Matrix3<double>& F, Matrix3<double>& P) {
            const auto material = material_with<Material>(values);
            P = stress(material, F);
            return material.energy(F);
          },
  };
}

}  // namespace supple
