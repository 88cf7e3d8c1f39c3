#include <core/parallel.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/editing/editor.hpp>
#include <reduction/system/galerkin_system.hpp>
#include <reduction/system/reduced_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

#include <numbers>

namespace supple::test {
namespace {

constexpr double quarter = std::numbers::pi / 2;

TEST(RigidMotion, TurnsAboutItsCentre) {
  const Point centre(1, 2, 3);
  const RigidMotion turn = RigidMotion::turn({0, 0, 2}, quarter, centre, Point(0, 0, 0.5));
  EXPECT_TRUE(is_near(turn(centre), Point(1, 2, 3.5), 1e-14));
  EXPECT_TRUE(is_near(turn(centre + Point(1, 0, 0)), Point(1, 3, 3.5), 1e-14));
  EXPECT_THROW((void)RigidMotion::turn({0, 0, 0}, 1, centre), std::invalid_argument);
}

TEST(RigidMotion, ComposesAndInverts) {
  const RigidMotion a = RigidMotion::turn({1, 2, -1}, 0.7, {0.3, 0, 1}, {1, 0, 0}),
                    b = RigidMotion::turn({0, 1, 1}, -1.9, {0, 2, 0});
  const Point x(0.2, -0.5, 0.9);
  EXPECT_TRUE(is_near(a.after(b)(x), a(b(x)), 1e-14));
  EXPECT_TRUE(is_near(a.inverse()(a(x)), x, 1e-14));
}

TEST(RigidMotion, HasPartsThatLeadFromRestToItself) {
  const RigidMotion turn = RigidMotion::turn({0, 1, 0}, 2.0, {1, 0, 0}, {0, 3, 0});
  const Point centre(2, 1, 0), x(0.4, 1, -1);
  EXPECT_TRUE(is_near(turn.part(0, centre)(x), x, 1e-14));
  EXPECT_TRUE(is_near(turn.part(1, centre)(x), turn(x), 1e-14));
  const RigidMotion half = turn.part(0.5, centre);
  EXPECT_NEAR(Eigen::AngleAxisd(half.rotation).angle(), 1.0, 1e-12);
  EXPECT_TRUE(is_near(half(centre), 0.5 * (centre + turn(centre)), 1e-14));
}

TEST(RigidMotion, ComesFromAMatrixIfThatIsRigid) {
  const RigidMotion turn = RigidMotion::turn({1, 1, 0}, 0.4, {1, 0, 0}, {0, 3, 0});
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = turn.rotation;
  matrix.topRightCorner<3, 1>() = turn.translation;
  EXPECT_TRUE(is_near(RigidMotion::from(matrix)(Point(1, 2, 3)), turn(Point(1, 2, 3)), 1e-12));
  Eigen::Matrix4d stretched = matrix, mirrored = matrix, broken = matrix;
  stretched(0, 0) *= 1.1;
  mirrored.col(0) *= -1;
  broken(1, 1) = std::nan("");
  for (const Eigen::Matrix4d& wrong : {stretched, mirrored, broken})
    EXPECT_THROW((void)RigidMotion::from(wrong), std::invalid_argument);
}

TEST(Handle, SamplesItsNodes) {
  std::vector<Index> nodes(50);
  for (Index k = 0; k < 50; ++k) nodes[k] = 3 * k;
  const Handle a(nodes, 10, 2.0, 5), b(nodes, 10, 2.0, 5), c(nodes, 10, 2.0, 6);
  EXPECT_EQ(a.samples.size(), 10u);
  EXPECT_TRUE(std::is_sorted(a.samples.begin(), a.samples.end()));
  EXPECT_THAT(nodes, testing::IsSupersetOf(a.samples));
  EXPECT_EQ(a.samples, b.samples);
  EXPECT_NE(a.samples, c.samples);
  EXPECT_EQ(Handle(nodes, 1000, 1.0).samples, nodes);
  EXPECT_THROW(Handle({}, 3, 1.0), std::invalid_argument);
  EXPECT_THROW(Handle(nodes, 0, 1.0), std::invalid_argument);
  EXPECT_THROW(Handle(nodes, 3, -1.0), std::invalid_argument);
}

/// A free bar with a handle at either end.
const std::array<NonlinearSolver, 3> every_static_solver{Newton{}, LineSearchBfgs{}, Nlopt{}};

struct HeldBar {
  TetMesh mesh = bar_mesh();
  StvkBar system = free_bar();
  Handle left{bar_end(mesh), 100, 2000.0};
  Handle right{nodes_where(mesh, [](const Point& x) { return x[0] > 0.55; }), 100, 2000.0};

