#include <tests/viewer_session/small_view_model.hpp>
#include <viewer/session/view_session.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace supple::test {

namespace {

/// A session whose steps take no time, by the clock that it is given.
struct Timed {
  std::shared_ptr<const ViewModel> model = clamped_view_model();
  double now = 0, tick = 0;  // the clock, and how much it goes on whenever somebody looks
  ViewSession session{model, [this] { return now += tick; }};

  Timed() { session.join(1); }
  void operator()(const Request& request) { session.apply(1, request); }
};

TEST(PacemakerTest, KeepsUpAndSaysWhenItCannot) {
  Pacemaker pace;
  int steps = 0;
  for (int k = 0; k < 60; ++k)
    for (pace.pass(1.0 / 60, 1); pace.is_due(0.005); ++steps) pace.stepped(0.005);
  EXPECT_EQ(steps, 200);
  EXPECT_NEAR(pace.speed(), 1, 0.02);
  EXPECT_NEAR(pace.steps_per_second(), 200, 4);
  EXPECT_FALSE(pace.falls_behind());
  pace.pass(0.2, 1);  // a hiccup
  EXPECT_FALSE(pace.falls_behind());
  for (steps = 0; pace.is_due(0.005); ++steps) pace.stepped(0.005);
  EXPECT_EQ(steps, 40);
  pace.pass(10, 1);
  EXPECT_TRUE(pace.falls_behind());
  for (steps = 0; pace.is_due(0.005); ++steps) pace.stepped(0.005);
  EXPECT_EQ(steps, 50);  // the rest is lost
  for (int k = 0; k < 6; ++k)
    for (pace.pass(0.2, 1); pace.is_due(0.005);) pace.stepped(0.005);
  EXPECT_FALSE(pace.falls_behind());
  EXPECT_NEAR(pace.until_due(1, 0.1), 10, 0.05);
}

TEST(ViewSessionTest, BeginsPausedAndRunsInRealTimeWhenItPlays) {
  Timed timed;
  ViewSession& session = timed.session;
  session.advance(1);
  EXPECT_EQ(session.frame().num_steps, 0);
  EXPECT_TRUE(std::isinf(session.until_due()));
  timed(request::Play{});
  for (int k = 0; k < 100; ++k) session.advance(0.01);
  const double h = session.settings().step;
  EXPECT_NEAR(session.frame().time, 1, 1.01 * h);
  EXPECT_LE(session.until_due(), h);
  timed(request::Set{{.speed = 0.1}});
  const double before = session.frame().time;
  for (int k = 0; k < 100; ++k) session.advance(0.01);
  EXPECT_NEAR(session.frame().time - before, 0.1, 1.01 * h);
  timed(request::Pause{});
  const Index steps = session.frame().num_steps;
  session.advance(1);
  EXPECT_EQ(session.frame().num_steps, steps);
}

TEST(ViewSessionTest, StopsAtItsBudgetAndSaysThatItFallsBehind) {
  Timed timed;
  timed.tick = 0.01;  // a step takes as long
  timed(request::Set{{.step = 0.001}});
  timed(request::Play{});
  timed.session.advance(0.1);
  EXPECT_LE(timed.session.frame().num_steps, 4);
  for (int k = 0; k < 10; ++k) timed.session.advance(0.1);
  EXPECT_TRUE(timed.session.frame().falls_behind);
  EXPECT_LT(timed.session.frame().speed, 0.1);
}

TEST(ViewSessionTest, TakesStepsOneByOne) {
  Timed timed;
  timed(request::Play{});
  timed(request::Step{7});
  EXPECT_FALSE(timed.session.playing());
  timed.session.advance(0);
  EXPECT_EQ(timed.session.frame().num_steps, 7);
  for (int k = 0; k < 3; ++k) timed(request::Step{1000});  // they add up
  timed.session.advance(0);
  EXPECT_EQ(timed.session.frame().num_steps, 3007);
  EXPECT_THROW(timed(request::Step{0}), std::invalid_argument);
  EXPECT_THROW(timed(request::Step{1001}), std::invalid_argument);
}

TEST(ViewSessionTest, ClientsShareAllButTheirPulls) {
  Timed timed;
  ViewSession& session = timed.session;
  session.join(2);
  EXPECT_THROW(session.join(2), std::invalid_argument);
  EXPECT_THROW(session.apply(3, request::Play{}), std::invalid_argument);
  const Index tip = surface_node_near(*timed.model, timed.model->box.upper);
  session.apply(1, request::PullAt{{.node = tip, .target = {1, 1, 0}}});
  session.apply(2, request::PullAt{{.node = tip, .target = {1, 0, 1}}});
  EXPECT_EQ(session.simulation().pulls().size(), 2u);
  session.apply(1, request::Release{});
  ASSERT_EQ(session.simulation().pulls().size(), 1u);
  const Index changes = session.num_changes();
  session.leave(2);
  EXPECT_TRUE(session.simulation().pulls().empty());
  EXPECT_GT(session.num_changes(), changes);
  EXPECT_EQ(session.num_clients(), 1);
}

TEST(ViewSessionTest, SettingsChangeTogetherOrNotAtAll) {
  Timed timed;
  const Index changes = timed.session.num_changes();
  EXPECT_THROW(timed(request::Set{{.gravity = Point(0, -1, 0), .speed = 1000}}), std::invalid_argument);
  EXPECT_TRUE(timed.session.settings().gravity.isZero(0));
  EXPECT_EQ(timed.session.num_changes(), changes);
  timed(request::Set{{.gravity = Point(0, -1, 0), .floor = std::optional(Floor{})}});
  timed(request::Set{{.speed = 0.5}});
  EXPECT_EQ(timed.session.settings().gravity[1], -1);
  EXPECT_TRUE(timed.session.settings().floor.has_value());
  timed(request::Set{{.floor = std::optional<Floor>()}});
  EXPECT_FALSE(timed.session.settings().floor.has_value());
}

TEST(ViewSessionTest, EditingHasAShapeOfItsOwn) {
  Timed timed;
  ViewSession& session = timed.session;
  timed(request::SetMode{ViewMode::Edit});
  timed(request::MakeHandle{surface_nodes_where(*timed.model, [](double x) { return x > 0.95; }), "tip"});
  RigidMotion up;
  up.translation = {0, 0.05, 0};
  timed(request::MoveHandle{session.edit().handles().front().id, up, true});
  EXPECT_EQ(session.until_due(), 0);
  session.advance(0);
  EXPECT_TRUE(std::isinf(session.until_due()));
  const Vector shape = session.frame().q;
  EXPECT_GT(shape.norm(), 0);
  timed(request::SetMode{ViewMode::Simulate});
  EXPECT_TRUE(session.frame().q.isZero(0));
  timed(request::SetMode{ViewMode::Edit});
  EXPECT_EQ(session.frame().q, shape);
  timed(request::Undo{});
  EXPECT_TRUE(session.frame().q.norm() < 1e-9 * shape.norm());
  timed(request::Redo{});
  EXPECT_THROW(timed(request::Redo{}), std::invalid_argument);
  timed(request::Reset{});
  EXPECT_TRUE(session.frame().q.isZero(0));
  EXPECT_THROW(timed(request::MakeHandle{{timed.model->geometry.num_nodes()}}), std::invalid_argument);
}

TEST(ViewSessionTest, WarnsOnceWhereTheSubspaceCannotFollow) {
  Timed timed;
  timed(request::SetMode{ViewMode::Edit});
  timed(request::MakeHandle{surface_nodes_where(*timed.model, [](double x) { return 0.45 < x && x < 0.55; })});
  const Index id = timed.session.edit().handles().front().id;
  const Point centre = timed.model->rest().colwise().mean().transpose();
  for (const double angle : {2.4, 2.45, 2.5}) {
    timed(request::MoveHandle{id, RigidMotion::turn({1, 0, 0}, angle, centre)});
    timed.session.advance(0);
  }
  const std::vector<std::string> warnings = timed.session.take_warnings();
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings.front().find("cannot take the shape"), std::string::npos);
  EXPECT_TRUE(timed.session.take_warnings().empty());
}

