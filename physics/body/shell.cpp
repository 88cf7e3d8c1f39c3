#include <physics/body/mass_everywhere.hpp>
#include <physics/body/shell.hpp>
#include <physics/mesh/mass.hpp>

namespace supple {

Vector Shell::nodal_mass() const {
  return mass_everywhere(lumped_mass(mesh, density, thickness));
}

Shell isotropic_shell(TriangleMesh mesh, const IsotropicModuli& moduli, double thickness,
                      std::vector<Index> fixed_nodes, double density) {
  return {.mesh = std::move(mesh),
          .materials = {ShellMaterial::from(moduli, thickness)},
          .thickness = Vector::Constant(1, thickness),
          .density = Vector::Constant(1, density),
          .fixed_nodes = std::move(fixed_nodes)};
}

}  // namespace supple