  template <typename System>
  Editor<System> editor(const System& some, const StaticOptions& options = {}) const {
    Editor<System> editor(some, mesh.nodes, options);
    (void)editor.add(left);
    (void)editor.add(right);
    return editor;
  }
  static RigidMotion bend(double angle) { return RigidMotion::turn({0, 0, 1}, angle, {0.3, 0.1, 0.1}); }
};

TEST(Editor, TakesARigidMotionOfAllHandlesWithoutEnergy) {
  const HeldBar bar;
  auto editor = bar.editor(bar.system, {.tolerance = 1e-9});
  const RigidMotion motion = RigidMotion::turn({1, 2, 3}, 0.8, {0.1, 0, 0}, {0.2, 0, -0.1});
  editor.move(0, motion);
  editor.move(1, motion);
  ASSERT_EQ(editor.solve().status, Status::Converged);
  for (Index v = 0; v < bar.mesh.num_nodes(); ++v) {
    const Point x = bar.mesh.nodes.row(v).transpose();
    EXPECT_TRUE(is_near(x + editor.state().segment<3>(3 * v), motion(x), 1e-6));
  }
  EXPECT_LT(editor.elastic_energy(), 1e-9);
}

TEST(Editor, TellsWhatItsHandlesHold) {
  const HeldBar bar;
  auto editor = bar.editor(bar.system);
  const Point shift{0.03, 0, 0.04};
  editor.move(1, {.translation = shift});
  const Vector rest = Vector::Zero(3 * bar.mesh.num_nodes());
  // ½ · 2 w ‖x − x'‖² a sample, of those at the right
  const double count = static_cast<double>(bar.right.samples.size()), energy = count * 2000.0 * shift.squaredNorm();
  EXPECT_NEAR(editor.control_energy(rest), energy, 1e-12 * energy);
  EXPECT_EQ(control_energy(editor.handles()[0], bar.mesh.nodes, rest), 0);

  const double mass = 3, stiffness = 2 * 2000.0 * count;  // of all springs at the right
  const double soft = 2 * stiffness / (1e5 * mass), stiff = stiffness / (1e5 * mass) / 7;  // λ₁
  EXPECT_NEAR(default_handle_stiffness(soft, mass), 2 * stiffness, 1e-9);
  const auto held = [&](double eigenvalue) {
    return control_displacement(editor.handles(), bar.mesh.nodes, rest, eigenvalue, mass);
  };
  EXPECT_NEAR(held(soft), std::sqrt(2 * energy / (soft * mass)), 1e-9);
  // springs seven times as stiff as the default: what their forces would make the default ones hold
  EXPECT_NEAR(held(stiff), std::sqrt(2 * 7 * energy / (stiff * mass)), 1e-9);
}

TEST(Editor, ExtendedModesTakeARigidMotionExactlyToo) {
  const HeldBar bar;
  const auto subspace = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 9}(bar.system));
  const Index m = bar.system.model().num_components();
  const ReducedSystem reduced(bar.system.shared_model(), subspace, all_components(m), Vector::Ones(m),
                              project_stiffness(*subspace, bar.system), bar.system.nodal_mass());
  const RigidMotion motion = RigidMotion::turn({1, 2, 3}, 2.0, {0.1, 0, 0}, {0.2, 0, -0.1});
  for (const NonlinearSolver& method : every_static_solver) {
    // NLopt's line searches give up earlier than ours
    auto editor =
        bar.editor(reduced, {.solver = method, .tolerance = std::holds_alternative<Nlopt>(method) ? 1e-6 : 1e-8});
    editor.move(0, motion);
    editor.move(1, motion);
    ASSERT_EQ(editor.solve().status, Status::Converged) << method.index();
    const Vector u = subspace->reconstruct(editor.state());
    for (Index v = 0; v < bar.mesh.num_nodes(); ++v) {
      const Point x = bar.mesh.nodes.row(v).transpose();
      EXPECT_TRUE(is_near(x + u.segment<3>(3 * v), motion(x), 1e-5));
    }
    EXPECT_LT(editor.control_energy(u), 1e-6);
  }
}