TEST(ViewSessionTest, PlaysModesThroughRestWithTheSizeAskedFor) {
  Timed timed;
  ViewSession& session = timed.session;
  timed(request::SetMode{ViewMode::Modes});
  timed(request::ShowMode{2, 0.2});
  EXPECT_TRUE(session.playing());
  EXPECT_TRUE(session.frame().q.isZero(0));
  double most = 0, total = 0;
  for (int k = 0; k < 400; ++k) {
    session.advance(0.01);
    const ViewFrame frame = session.frame();
    most = std::max<double>(most, timed.model->geometry.surface_displacements(frame.q).rowwise().norm().maxCoeff());
    if (k == 0) total = frame.kinetic + frame.elastic;
    EXPECT_NEAR(frame.kinetic + frame.elastic, total, 1e-9 * total);  // as of a free oscillation
    const Vector phi = timed.model->mode(2);
    EXPECT_LT((frame.q - phi * phi.dot(frame.q)).norm(), 1e-9);
  }
  EXPECT_NEAR(most, 0.2 * timed.model->diagonal, 0.01 * timed.model->diagonal);
  EXPECT_THROW(timed(request::ShowMode{timed.model->num_flexible_modes(), 0.1}), std::invalid_argument);
  EXPECT_THROW(timed(request::ShowMode{0, 2}), std::invalid_argument);
}

TEST(ViewSessionTest, PausesWithTheReasonWhenTheMotionCannotGoOn) {
  ViewSession session(boastful_view_model(), [] { return 0.0; });
  session.join(1);
  session.apply(1, request::Set{{.gravity = Point(0, -30, 0)}});
  session.apply(1, request::Play{});
  for (int k = 0; k < 100 && session.playing(); ++k) session.advance(0.1);
  EXPECT_FALSE(session.playing());
  const std::vector<std::string> warnings = session.take_warnings();
  ASSERT_FALSE(warnings.empty());
  EXPECT_NE(warnings.back().find("pauses at"), std::string::npos);
  EXPECT_TRUE(session.frame().q.allFinite());
  EXPECT_GT(session.frame().num_steps, 0);
}

TEST(ViewGeometryTest, ShowsWhatTheLibraryComputes) {
  for (const auto& model : {clamped_view_model(), free_view_model()}) {
    const ViewGeometry& geometry = model->geometry;
    const Vector q = 0.3 * model->diagonal * std::sqrt(model->mass) * (model->mode(0) + 0.3 * model->mode(3));
    const Vector u = model->system.expand(q);
    const auto shown = geometry.surface_displacements(q);
    for (Index k = 0; k < geometry.num_surface_nodes; ++k)
      EXPECT_LT((shown.row(k).cast<double>().transpose() - u.segment<3>(3 * geometry.nodes[k])).norm(),
                1e-5 * model->diagonal);
    for (std::size_t c = 0; c < model->model.indices.size(); ++c)
      for (int corner = 0; corner < geometry.component_nodes; ++corner)
        EXPECT_LT(geometry.corners[c * geometry.component_nodes + corner], geometry.num_nodes());
    EXPECT_EQ(geometry.number[geometry.nodes.back()], geometry.num_nodes() - 1);
  }
  EXPECT_EQ(clamped_view_model()->geometry.fixed.size(), fixed_nodes(clamped_view_model()->model.body).size());
}

}  // namespace

}  // namespace supple::test
