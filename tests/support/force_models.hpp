#pragma once
/// \file The models that the conformance suites run over: factories of models and of full systems.

#include <physics/heat/heat_conduction.hpp>
#include <physics/heat/surface_heat_loss.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/any_model.hpp>
#include <physics/model/composite_model.hpp>
#include <physics/model/discrete_shell.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/spring_network.hpp>

namespace supple::test {

/// 2 × 1 × 1 cubes of irregular tets (12, so the last pack has free lanes), a material for each.
template <template <typename> class Material>
struct TetBar {
  static constexpr double length = 0.1;
  static TetMesh mesh() { return perturbed(kuhn_box(2, 1, 1, length), 0.1 * length, 11); }
  static TetElasticity<Material> make() {
    std::vector<Material<double>> materials;
    for (Index e = 0; e < mesh().num_cells(); ++e) {
      const double k = static_cast<double>(e);
      materials.push_back(Material<double>::from({.young = 1e5 * (1 + k), .poisson = 0.2 + 0.02 * k}));
    }
    return {mesh(), materials};
  }
  static Vector nodal_mass() { return lumped_mass(mesh(), 1000.0); }
};

/// The same behind the erased type.
struct AnyTets {
  static constexpr double length = 0.1;
  static AnyModel<4> make() {
    return AnyModel<4>(std::make_shared<const TetElasticity<MooneyRivlin>>(TetBar<MooneyRivlin>::make()));
  }
};

/// An irregular flat sheet with a boundary, a material a triangle. `bending` against stretch · length² tells
/// how much of the stiffness is that of hinges.
struct FlatShell {
  static constexpr double length = 0.1;
  static TriangleMesh mesh() {
    TriangleMesh sheet = perturbed(square_grid(3, 2, length), 0.15 * length, 12);
    sheet.nodes.col(2).setZero();
    return sheet;
  }
  static DiscreteShell make() {
    std::vector<ShellMaterial> materials;
    for (Index t = 0; t < mesh().num_triangles(); ++t) {
      const double k = static_cast<double>(t);
      materials.push_back({.bending = 0.1 + 0.02 * k, .stretch = 100 - 3 * k, .area = 20 + k});
    }
    return {mesh(), materials};
  }
  static Vector nodal_mass() { return lumped_mass(mesh(), 1000.0, 0.01); }
};

/// A closed surface with sharp edges, as stiff in bending as in stretch; nothing resists changes of area.
struct ClosedShell {
  static constexpr double length = 0.1;
  static TriangleMesh mesh() { return perturbed(octahedron(length), 0.1 * length, 13); }
  static DiscreteShell make() { return {mesh(), {.bending = 0.5, .stretch = 100, .area = 0}}; }
  static Vector nodal_mass() { return lumped_mass(mesh(), 1000.0, 0.01); }
};

/// A curved sheet with a boundary, of a real material: hardly stiff in bending.
struct CurvedShell {
  static constexpr double length = 0.1;
  static TriangleMesh mesh() {
    TriangleMesh sheet = equilateral_grid(3, 3, length);
    for (Index v = 0; v < sheet.num_nodes(); ++v) {
      const double x = sheet.nodes(v, 0) / length, y = sheet.nodes(v, 1) / length;
      sheet.nodes(v, 2) = length * (0.2 * x * x - 0.15 * x * y);
    }
    return sheet;
  }
  static DiscreteShell make() { return {mesh(), ShellMaterial::from({.young = 1e6, .poisson = 0.45}, 0.02)}; }
  static Vector nodal_mass() { return lumped_mass(mesh(), 1000.0, 0.02); }
};

/// Heat in the same tets: unknowns are temperatures, so `length` is one of them [K]; k changes by up to a third within
/// the states of the suites. A conductivity for each tet.
template <template <typename> class Conductivity>
struct HeatBar {
  static constexpr double length = 100;
  static TetMesh mesh() { return TetBar<StVenantKirchhoff>::mesh(); }
  static HeatConduction<Conductivity> make() {
    std::vector<Conductivity<double>> conductivities;
    for (Index e = 0; e < mesh().num_cells(); ++e) {
      const double k = static_cast<double>(e);
      conductivities.push_back(Conductivity<double>::from(10 + k, 0.03 - 0.004 * k));
    }
    return {mesh(), conductivities};
  }
  static Vector nodal_mass() { return lumped_heat_capacity(mesh(), 2700, 900); }
};

/// A hot surface: k by convection and radiation, of about equal size.
struct HotSurface {
  static constexpr double length = 500;
  static SurfaceHeatLoss make() {
    const TetMesh mesh = HeatBar<LinearConductivity>::mesh();
    return {mesh.nodes, boundary_faces(mesh), {.film = 5, .emissivity = 0.8, .ambient = 300}};
  }
  static Vector nodal_mass() { return HeatBar<LinearConductivity>::nodal_mass(); }
};

/// Tets that conduct and the surface that loses.
struct CoolingBar {
  static constexpr double length = 100;
  static auto make() { return CompositeModel(HeatBar<ExponentialConductivity>::make(), HotSurface::make()); }
  static Vector nodal_mass() { return HotSurface::nodal_mass(); }
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
