#pragma once
/// \file Force model of a solid, of its own type.

#include <physics/body/material_law.hpp>
#include <physics/body/solid.hpp>

namespace supple {

/// The force model of a solid whose law is `Material`, where the law is known when compiling.
template <template <typename> class Material, SolidComponent component = SolidComponent::Element, typename Mesh>
SolidElasticity<ElementOf<Mesh>, Material, component> make_model(const SolidOf<Mesh>& solid) {
  return {solid.mesh, materials_of_cells<Material>(solid.mesh.num_cells(), solid.parameters, solid.material_of_cell)};
}

}  // namespace supple
