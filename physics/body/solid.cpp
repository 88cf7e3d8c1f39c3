#include <physics/body/mass_everywhere.hpp>
#include <physics/body/material_law.hpp>
#include <physics/body/solid.hpp>
#include <physics/mesh/mass.hpp>

namespace supple {

template <typename Mesh>
Vector SolidOf<Mesh>::nodal_mass() const {
  if constexpr (std::same_as<Mesh, TetMesh>)
    return mass_everywhere(lumped_mass(mesh, density));
  else
    return mass_everywhere(lumped_mass<Element>(mesh, density));
}
template struct SolidOf<TetMesh>;
template struct SolidOf<HexMesh>;
template struct SolidOf<QuadraticTetMesh>;

RowMatrix isotropic_parameters(std::string_view law, const IsotropicModuli& moduli) {
  const std::vector<double> values = material_law(law).values(moduli);
  return Eigen::Map<const RowMatrix>(values.data(), 1, static_cast<Index>(values.size()));
}

}  // namespace supple
