#include <physics/mesh/mass.hpp>
#include <physics/model/composite_model.hpp>
#include <physics/model/discrete_shell.hpp>
#include <physics/model/embedded_model.hpp>
#include <physics/model/spring_model.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/system/reduced_system.hpp>
#include <testing/force_model_conformance.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/force_models.hpp>
#include <tests/support/solids.hpp>

namespace supple::test {
namespace {

/// The surface of a solid as a shell, on the nodes that it has there.
EmbeddedModel<DiscreteShell> skin_of(const TetMesh& mesh, const ShellMaterial& material) {
  std::vector<Index> nodes, number(mesh.num_nodes(), -1);
  TriangleMesh skin{{}, boundary_faces(mesh)};
  for (Triangle& triangle : skin.triangles)
    for (Index& v : triangle) {
      if (number[v] < 0) {
        number[v] = static_cast<Index>(nodes.size());
        nodes.push_back(v);
      }
      v = number[v];
    }
  skin.nodes = mesh.nodes(nodes, Eigen::all);
  return {DiscreteShell(skin, material), nodes, mesh.num_nodes()};
}

/// Tets with a skin.
struct SkinnedBar {
  static constexpr double length = 0.1;
  static TetMesh mesh() { return TetBar<StVenantKirchhoff>::mesh(); }
  static auto make() {
    return CompositeModel(TetBar<StVenantKirchhoff>::make(),
                          skin_of(mesh(), ShellMaterial::from({.young = 1e6, .poisson = 0.4}, 0.02)));
  }
};
struct EmbeddedShell {
  static constexpr double length = 0.1;
  static auto make() { return EmbeddedModel(ClosedShell::make(), {9, 3, 5, 0, 2, 7}, 11); }
};
/// Tets of two laws, and springs, whose stencils are smaller.
struct SprungBar {
  static constexpr double length = 0.1;
  static auto make() {
    return CompositeModel(TetBar<StVenantKirchhoff>::make(), SpringBar::make(), TetBar<MooneyRivlin>::make());
  }
};

TEST(CompositeModel, AddsUpItsParts) {
  const auto mesh = SprungBar::make();
  const Vector mass = SpringBar::nodal_mass();
  const FullSystem whole(mesh, mass, {0, 1});
  const FullSystem stvk(TetBar<StVenantKirchhoff>::make(), mass, {0, 1});
  const FullSystem springs(SpringBar::make(), mass, {0, 1});
  const FullSystem mooney(TetBar<MooneyRivlin>::make(), mass, {0, 1});
  const Vector u = random_vector(whole.dim(), 0.01, 4);
  const double energy = stvk.energy(u) + springs.energy(u) + mooney.energy(u);
  EXPECT_NEAR(whole.energy(u), energy, 1e-12 * energy);
  const Vector force = stvk.force(u) + springs.force(u) + mooney.force(u);
  EXPECT_TRUE(is_near(whole.force(u), force, 1e-12 * force.norm()));
  const Matrix K = Matrix(stvk.stiffness(u)) + Matrix(springs.stiffness(u)) + Matrix(mooney.stiffness(u));
  EXPECT_TRUE(is_near(Matrix(whole.stiffness(u)), K, 1e-12 * K.norm()));
  // springs along edges of tets couple nothing that tets do not
  EXPECT_EQ(whole.rest_stiffness().nonZeros(), stvk.rest_stiffness().nonZeros());
}

TEST(CompositeModel, CountsComponentsPartByPart) {
  const auto model = SprungBar::make();
  EXPECT_EQ(model.num_components(), 12 + SpringBar::make().num_components() + 12);
  EXPECT_EQ(model.part_of(0), 0u);
  EXPECT_EQ(model.part_of(11), 0u);
  EXPECT_EQ(model.part_of(12), 1u);
  EXPECT_EQ(model.part_of(model.num_components() - 1), 2u);
  EXPECT_THROW(CompositeModel(TetBar<StVenantKirchhoff>::make(), ClosedShell::make()), std::invalid_argument);
}

/// With all components at weight one the reduced force is that of the full system, projected.
template <typename Model>
void expect_galerkin_projection(const FullSystem<Model>& system) {
  const auto subspace = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 5}(system));
  const Index m = system.model().num_components();
  const ReducedSystem reduced(system.shared_model(), subspace, all_components(m), Vector::Ones(m),
                              project_stiffness(*subspace, system), system.nodal_mass());
  const Vector q = random_vector(subspace->dim(), 0.01, 9);
  Vector f(subspace->dim());
  reduced.force(q, f);
  const Vector exact = subspace->project(system.expand(system.force(system.restrict(subspace->reconstruct(q)))));
  EXPECT_TRUE(is_near(f, exact, 1e-10 * exact.norm()));
}

