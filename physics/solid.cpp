#include <physics/solid.hpp>

namespace supple {

Solid isotropic_solid(TetMesh mesh, const IsotropicModuli& moduli, std::vector<Index> fixed_nodes,
                      std::string_view law, double density) {
  const std::vector<double> parameters = material_law(law).values(moduli);
  Solid solid{.mesh = std::move(mesh), .law = std::string(law)};
  solid.parameters = Eigen::Map<const RowMatrix>(parameters.data(), 1, static_cast<Index>(parameters.size()));
  solid.density = Vector::Constant(1, density);
  solid.fixed_nodes = std::move(fixed_nodes);
  return solid;
}

}  // namespace supple
