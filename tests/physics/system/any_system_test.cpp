#include <physics/body/body_system.hpp>
#include <physics/body/material_law.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/system/any_system.hpp>
#include <physics/time/newmark.hpp>
#include <testing/dynamical_system_conformance.hpp>
#include <tests/support/bars.hpp>

namespace supple::test {

/// The clamped bar, its type erased.
struct ErasedBar {
  static AnySystem<SparseMatrix> make() {
    return AnySystem<SparseMatrix>(std::make_shared<const StvkBar>(clamped_bar()));
  }
  static Vector deformed(const AnySystem<SparseMatrix>& system, std::uint64_t seed) {
    return random_vector(system.dim(), 0.01, seed);
  }
  static Vector displacements(const AnySystem<SparseMatrix>& system, VectorIn u) { return system.expand(u); }
  static Vector nodal_mass(const AnySystem<SparseMatrix>&) { return clamped_bar().nodal_mass(); }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Erased, DynamicalSystemConformance, ErasedBar);

namespace {

TEST(AnySystem, HasTheBitsOfWhatItErases) {
  const StvkBar bar = clamped_bar();
  const AnySystem<SparseMatrix> erased = ErasedBar::make();
  const Vector u = random_vector(bar.dim(), 0.01, 3);
  ASSERT_EQ(erased.dim(), bar.dim());
  EXPECT_EQ(erased.num_nodes(), bar.num_nodes());
  EXPECT_EQ(erased.energy(u), bar.energy(u));
  EXPECT_TRUE(is_same(erased.force(u), bar.force(u)));
  EXPECT_TRUE(is_same(Matrix(erased.stiffness(u)), Matrix(bar.stiffness(u))));
  EXPECT_TRUE(is_same(erased.mass(), bar.mass()));
  EXPECT_TRUE(is_same(erased.expand(u), bar.expand(u)));
  for (const Index v : {Index{0}, bar.num_nodes() - 1})
    EXPECT_TRUE(is_same(erased.displacement(u, v), bar.expand(u).segment<3>(3 * v)));
  const Loads loads{.gravity = {1, 2, 3}, .springs = {{40, 20.0, Point(0.1, 0, 0)}}};
  EXPECT_TRUE(is_same(erased.project(loads).force, bar.project(loads).force));
}

TEST(AnySystem, IsAValueThatIntegratorsRun) {
  std::optional<AnySystem<SparseMatrix>> first = ErasedBar::make();
  const AnySystem<SparseMatrix> kept = *first;
  first.reset();
  const StvkBar bar = clamped_bar();
  const auto run = [](const auto& system) {
    Newmark newmark(system, 0.01);
    State state = newmark.at_rest();
    const auto load = system.project({.gravity = {0, 0, -5}});
    newmark.balance(load, state);
    for (int k = 0; k < 10; ++k) EXPECT_EQ(newmark.step(load, state).status, Status::Converged);
    return state.u;
  };
  EXPECT_TRUE(is_same(run(kept), run(bar)));
}

TEST(AnySystem, OfABodyIsThatOfItsModel) {
  const TetMesh mesh = bar_mesh();
  const Solid solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.3}, {0, 1, 2, 3});
  const AnySystem<SparseMatrix> erased = full_system(solid);
  const FullSystem exact(make_model<StVenantKirchhoff>(solid), solid.nodal_mass(), solid.fixed_nodes);
  const Vector u = random_vector(exact.dim(), 0.01, 5);
  EXPECT_TRUE(is_near(erased.force(u), exact.force(u), 1e-13 * exact.force(u).norm()));
}

}  // namespace
}  // namespace supple::test
