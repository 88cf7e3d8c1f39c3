#include <physics/body/force_models.hpp>
#include <physics/body/material_law.hpp>
#include <physics/model/discrete_shell.hpp>

namespace supple {

namespace {

template <typename Mesh>
auto of_cells(const SolidOf<Mesh>& solid, const MaterialLaw::CellModel<Mesh>& make, const char* cells) {
  require(static_cast<bool>(make),
          "the material law " + solid.law + " is an element of tets only, it has none of " + cells);
  return make(solid.mesh, solid.parameters, solid.material_of_cell, solid.component);
}

}  // namespace

std::shared_ptr<const AnyModel<4>> force_model(const Solid& solid) {
  return material_law(solid.law).tets(solid.mesh, solid.parameters, solid.material_of_cell);
}
std::shared_ptr<const AnyModel<8>> force_model(const HexSolid& solid) {
  return of_cells(solid, material_law(solid.law).hexahedra, "hexahedra");
}
std::shared_ptr<const AnyModel<10>> force_model(const QuadraticTetSolid& solid) {
  return of_cells(solid, material_law(solid.law).quadratic_tets, "quadratic tets");
}
std::shared_ptr<const AnyModel<4>> force_model(const Shell& shell) {
  return std::make_shared<const AnyModel<4>>(std::make_shared<const DiscreteShell>(shell.mesh, shell.materials));
}

}  // namespace supple
