#pragma once
/// \file The models that the conformance suites run over: factories of models and of full systems.

#include <physics/full_system.hpp>
#include <physics/mass.hpp>
#include <physics/tet_elasticity.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/random_vectors.hpp>
#include <tests/support/spring_network.hpp>

namespace supple::test {

/// 2 × 1 × 1 cubes of irregular tets (12, so the last pack has free lanes), a material for each.
template <template <typename> class Material>
struct TetBar {
  static constexpr double length = 0.1;
  static TetMesh mesh() { return perturbed(kuhn_box(2, 1, 1, length), 0.1 * length, 11); }
  static TetElasticity<Material> make() {
    std::vector<Material<double>> materials;
    for (Index e = 0; e < mesh().num_tets(); ++e) {
      const double k = static_cast<double>(e);
      materials.push_back(Material<double>::from({.young = 1e5 * (1 + k), .poisson = 0.2 + 0.02 * k}));
    }
    return {mesh(), materials};
  }
  static Vector nodal_mass() { return lumped_mass(mesh(), 1000.0); }
};

struct SpringBar {
  static constexpr double length = 0.1;
  static SpringNetwork make() { return edge_springs(TetBar<StVenantKirchhoff>::mesh(), 200.0); }
  static Vector nodal_mass() { return lumped_mass(TetBar<StVenantKirchhoff>::mesh(), 300.0); }
};

struct DuffingSet {
  static constexpr double length = 0.1;
  static DuffingOscillators make() { return {11, 40.0, 900.0}; }
  static Vector nodal_mass() { return Vector::LinSpaced(11, 0.5, 2.5); }
};

/// The full system of a model, with every node free or with some fixed.
template <typename ModelFactory, bool with_fixed_nodes>
struct FullSystemOf {
  using Model = decltype(ModelFactory::make());
  static FullSystem<Model> make() {
    return {ModelFactory::make(), ModelFactory::nodal_mass(),
            with_fixed_nodes ? std::vector<Index>{7, 0, 3, 0} : std::vector<Index>{}};
  }
  static Vector deformed(const FullSystem<Model>& system, std::uint64_t seed) {
    return random_vector(system.dim(), 0.11 * ModelFactory::length, seed);
  }
  static Vector displacements(const FullSystem<Model>& system, VectorIn u) { return system.expand(u); }
  static Vector nodal_mass(const FullSystem<Model>& system) { return system.nodal_mass(); }
};

}  // namespace supple::test
