#include <core/parallel.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/editing/editor.hpp>
#include <reduction/system/galerkin_system.hpp>
#include <reduction/system/reduced_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/plates.hpp>

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
  EXPECT_TRUE(turn.matrix().isApprox(matrix, 1e-15));
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

/// What a static solver finds under all of it, whatever the editor has solved before.
TEST(Editor, TakesLoadsBesideItsHandles) {
  const HeldBar bar;
  const StaticOptions options{.tolerance = 1e-10};
  const Index tip = bar.right.samples.front();
  const Loads loads{.gravity = {0, 0, -3}, .forces = {{tip, {0, 0.4, 0}}}, .springs = {{tip, 20, {0, 0, 0.1}}}};
  auto editor = bar.editor(bar.system, options);
  editor.set_loads(loads);
  for (const double angle : {0.0, 0.3, 0.5}) {  // the second and the third move targets only
    editor.move(1, HeldBar::bend(angle));
    ASSERT_EQ(editor.solve().status, Status::Converged);
    Loads all = loads;
    const Loads handles = handle_loads(editor.handles(), bar.mesh.nodes);
    all.springs.insert(all.springs.end(), handles.springs.begin(), handles.springs.end());
    Vector u = editor.state();
    u *= 0.9;
    ASSERT_EQ(StaticSolver(bar.system, options).solve(bar.system.project(all), u).status, Status::Converged);
    EXPECT_TRUE(is_near(editor.state(), u, 1e-7));
    EXPECT_LT(editor.imbalance().norm(), 1e-6 * bar.system.project(all).dead_force().norm());
  }
  const Vector loaded = editor.state();
  editor.set_loads({});
  ASSERT_EQ(editor.solve().status, Status::Converged);
  EXPECT_GT((editor.state() - loaded).norm(), 1e-3 * loaded.norm());
  EXPECT_THROW(editor.set_loads({.forces = {{bar.mesh.num_nodes(), {0, 0, 1}}}}), std::invalid_argument);
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

/// A path of edits, whose tip turns by 40° in four increments, ends by each of `methods` within a thousandth of where the
/// same method ends at 1e-10; by NLopt, which does not get there, of where Newton's method leads from its end.
/// \param stiffness  of all springs of a handle together [N/m].
template <typename System>
void expect_own_answers(const System& system, const Points& rest, const std::array<std::vector<Index>, 2>& ends,
                        double stiffness, const std::vector<NonlinearSolver>& methods) {
  std::vector<Handle> handles;
  for (const std::vector<Index>& nodes : ends) {
    Handle handle(nodes, 30, 1);
    handle.weight = 0.5 * stiffness / static_cast<double>(handle.samples.size());
    handles.push_back(std::move(handle));
  }
  const Point centre = handles[1].centre(rest);
  const RigidMotion turn = RigidMotion::turn({0, 0.6, 0.8}, 0.7, centre);
  /// The increments from `first` to the last.
  const auto edited = [&](const NonlinearSolver& method, double tolerance, const Vector& start, int first = 1) {
    Editor<System> editor(system, rest, {.solver = method, .tolerance = tolerance, .max_iterations = 500});
    for (const Handle& handle : handles) (void)editor.add(handle);
    editor.start_from(start);
    for (int k = first; k <= 4; ++k) {
      editor.move(1, turn.part(0.25 * k, centre));
      const SolveReport report = editor.solve();
      EXPECT_EQ(report.status, Status::Converged) << report.residual << " for " << tolerance;
    }
    return editor.state();
  };
  const Vector zero = Vector::Zero(system.dim());
  for (const NonlinearSolver& method : methods) {
    SCOPED_TRACE("method " + std::to_string(method.index()) + ", stiffness " + std::to_string(stiffness));
    const Vector end = edited(method, StaticOptions().tolerance, zero);
    const bool is_nlopt = std::holds_alternative<Nlopt>(method);
    const Vector own = is_nlopt ? edited(Newton{}, 1e-10, end, 4) : edited(method, 1e-10, zero);
    const Vector u = system.expand(end), answer = system.expand(own);
    EXPECT_LT((u - answer).norm(), 1e-3 * answer.norm());
    EXPECT_NEAR(system.energy(end), system.energy(own), 1e-3 * system.energy(own));
  }
}

/// The same of an object and of its subspace, over springs 1 … 10⁶ times as stiff as its softest mode.
template <typename Model>
void expect_own_answers_for_every_stiffness(const FullSystem<Model>& system, const Points& rest) {
  const ExtendedModalBasis builder{.num_modes = 12};
  const auto subspace = std::make_shared<const NodalBasis>(builder(system));
  const Index m = system.model().num_components();
  const ReducedSystem reduced(system.shared_model(), subspace, all_components(m), Vector::Ones(m),
                              project_stiffness(*subspace, system), system.nodal_mass());
  const double soft = std::pow(subspace->report.omega[6], 2) * system.nodal_mass().sum();
  const double low = rest.col(0).minCoeff(), length = rest.col(0).maxCoeff() - low;
  std::array<std::vector<Index>, 2> ends;
  for (Index v = 0; v < rest.rows(); ++v) {
    const double x = (rest(v, 0) - low) / length;
    if (x < 0.1) ends[0].push_back(v);
    if (x > 0.9) ends[1].push_back(v);
  }
  for (const double ratio : {1.0, 1e2, 1e4, 1e6}) {
    expect_own_answers(system, rest, ends, ratio * soft, {Newton{}, Bfgs{}, LineSearchBfgs{}, WarpedBfgs{}});
    expect_own_answers(reduced, rest, ends, ratio * soft, {Newton{}, Bfgs{}, LineSearchBfgs{}, Nlopt{}});
  }
}

TEST(Editor, ComesWithinAThousandthOfItsOwnAnswerInASolid) {
  const HeldBar bar;
  expect_own_answers_for_every_stiffness(bar.system, bar.mesh.nodes);
}

TEST(Editor, ComesWithinAThousandthOfItsOwnAnswerInAShell) {
  // 1 cm thick, a part of a bowl
  TriangleMesh mesh = perturbed(equilateral_grid(8, 4, 0.1), 0.005, 5);
  for (Index v = 0; v < mesh.num_nodes(); ++v)
    mesh.nodes(v, 2) = 0.3 * std::pow(mesh.nodes(v, 0), 2) + 0.6 * std::pow(mesh.nodes(v, 1), 2);
  const double thickness = 0.01;
  const Plate shell(DiscreteShell(mesh, ShellMaterial::from({.young = 1e6, .poisson = 0.35}, thickness)),
                    lumped_mass(mesh, 1000.0, thickness));
  expect_own_answers_for_every_stiffness(shell, mesh.nodes);
}

TEST(Editor, StatesWhatForcesLeave) {
  const HeldBar bar;
  auto editor = bar.editor(bar.system);
  editor.move(1, HeldBar::bend(0.4));
  ASSERT_EQ(editor.solve().status, Status::Converged);
  // against the derivative of all energy there is, along a direction
  const Vector u = editor.state(), direction = random_vector(u.size(), 1, 3), g = editor.imbalance();
  EXPECT_LT(g.norm(), 1e-3 * bar.system.force(u).norm());
  const Vector aside = u + 0.01 * direction;
  editor.start_from(aside);
  const auto energy = [&](VectorIn at) { return bar.system.energy(at) + editor.control_energy(at); };
  const double h = 1e-6, slope = (energy(aside + h * direction) - energy(aside - h * direction)) / (2 * h);
  EXPECT_NEAR(editor.imbalance().dot(direction), slope, 1e-6 * std::abs(slope));
}

// What springs hold is known better than as the difference of k u and k u*.
TEST(SystemLoad, TellsSpringsFromDeadForces) {
  const auto full = std::make_shared<const StvkBar>(clamped_bar());
  const auto subspace = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 4}(*full));
  const GalerkinSystem galerkin(full, subspace);
  const Index m = full->model().num_components();
  const ReducedSystem reduced(full->shared_model(), subspace, all_components(m), Vector::Ones(m),
                              project_stiffness(*subspace, *full), full->nodal_mass());
  const Index held = bar_end(bar_mesh())[0];
  const Loads loads{.gravity = {1, -2, 3},
                    .forces = {{40, {0, 1, 0}}},
                    .springs = {{50, 30.0, {0.1, 0, 0}}, {held, 20.0, {0, 0.5, 0}}, {45, 1e9, {0, 0.2, -0.1}}}};
  const Loads dead{.gravity = loads.gravity, .forces = loads.forces};
  const auto check = [&](const auto& system) {
    const auto load = system.project(loads);
    EXPECT_TRUE(is_near(load.dead_force(), system.project(dead).force, 1e-14 * load.force.norm()));
    const Vector a = random_vector(system.dim(), 0.1, 1), b = random_vector(system.dim(), 0.1, 2);
    Vector pull = Vector::Zero(system.dim());
    load.add_net_pull(a, pull);
    EXPECT_TRUE(is_near(load.dead_force() - pull, load.at(a), 1e-13 * load.force.norm()));
    const auto potential = [&](VectorIn u) { return load.pull_energy(u) - load.force.dot(u); };
    const auto net = [&](VectorIn u) { return load.net_pull_energy(u) - load.dead_force().dot(u); };
    EXPECT_NEAR(net(a) - net(b), potential(a) - potential(b), 1e-12 * std::abs(net(a)));
    EXPECT_NEAR(net(Vector::Zero(system.dim())), 0.5 * (30 * 0.01 + 20 * 0.25 + 1e9 * 0.05), 1e-6);
  };
  check(*full);
  check(galerkin);
  check(reduced);
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
