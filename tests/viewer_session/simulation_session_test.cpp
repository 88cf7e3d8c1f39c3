#include <core/check.hpp>
#include <tests/viewer_session/small_view_model.hpp>
#include <viewer/session/scaled_system.hpp>
#include <viewer/session/simulation_session.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace supple::test {

namespace {

using testing::HasSubstr;

/// Strongly damped, so that it comes to rest.
ViewSettings damped(const ViewModel& model) {
  const double omega = 2 * std::numbers::pi * model.frequency(0);
  return {.step = model.default_step(), .damping = {.alpha = 2 * omega}};
}

void settle(SimulationSession& session, int steps = 600) {
  for (int k = 0; k < steps; ++k) ASSERT_EQ(session.step().failure, "");
}

/// The tip of the bar, and a sideways target a tenth of its length away.
Pull pull_at_tip(const ViewModel& model) {
  const Index tip = surface_node_near(model, model.box.upper);
  return {.node = tip, .target = model.geometry.rest.row(tip).transpose() + Point(0, 0.1 * model.box.extent()[0], 0)};
}

TEST(SimulationSessionTest, APullMovesItsNodeToTheTargetUntilTheSpringBalancesTheObject) {
  const auto model = clamped_view_model();
  SimulationSession session(model);
  session.set(damped(*model));
  const Pull pull = pull_at_tip(*model);
  session.pull(1, pull);
  const double distance = (place_of(*model, session.state().u, pull.node) - pull.target).norm();
  settle(session, 5);
  EXPECT_LT((place_of(*model, session.state().u, pull.node) - pull.target).norm(), 0.9 * distance);
  settle(session);
  EXPECT_LT((place_of(*model, session.state().u, pull.node) - pull.target).norm(), 0.3 * distance);
  // f(q) = Uᵀ k (target − x), with the default stiffness
  const Vector force = model->system.force(session.state().u);
  Loads loads;
  loads.forces.push_back(
      {model->geometry.nodes[pull.node],
       default_pull_stiffness(*model) * (pull.target - place_of(*model, session.state().u, pull.node))});
  const Vector spring = model->system.project(loads).force;
  EXPECT_LT((force - spring).norm(), 1e-4 * spring.norm());
}

TEST(SimulationSessionTest, LettingGoLeadsBackToRest) {
  const auto model = clamped_view_model();
  SimulationSession session(model);
  session.set(damped(*model));
  session.pull(1, pull_at_tip(*model));
  settle(session, 50);
  const double pulled = session.state().u.norm();
  session.release(1);
  EXPECT_TRUE(session.pulls().empty());
  settle(session);
  EXPECT_LT(session.state().u.norm(), 1e-4 * pulled);
}

TEST(SimulationSessionTest, EachClientHasOnePullAndTheyAddUp) {
  const auto model = clamped_view_model();
  const Pull pull = pull_at_tip(*model);
  SimulationSession two(model), stiff(model);
  two.pull(1, pull);
  two.pull(2, pull);
  two.pull(2, pull);
  EXPECT_EQ(two.pulls().size(), 2u);
  Pull twice = pull;
  twice.stiffness = 2 * default_pull_stiffness(*model);
  stiff.pull(7, twice);
  settle(two, 5);
  settle(stiff, 5);
  EXPECT_LT((two.state().u - stiff.state().u).norm(), 1e-5 * stiff.state().u.norm());
}

TEST(SimulationSessionTest, AMovedTargetIsTheSameAsAPullFromTheStart) {
  const auto model = clamped_view_model();
  Pull pull = pull_at_tip(*model), elsewhere = pull;
  elsewhere.target += Point(0.3, 0.2, 0.1);
  SimulationSession moved(model), direct(model);
  moved.pull(1, elsewhere);
  moved.pull(1, pull);  // the short way: only the target has changed
  direct.pull(1, pull);
  settle(moved, 5);
  settle(direct, 5);
  EXPECT_EQ(moved.state().u, direct.state().u);
  EXPECT_EQ(moved.outside_potential(), direct.outside_potential());
}

TEST(SimulationSessionTest, KeepsTheEnergyWithoutDamping) {
  const auto model = clamped_view_model();
  SimulationSession session(model);
  session.set({.gravity = {0, -3, 0}, .step = model->default_step()});
  double most = 0;
  for (int k = 0; k < 300; ++k) {
    settle(session, 1);
    const double total = session.kinetic_energy() + session.elastic_energy() + session.outside_potential();
    most = std::max(most, session.kinetic_energy());
    EXPECT_NEAR(total, 0, 1e-4 * most);  // it began at rest; steps are solved to 1e-6 of the forces
  }
  EXPECT_GT(most, 0);
  EXPECT_LT(std::abs(session.energy_made()), 1e-4 * most);
  EXPECT_FALSE(session.makes_energy());
}

TEST(SimulationSessionTest, EnergyIsAccountedForAcrossChangesOfSettings) {
  const auto model = clamped_view_model();
  SimulationSession session(model);
  for (const char* integrator : {"newmark", "backward-euler"}) {
    session.set({.gravity = {0, -3, 0}, .step = model->default_step(), .integrator = {integrator}});
    settle(session, 60);
  }
  EXPECT_LT(session.energy_made(), 0);  // backward Euler damps
  const double total = session.kinetic_energy() + session.elastic_energy() + session.outside_potential();
  EXPECT_NEAR(total, session.energy_made(), 0.01 * std::abs(total));
}

TEST(SimulationSessionTest, ResetLeadsToTheVeryStart) {
  const auto model = clamped_view_model();
  SimulationSession session(model), fresh(model);
  const Pull pull = pull_at_tip(*model);
  session.pull(1, pull);
  settle(session, 20);
  session.reset();
  EXPECT_EQ(session.state().time, 0);
  EXPECT_EQ(session.num_steps(), 0);
  EXPECT_TRUE(session.state().u.isZero(0));
  EXPECT_EQ(session.energy_made(), 0);
  fresh.pull(1, pull);
  settle(session, 20);
  settle(fresh, 20);
  EXPECT_LT((session.state().u - fresh.state().u).norm(), 1e-4 * fresh.state().u.norm());  // steps are solved to 1e-6
}

TEST(SimulationSessionTest, TheFactorOnTheStiffnessScalesSquaredFrequencies) {
  const auto model = clamped_view_model();
  const AnySystem<Matrix> four = scaled(model->system, 4);
  const ReducedModes once = reduced_modes(model->system.rest_stiffness(), 0),
                     scaled_modes = reduced_modes(four.rest_stiffness(), 0);
  EXPECT_LT((scaled_modes.omega - 2 * once.omega).norm(), 1e-9 * once.omega.norm());
  const Vector q = 0.05 * model->diagonal * std::sqrt(model->mass) * model->mode(0);
  EXPECT_NEAR(four.energy(q), 4 * model->system.energy(q), 1e-12 * four.energy(q));
  EXPECT_LT((four.stiffness(q) - 4 * model->system.stiffness(q)).norm(), 1e-12 * four.stiffness(q).norm());

  // a small motion of an object four times as stiff runs twice as fast, and so half as far under the same load
  SimulationSession normal(model), stiff(model);
  const double h = model->default_step() / 4;
  normal.set({.gravity = {0, -0.01, 0}, .step = 2 * h});
  stiff.set({.gravity = {0, -0.01, 0}, .step = h, .stiffness = 4});
  settle(normal, 40);
  settle(stiff, 40);
  EXPECT_LT((4 * stiff.state().u - normal.state().u).norm(), 1e-2 * normal.state().u.norm());
}

TEST(SimulationSessionTest, HeldNodesStayWhereTheyAre) {
  const auto model = clamped_view_model();
  SimulationSession session(model);
  session.set({.gravity = {0, -3, 0}, .step = model->default_step()});
  settle(session, 10);
  const std::vector<Index> tip = surface_nodes_where(*model, [](double x) { return x > 0.95; });
  const Point held = place_of(*model, session.state().u, tip.front());
  session.hold(tip);
  EXPECT_EQ(session.held(), tip);
  ViewSettings settings = damped(*model);
  settings.gravity = {0, -3, 0};
  session.set(settings);
  settle(session, 200);
  EXPECT_LT((place_of(*model, session.state().u, tip.front()) - held).norm(), 0.01 * model->diagonal);
  session.hold({});
  settle(session, 200);
  EXPECT_GT((place_of(*model, session.state().u, tip.front()) - held).norm(), 0.02 * model->diagonal);
}

TEST(SimulationSessionTest, TheFloorBearsAFreeObject) {
  const auto model = free_view_model();
  SimulationSession session(model);
  ViewSettings settings{.gravity = {0, -9.81, 0}, .step = model->default_step(), .damping = {.alpha = 5, .beta = 1e-3}};
  const double height = model->box.lower[1] - 0.05 * model->diagonal;
  settings.floor = Floor{FloorAxis::Y, height};
  session.set(settings);
  for (int k = 0; k < 800; ++k) {
    settle(session, 1);
    const auto u = model->geometry.surface_displacements(session.state().u);
    const double lowest = (model->geometry.rest.topRows(u.rows()).col(1) + u.col(1).cast<double>()).minCoeff();
    ASSERT_GT(lowest, height - 0.1 * model->diagonal) << "step " << k;
  }
  EXPECT_LT(session.kinetic_energy(), 1e-3 * model->mass * 9.81 * 0.05 * model->diagonal);
}

TEST(SimulationSessionTest, TakesBackAStepThatEndsNowhere) {
  const auto model = boastful_view_model();
  SimulationSession session(model);
  session.set({.gravity = {0, -30, 0}, .step = model->default_step()});
  std::string failure;
  Vector before;
  for (int k = 0; k < 200 && failure.empty(); ++k) {
    before = session.state().u;
    failure = session.step().failure;
  }
  ASSERT_NE(failure, "");
  EXPECT_EQ(session.state().u, before);
  EXPECT_TRUE(session.state().u.allFinite() && session.state().v.allFinite());
  session.reset();
  session.set({.step = model->default_step()});
  EXPECT_EQ(session.step().failure, "");
}

TEST(SimulationSessionTest, RefusesWhatMakesNoSenseAndChangesNothing) {
  const auto model = clamped_view_model();
  SimulationSession session(model);
  const Pull good = pull_at_tip(*model);
  session.pull(1, good);
  const auto refuses_pull = [&](Pull pull, const char* reason) {
    try {
      session.pull(1, pull);
      ADD_FAILURE() << "expected: " << reason;
    } catch (const std::invalid_argument& error) {
      EXPECT_THAT(error.what(), HasSubstr(reason));
    }
    EXPECT_EQ(session.pulls().at(1).node, good.node);
    EXPECT_EQ(session.pulls().at(1).target, good.target);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refuses_pull({.node = -1}, "not on the surface");
  refuses_pull({.node = model->geometry.num_surface_nodes}, "not on the surface");
  refuses_pull({.node = model->geometry.fixed.front()}, "held by the model");
  refuses_pull({.node = good.node, .target = {nan, 0, 0}}, "target");
  refuses_pull({.node = good.node, .target = {0, 1e9, 0}}, "100 diagonals");
  refuses_pull({.node = good.node, .target = good.target, .stiffness = nan}, "stiffness");
  refuses_pull({.node = good.node, .target = good.target, .stiffness = -1.0}, "stiffness");
  EXPECT_THROW(session.hold({0, model->geometry.num_nodes()}), std::invalid_argument);
  EXPECT_TRUE(session.held().empty());
  const ViewSettings before = session.settings();
  const auto refuses = [&](auto change) {
    ViewSettings settings = before;
    change(settings);
    EXPECT_THROW(session.set(settings), std::invalid_argument);
    EXPECT_EQ(session.settings().step, before.step);
    EXPECT_EQ(session.settings().integrator.name, before.integrator.name);
  };
  refuses([&](ViewSettings& s) { s.gravity[1] = nan; });
  refuses([&](ViewSettings& s) { s.step = 0; });
  refuses([&](ViewSettings& s) { s.step = nan; });
  refuses([&](ViewSettings& s) { s.speed = 100; });
  refuses([&](ViewSettings& s) { s.stiffness = -1; });
  refuses([&](ViewSettings& s) { s.damping.alpha = -1; });
  refuses([&](ViewSettings& s) { s.integrator = {"euler"}; });
  refuses([&](ViewSettings& s) { s.integrator = {"newmark", {{"beta", "-1"}}}; });
  refuses([&](ViewSettings& s) { s.floor = Floor{FloorAxis::Y, nan}; });
}

TEST(SpreadSampleTest, CoversThePointsAsDenselyAsItsOwnAreApart) {
  const Points grid = Points::NullaryExpr(125, 3, [](Index k, Index x) {
    const Index digits[]{k / 25, k / 5 % 5, k % 5};
    return static_cast<double>(digits[x]);
  });
  EXPECT_THAT(spread_sample(grid, 2), testing::ElementsAre(0, 124));  // opposite corners
  const std::vector<Index> sample = spread_sample(grid, 10);
  ASSERT_EQ(sample.size(), 10u);
  const auto distance = [&](Index a, Index b) { return (grid.row(a) - grid.row(b)).norm(); };
  double apart = 100, covered = 0;
  for (const Index a : sample)
    for (const Index b : sample)
      if (a != b) apart = std::min(apart, distance(a, b));
  for (Index k = 0; k < grid.rows(); ++k) {
    double nearest = 100;
    for (const Index a : sample) nearest = std::min(nearest, distance(a, k));
    covered = std::max(covered, nearest);
  }
  EXPECT_LE(covered, apart);
  EXPECT_EQ(spread_sample(grid, 1000).size(), 125u);
  EXPECT_TRUE(spread_sample(grid, 0).empty());
}

}  // namespace

}  // namespace supple::test
