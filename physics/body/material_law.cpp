#include <physics/body/material_law.hpp>
#include <physics/material/corotational.hpp>
#include <physics/material/fung.hpp>
#include <physics/material/neo_hookean.hpp>
#include <physics/material/ogden.hpp>

#include <algorithm>
#include <deque>
#include <mutex>

namespace supple {

namespace {

struct Laws {
  std::mutex mutex;
  std::deque<MaterialLaw> laws{
      make_material_law<StVenantKirchhoff>("stvk"),
      make_material_law<MooneyRivlin>("mooney-rivlin"),
      make_material_law<NeoHookean>("neo-hookean"),
      make_material_law<StableNeoHookean>("stable-neo-hookean"),
      make_material_law<Corotational>("corotational"),
      make_material_law<Ogden>("ogden"),
      make_material_law<Fung>("fung"),
  };  // a deque, whose elements stay where they are

  const MaterialLaw* find(std::string_view name) {
    const auto found = std::ranges::find(laws, name, &MaterialLaw::name);
    return found == laws.end() ? nullptr : &*found;
  }
};
Laws& all_laws() {
  static Laws laws;
  return laws;
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

}  // namespace

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

const MaterialLaw& material_law(std::string_view name) {
  Laws& all = all_laws();
  {
    const std::scoped_lock lock(all.mutex);
    if (const MaterialLaw* law = all.find(name)) return *law;
  }
  throw std::invalid_argument("material law '" + std::string(name) + "' is not known, expected one of " +
                              listed(material_laws()) + ", or the --plugin that has it");
}

std::vector<std::string> material_laws() {
  Laws& all = all_laws();
  const std::scoped_lock lock(all.mutex);
  std::vector<std::string> names;
  for (const MaterialLaw& law : all.laws) names.push_back(law.name);
  return names;
}

void add_material_law(MaterialLaw law) {
  Laws& all = all_laws();
  const std::scoped_lock lock(all.mutex);
  require(!all.find(law.name), "there is a material law '" + law.name + "' already");
  all.laws.push_back(std::move(law));
}

}  // namespace supple