TEST(CompositeModel, IsReducedLikeAnyModel) {
  const TetMesh mesh = bar_mesh();
  const auto force =
      std::make_shared<const CompositeModel<TetElasticity<StVenantKirchhoff>, EmbeddedModel<DiscreteShell>>>(
          TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.35})),
          skin_of(mesh, ShellMaterial::from({.young = 1e7, .poisson = 0.4}, 0.002)));
  const FullSystem system(force, lumped_mass(mesh, 1000.0), bar_end(mesh));
  expect_galerkin_projection(system);
}

/// Hexes on the left half of an irregular box, tets on the right, springs from end to end.
struct MixedBox {
  static constexpr double length = 0.1;
  TetMesh all = perturbed(kuhn_box(4, 2, 2, length), 0.1 * length, 14);
  HexMesh hexes{all.nodes, {}};
  TetMesh tets;
  std::vector<SpringModel::Ends> springs;

  MixedBox() {
    tets.nodes = all.nodes;
    const HexMesh cubes = hex_box(4, 2, 2, {1, 1, 1});  // numbers nodes and cells alike
    for (Index cube = 0; cube < cubes.num_cells(); ++cube) {
      if (cube % 4 < 2)
        hexes.cells.push_back(cubes.cells[cube]);
      else
        tets.cells.insert(tets.cells.end(), all.cells.begin() + 6 * cube, all.cells.begin() + 6 * (cube + 1));
    }
    for (Index v = 0; v < all.num_nodes(); v += 5) springs.push_back({v, v + 4});
  }

  template <SolidComponent component>
  auto hex_model() const {
    return SolidElasticity<TrilinearHex, MooneyRivlin, component>(hexes, MooneyRivlin<double>::from({.young = 3e5}));
  }
  auto tet_model() const {
    return TetElasticity<StVenantKirchhoff>(tets, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.3}));
  }
  SpringModel spring_model() const { return {all.nodes, springs, 500.0}; }
  Vector mass() const { return lumped_mass<TrilinearHex>(hexes, 1000.0) + lumped_mass(tets, 700.0); }
  std::vector<Index> fixed() const {
    return nodes_where(all, [](const Point& x) { return x[0] < length / 2; });
  }
};

TEST(CompositeModel, AddsUpHexesTetsAndSprings) {
  const MixedBox box;
  const Vector mass = box.mass();
  const CompositeModel model(box.hex_model<SolidComponent::Element>(), box.tet_model(), box.spring_model());
  EXPECT_EQ(model.num_components(), 8 + 48 + 9);
  const FullSystem whole(model, mass, box.fixed());
  const FullSystem hexes(box.hex_model<SolidComponent::Element>(), mass, box.fixed());
  const FullSystem tets(box.tet_model(), mass, box.fixed());
  const FullSystem springs(box.spring_model(), mass, box.fixed());
  const Vector u = random_vector(whole.dim(), 0.008, 4);
  const double energy = hexes.energy(u) + tets.energy(u) + springs.energy(u);
  EXPECT_NEAR(whole.energy(u), energy, 1e-12 * energy);
  const Vector force = hexes.force(u) + tets.force(u) + springs.force(u);
  EXPECT_TRUE(is_near(whole.force(u), force, 1e-12 * force.norm()));
  const Matrix K = Matrix(hexes.stiffness(u)) + Matrix(tets.stiffness(u)) + Matrix(springs.stiffness(u));
  EXPECT_TRUE(is_near(Matrix(whole.stiffness(u)), K, 1e-12 * K.norm()));
}

TEST(CompositeModel, OfMixedMeshesIsReducedByCellsAndByGaussPoints) {
  const MixedBox box;
  expect_galerkin_projection(
      FullSystem(CompositeModel(box.hex_model<SolidComponent::Element>(), box.tet_model(), box.spring_model()),
                 box.mass(), box.fixed()));
  expect_galerkin_projection(
      FullSystem(CompositeModel(box.hex_model<SolidComponent::GaussPoint>(), box.tet_model(), box.spring_model()),
                 box.mass(), box.fixed()));
}

}  // namespace

INSTANTIATE_TYPED_TEST_SUITE_P(SkinnedBar, ForceModelConformance, SkinnedBar);
INSTANTIATE_TYPED_TEST_SUITE_P(EmbeddedShell, ForceModelConformance, EmbeddedShell);
INSTANTIATE_TYPED_TEST_SUITE_P(SprungBar, ForceModelConformance, SprungBar);

}  // namespace supple::test
