#include <physics/shell.hpp>

namespace supple {

Shell isotropic_shell(TriangleMesh mesh, const IsotropicModuli& moduli, double thickness,
                      std::vector<Index> fixed_nodes, double density) {
  return {.mesh = std::move(mesh),
          .materials = {ShellMaterial::from(moduli, thickness)},
          .thickness = Vector::Constant(1, thickness),
          .density = Vector::Constant(1, density),
          .fixed_nodes = std::move(fixed_nodes)};
}

}  // namespace supple
