#include <physics/solid.hpp>

namespace supple {

const std::vector<std::string>& material_laws() {
  static const std::vector<std::string> names{"stvk", "mooney-rivlin"};
  return names;
}

Solid isotropic_solid(TetMesh mesh, const IsotropicModuli& moduli, std::vector<Index> fixed_nodes,
                      std::string_view law, double density) {
  const std::vector<double> parameters = law_parameters(law, moduli);
  Solid solid{.mesh = std::move(mesh), .law = std::string(law)};
  solid.parameters = Eigen::Map<const RowMatrix>(parameters.data(), 1, static_cast<Index>(parameters.size()));
  solid.density = Vector::Constant(1, density);
  solid.fixed_nodes = std::move(fixed_nodes);
  return solid;
}

std::vector<double> law_parameters(std::string_view law, const IsotropicModuli& moduli, double mooney_share) {
  moduli.check();
  require(mooney_share >= 0 && mooney_share <= 1,
          "the share of c01 is " + std::to_string(mooney_share) + ", expected between 0 and 1");
  return with_law(law, [&]<template <typename> class Material>() -> std::vector<double> {
    Material<double> material;
    if constexpr (requires { Material<double>::from(moduli, mooney_share); })
      material = Material<double>::from(moduli, mooney_share);
    else
      material = Material<double>::from(moduli);
    const auto values =
        std::bit_cast<std::array<double, sizeof(Material<double>) / sizeof(double)>>(material);
    return {values.begin(), values.end()};
  });
}

}  // namespace supple
