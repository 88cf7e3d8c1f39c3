#include <tests/viewer_session/small_view_model.hpp>
#include <viewer/session/edit_session.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace supple::test {

namespace {

using Grab = EditSession::Grab;

HandleRegion region(const ViewModel& model, auto rule, std::string name, bool movable = true) {
  HandleRegion result{.name = std::move(name), .nodes = {}, .samples = {}, .weight = {}, .movable = movable};
  for (const Index k : surface_nodes_where(model, rule)) result.nodes.push_back(model.geometry.nodes[k]);
  return result;
}
HandleRegion tip(const ViewModel& model) {
  return region(
      model, [](double x) { return x > 0.95; }, "tip");
}
HandleRegion foot(const ViewModel& model) {
  return region(
      model, [](double x) { return x < 0.05; }, "foot", /*movable=*/false);
}

/// A turn of the tip about the middle of the bar, and up a bit.
RigidMotion bend(const ViewModel& model, double angle) {
  return RigidMotion::turn({0, 0, 1}, angle, 0.5 * (model.box.lower + model.box.upper), {0, 0.02, 0});
}

int settle(EditSession& session) {
  int solves = 0;
  for (; !session.settled(); ++solves) (void)session.solve();
  return solves;
}

TEST(EditSessionTest, TheShapeFollowsAHandle) {
  const auto model = clamped_view_model();
  EditSession session(model);
  const Index id = session.add(tip(*model));
  session.move(id, bend(*model, 0.3));
  EXPECT_FALSE(session.settled());
  settle(session);
  const Index node = surface_node_near(*model, model->box.upper);
  const Point target = bend(*model, 0.3)(model->geometry.rest.row(node).transpose());
  EXPECT_LT((place_of(*model, session.state(), node) - target).norm(), 0.02 * model->diagonal);
  EXPECT_GT(session.elastic_energy(), 0);
  EXPECT_GE(session.control_energy(), 0);
}

TEST(EditSessionTest, GoesLargeMotionsInSteps) {
  const auto model = free_view_model();
  EditSession session(model);
  session.add(foot(*model));
  const Index id = session.add(tip(*model));
  session.move(id, bend(*model, 1.5));
  EXPECT_GE(settle(session), 6);  // 15 degrees each
}

TEST(EditSessionTest, AHandleThatIsMadeOnABentShapeBeginsThere) {
  const auto model = clamped_view_model();
  EditSession session(model);
  session.move(session.add(tip(*model)), bend(*model, 0.3));
  settle(session);
  const Vector before = session.state();
  session.add(region(
      *model, [](double x) { return 0.4 < x && x < 0.6; }, "waist"));
  settle(session);
  EXPECT_LT((session.state() - before).norm(), 0.05 * before.norm());
  EXPECT_FALSE(session.handles().back().motion.rotation.isIdentity(1e-3));
}

TEST(EditSessionTest, UndoAndRedoLeadToTheVeryShapes) {
  const auto model = clamped_view_model();
  EditSession session(model);
  std::vector<Vector> shapes{session.state()};
  const auto keep = [&] {
    settle(session);
    shapes.push_back(session.state());
  };
  const Index id = session.add(tip(*model));
  keep();
  session.move(id, bend(*model, 0.1), Grab::Yes);
  session.move(id, bend(*model, 0.2));
  keep();
  const Index other = session.add(region(
      *model, [](double x) { return 0.4 < x && x < 0.6; }, "waist"));
  keep();
  session.move(other, bend(*model, 0.05), Grab::Yes);
  keep();
  session.remove(id);
  keep();
  for (std::size_t k = shapes.size() - 1; k-- > 0;) {
    ASSERT_TRUE(session.can_undo());
    session.undo();
    EXPECT_TRUE(session.settled());
    EXPECT_EQ(session.state(), shapes[k]) << "undone to " << k;
  }
  EXPECT_FALSE(session.can_undo());
  EXPECT_TRUE(session.handles().empty());
  for (std::size_t k = 1; k < shapes.size(); ++k) {
    ASSERT_TRUE(session.can_redo());
    session.redo();
    EXPECT_EQ(session.state(), shapes[k]) << "redone to " << k;
  }
  EXPECT_FALSE(session.can_redo());
  ASSERT_EQ(session.handles().size(), 1u);
  EXPECT_EQ(session.handles().front().id, other);
  session.undo();
  session.add(region(
      *model, [](double x) { return 0.6 < x && x < 0.7; }, "neck"));
  EXPECT_FALSE(session.can_redo());  // another future
}

TEST(EditSessionTest, ASavedSceneLeadsToTheSameShape) {
  const auto model = free_view_model();
  EditSession session(model);
  session.add(foot(*model));
  const Index id = session.add(tip(*model));
  session.move(id, bend(*model, 0.8));
  settle(session);
  const EditScene scene = session.scene();
  ASSERT_EQ(scene.handles.size(), 2u);
  EXPECT_FALSE(scene.handles[0].movable);
  EXPECT_GE(scene.edits.front().increments, 4);
  EditSession again(model);
  again.load(scene);
  settle(again);
  EXPECT_LT((again.state() - session.state()).norm(), 1e-4 * session.state().norm());
  EXPECT_EQ(again.handles()[1].motion.translation, session.handles()[1].motion.translation);
  again.undo();
  EXPECT_TRUE(again.handles().empty());

  // `supple edit` goes the same way
  const AnySystem<Matrix> system = model->system;
  Editor editor(system, model->rest());
  const std::vector<Handle> handles = make_handles(scene, model->softest_eigenvalue(), model->mass);
  for (const Handle& handle : handles) (void)editor.add(handle);
  for (const auto& motions : handle_paths(scene, handles, model->rest())) {
    for (Index h = 0; h < 2; ++h) editor.move(h, motions[h]);
    (void)editor.solve();
  }
  EXPECT_LT((editor.state() - session.state()).norm(), 1e-3 * session.state().norm());
}

TEST(EditSessionTest, WithoutHandlesItIsAtRest) {
  const auto model = free_view_model();
  EditSession session(model);
  const Index id = session.add(tip(*model));
  session.move(id, bend(*model, 0.4));
  settle(session);
  session.remove(id);
  settle(session);
  EXPECT_TRUE(session.state().isZero(0));
  EXPECT_THROW((void)session.scene(), std::invalid_argument);
}

TEST(EditSessionTest, OneNodeOfAFreeObjectIsAHandle) {
  const auto model = free_view_model();
  EditSession session(model);
  HandleRegion one = tip(*model);
  one.nodes.resize(1);
  RigidMotion up;
  up.translation = {0, 0.1, 0};
  session.move(session.add(one), up);
  settle(session);
  EXPECT_TRUE(session.state().allFinite());
  EXPECT_LT(session.elastic_energy(), 1e-6);  // it goes along
}

TEST(EditSessionTest, TellsWhenTheSubspaceCannotFollow) {
  const auto model = clamped_view_model();
  EditSession session(model);
  const Index id = session.add(region(
      *model, [](double x) { return 0.45 < x && x < 0.55; }, "waist"));
  settle(session);
  EXPECT_LT(session.held(), held_over_diagonal_at_most);
  session.move(id, RigidMotion::turn({1, 0, 0}, 2.5, model->rest().colwise().mean().transpose()));
  settle(session);
  EXPECT_GT(session.held(), held_over_diagonal_at_most);
}

TEST(EditSessionTest, RefusesWhatMakesNoSenseAndChangesNothing) {
  const auto model = clamped_view_model();
  EditSession session(model);
  const Index id = session.add(tip(*model));
  const auto refuses = [&](auto action) {
    const std::size_t handles = session.handles().size();
    EXPECT_THROW(action(), std::invalid_argument);
    EXPECT_EQ(session.handles().size(), handles);
    EXPECT_EQ(session.handles().front().id, id);
    EXPECT_TRUE(session.handles().front().motion.translation.isZero(0));
  };
  refuses([&] { session.add({.name = "none", .nodes = {}, .samples = {}, .weight = {}}); });
  refuses([&] { session.add({.name = "", .nodes = {-1}, .samples = {}, .weight = {}}); });
  refuses([&] { session.add({.name = "", .nodes = {model->rest().rows()}, .samples = {}, .weight = {}}); });
  refuses([&] { session.add({.name = "", .nodes = fixed_nodes(model->model.body), .samples = {}, .weight = {}}); });
  refuses([&] { session.add(tip(*model)); });  // the name is taken
  refuses([&] { session.move(id + 1, {}); });
  refuses([&] { session.remove(id + 1); });
  RigidMotion far;
  far.translation = {1e6, 0, 0};
  refuses([&] { session.move(id, far); });
  far.translation[0] = std::numeric_limits<double>::quiet_NaN();
  refuses([&] { session.move(id, far); });
  EditScene bad = session.scene();
  bad.handles.push_back(bad.handles.front());
  refuses([&] { session.load(bad); });
  const Index held = session.add(region(
      *model, [](double x) { return 0.4 < x && x < 0.6; }, "waist", false));
  EXPECT_THROW(session.move(held, {}), std::invalid_argument);
}

}  // namespace

}  // namespace supple::test
