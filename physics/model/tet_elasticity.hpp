#pragma once
/// \file Elastic solids of linear tetrahedra.

#include <physics/model/solid_elasticity.hpp>

namespace supple {

/// A hyperelastic solid of linear tetrahedra: eᵢ = Vᵢ ψ(Fᵢ), F = I + Σₐ uₐ ⊗ ∇Nₐ constant in a tet. One
/// component a tet, in order of the mesh. `Material` is a class template over the
/// scalar type (see materials.hpp).
template <template <typename> class Material>
using TetElasticity = SolidElasticity<LinearTet, Material>;

static_assert(PackableForceModel<TetElasticity<StVenantKirchhoff>>);
static_assert(PackableForceModel<TetElasticity<MooneyRivlin>>);

}  // namespace supple
