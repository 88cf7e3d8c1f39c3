#include <physics/body/force_models.hpp>
#include <physics/body/material_law.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/model/discrete_shell.hpp>

#include <algorithm>

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
  const TetMesh& mesh = solid.mesh;
  const auto exists = [&](Index v) { return v >= 0 && v < mesh.num_nodes(); };
  for (Index e = 0; e < mesh.num_cells(); ++e)  // a model looks for nodes that do not exist, and for volumes < 0
    if (std::ranges::all_of(mesh.cells[e], exists) && tet_orientation(mesh, e) == 0)
      throw std::invalid_argument("tet " + std::to_string(e) +
                                  " has no volume beyond rounding: its nodes lie in a plane; remove or repair it");
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