TEST(Editor, MethodsAgreeInTheReducedSpaceAndWithTheFullSystemWhereTheSubspaceIsFull) {
  const HeldBar bar;
  // U = M^(−½), all of the space
  DenseBasis all;
  all.W = RowMatrix::Zero(bar.system.dim(), bar.system.dim());
  all.W.diagonal() = bar.system.mass().cwiseSqrt().cwiseInverse();
  const auto subspace = std::make_shared<const DenseBasis>(std::move(all));
  const Index m = bar.system.model().num_components();
  const ReducedSystem reduced(bar.system.shared_model(), subspace, all_components(m), Vector::Ones(m),
                              project_stiffness(*subspace, bar.system), bar.system.nodal_mass());
  auto full = bar.editor(bar.system, {.tolerance = 1e-9});
  full.move(1, HeldBar::bend(0.5));
  ASSERT_EQ(full.solve().status, Status::Converged);
  for (const NonlinearSolver& method : every_static_solver) {
    auto editor = bar.editor(
        reduced,
        {.solver = method, .tolerance = std::holds_alternative<Nlopt>(method) ? 1e-6 : 1e-8, .max_iterations = 500});
    editor.move(1, HeldBar::bend(0.5));
    ASSERT_EQ(editor.solve().status, Status::Converged) << method.index();
    EXPECT_TRUE(is_near(subspace->reconstruct(editor.state()), full.state(), 1e-4 * full.state().norm()));
    EXPECT_NEAR(editor.elastic_energy(), full.elastic_energy(), 1e-4 * full.elastic_energy());
  }
}

TEST(GalerkinSystem, IsTheReducedSystemOfAllComponents) {
  const auto full = std::make_shared<const StvkBar>(clamped_bar());
  const auto subspace = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 4}(*full));
  const GalerkinSystem galerkin(full, subspace);
  const Index m = full->model().num_components();
  const ReducedSystem reduced(full->shared_model(), subspace, all_components(m), Vector::Ones(m),
                              project_stiffness(*subspace, *full), full->nodal_mass());
  static_assert(DynamicalSystem<std::remove_const_t<decltype(galerkin)>>);
  const Vector q = random_vector(galerkin.dim(), 0.02, 5);
  Vector f(q.size());
  galerkin.force(q, f);
  EXPECT_TRUE(is_near(f, reduced.force(q), 1e-11 * f.norm()));
  EXPECT_NEAR(galerkin.energy(q), reduced.energy(q), 1e-11 * reduced.energy(q));
  Matrix K;
  galerkin.stiffness(q, K);
  EXPECT_TRUE(is_near(K, reduced.stiffness(q), 1e-11 * K.norm()));
  const Loads loads{.gravity = {1, -2, 3}, .forces = {{40, {0, 1, 0}}}, .springs = {{50, 30.0, {0.1, 0, 0}}}};
  const auto a = galerkin.project(loads), b = reduced.project(loads);
  EXPECT_TRUE(is_near(a.force, b.force, 1e-12 * a.force.norm()));
  EXPECT_TRUE(is_near(a.stiffness, b.stiffness, 1e-12 * a.stiffness.norm()));
}

TEST(GalerkinSystem, MayBeAskedFromSeveralThreads) {
  const auto full = std::make_shared<const StvkBar>(clamped_bar());
  const GalerkinSystem galerkin(full, std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 2}(*full)));
  const auto tangent = [&](Index k) {
    Matrix K;
    galerkin.stiffness(random_vector(galerkin.dim(), 0.05, 10 + static_cast<unsigned>(k)), K);
    return K;
  };
  std::vector<Matrix> alone(16), together(16);
  for (Index k = 0; k < 16; ++k) alone[k] = tangent(k);
  set_num_threads(4);
  parallel_for(16, [&](Index k) { together[k] = tangent(k); });
  set_num_threads(0);
  for (Index k = 0; k < 16; ++k) EXPECT_TRUE(is_same(together[k], alone[k])) << k;
}

TEST(Editor, HandlesComeAndGo) {
  const HeldBar bar;
  auto editor = bar.editor(bar.system);
  editor.move(1, HeldBar::bend(0.3));
  ASSERT_EQ(editor.solve().status, Status::Converged);
  const Vector bent = editor.state();
  const Index middle =
      editor.add({nodes_where(bar.mesh, [](const Point& x) { return std::abs(x[0] - 0.3) < 0.05; }), 20, 1000.0, 3});
  editor.move(middle, RigidMotion{.translation = Point(0, 0.05, 0)});
  ASSERT_EQ(editor.solve().status, Status::Converged);
  EXPECT_GT((editor.state() - bent).norm(), 1e-3);
  editor.remove_all();
  editor.reset();
  (void)editor.add(bar.left);
  (void)editor.add(bar.right);
  editor.move(1, HeldBar::bend(0.3));
  ASSERT_EQ(editor.solve().status, Status::Converged);
  EXPECT_TRUE(is_near(editor.state(), bent, 1e-4 * bent.norm()));
  EXPECT_EQ(editor.solve().iterations, 0);  // it is there already
  EXPECT_THROW(editor.move(7, {}), std::invalid_argument);
  EXPECT_THROW((void)editor.add({{0, 99999}, 2, 1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
