#include <physics/body/material_law.hpp>
#include <physics/material/corotational.hpp>
#include <physics/material/fung.hpp>
#include <physics/material/neo_hookean.hpp>
#include <physics/material/ogden.hpp>

#include <algorithm>

namespace supple {

std::vector<double> MaterialLaw::values(const IsotropicModuli& moduli, const Named& replaced) const {
  std::vector<double> result = from(moduli);
  for (const auto& [parameter, value] : replaced) {
    const auto found = std::ranges::find(parameters, parameter);
    require(found != parameters.end(),
            "the material " + name + " has no parameter '" + parameter + "', expected one of " + listed(parameters));
    result[found - parameters.begin()] = value;
  }
  const std::string wrong = objection(result);
  require(wrong.empty(), "the material " + name + " makes no sense with these parameters: " + wrong);
  return result;
}

Registry<MaterialLaw>& material_law_registry() {
  static Registry<MaterialLaw> laws(
      "material law",
      {make_material_law<StVenantKirchhoff>("stvk",
                                            "St. Venant-Kirchhoff: linear in Green's strain; fast, soft when crushed"),
       make_material_law<MooneyRivlin>("mooney-rivlin", "compressible Mooney-Rivlin, rubber"),
       make_material_law<NeoHookean>("neo-hookean", "compressible neo-Hookean, resists any crushing"),
       make_material_law<StableNeoHookean>("stable-neo-hookean",
                                           "neo-Hookean that bears inversion (Smith et al. 2018)"),
       make_material_law<Corotational>("corotational", "linear elasticity in rotating frames"),
       make_material_law<Ogden>("ogden", "powers of principal stretches, rubber and tissue"),
       make_material_law<Fung>("fung", "exponential stiffening, tissue")},
      ", or the --plugin that has it");
  return laws;
}

const MaterialLaw& material_law(std::string_view name) {
  return material_law_registry().at(name);
}

std::vector<std::string> material_laws() {
  return material_law_registry().names();
}

void add_material_law(MaterialLaw law) {
  material_law_registry().add(std::move(law));
}

}  // namespace supple
