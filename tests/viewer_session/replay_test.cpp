#include <tests/viewer_session/small_view_model.hpp>
#include <viewer/session/view_session.hpp>

#include <gmock/gmock.h>

#include <cmath>

namespace supple::test {

namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

/// Frames in which all nodes move by rate · time along x.
ViewRecording steady(const std::string& name, const Vector& time, double rate) {
  ViewRecording recording{.name = name, .time = time, .frames = {}};
  const Index nodes = clamped_view_model()->geometry.num_surface_nodes;
  recording.frames.setZero(time.size(), 3 * nodes);
  for (Index k = 0; k < time.size(); ++k)
    for (Index v = 0; v < nodes; ++v) recording.frames(k, 3 * v) = static_cast<float>(rate * time[k]);
  return recording;
}

std::shared_ptr<const ViewModel> with(std::vector<ViewRecording> recordings) {
  const ViewModel& model = *clamped_view_model();
  return std::make_shared<const ViewModel>(model.model, "bar", std::vector<std::string>(), std::move(recordings));
}

const Vector evenly = Vector::LinSpaced(11, 0, 1);

TEST(ReplayTest, InterpolatesLinearlyBetweenMomentsOfAnySpacing) {
  const Vector unevenly = (Vector(4) << 0, 0.1, 0.7, 2).finished();
  Replay replay(with({steady("reduced", evenly, 1.1), steady("full", unevenly, 1)}));
  EXPECT_EQ(replay.duration(), 1);  // what both have
  for (const double t : {0.0, 0.05, 0.1, 0.33, 0.95, 1.0}) {
    replay.seek(t);
    EXPECT_NEAR(replay.displacements(0).col(0).maxCoeff(), 1.1 * t, 1e-6);
    EXPECT_NEAR(replay.displacements(1).col(0).minCoeff(), t, 1e-6);
    EXPECT_EQ(replay.displacements(1).rightCols<2>().cwiseAbs().maxCoeff(), 0);
    EXPECT_NEAR(replay.difference(), 0.1 * t / std::sqrt(unevenly.squaredNorm() / 4), 1e-6);
  }
  EXPECT_TRUE(std::isnan(Replay(with({steady("reduced", evenly, 1), steady("full", evenly, 0)})).difference()));
  EXPECT_TRUE(std::isnan(Replay(with({steady("full", evenly, 1)})).difference()));
}

TEST(ReplayTest, PlaysInALoop) {
  Replay replay(with({steady("full", evenly, 1)}));
  for (int k = 0; k < 27; ++k) replay.pass(0.1);
  EXPECT_NEAR(replay.time(), 0.7, 1e-9);
  replay.step(2);
  EXPECT_NEAR(replay.time(), 0.9, 1e-9);
  replay.step(2);
  EXPECT_EQ(replay.time(), 0);
  for (const double beyond : {-1e-9, 1.0 + 1e-9, std::nan("")})
    EXPECT_THAT([&] { replay.seek(beyond); }, ThrowsMessage<std::invalid_argument>(HasSubstr("expected 0 to 1 s")));
  Replay still(with({steady("full", Vector::Constant(1, 0.5), 1)}));
  still.pass(3);
  EXPECT_EQ(still.time(), 0.5);
  EXPECT_NEAR(still.displacements(0).col(0).maxCoeff(), 0.5, 1e-6);
}

TEST(ReplayTest, RefusesWhatIsNoRecordingOfTheModel) {
  const auto refuses = [](std::vector<ViewRecording> recordings, const char* reason) {
    EXPECT_THAT([&] { (void)with(recordings); }, ThrowsMessage<std::invalid_argument>(HasSubstr(reason))) << reason;
  };
  const ViewRecording good = steady("full", evenly, 1);
  refuses({good, good, good}, "at most 2");
  refuses({{.name = "empty", .time = {}, .frames = {}}}, "'empty' has no frames");
  ViewRecording bad = good;
  bad.frames.conservativeResize(bad.frames.rows(), bad.frames.cols() - 3);
  refuses({bad}, "expected 11 of");
  bad = good;
  bad.time[3] = bad.time[4];
  refuses({bad}, "do not ascend");
  bad = good;
  bad.frames(2, 5) = std::nanf("");
  refuses({bad}, "not finite");
  refuses({good, steady("later", Vector(evenly.array() + 2), 1)}, "no time in common");
}

TEST(ReplayTest, IsAModeOfSessionsThatHaveRecordings) {
  ViewSession session(with({steady("reduced", evenly, 2), steady("full", evenly, 1)}), [] { return 0.0; });
  session.join(1);
  const auto ask = [&](const Request& request) { session.apply(1, request); };
  EXPECT_EQ(session.mode(), ViewMode::Replay);
  EXPECT_TRUE(session.playing());
  ask(request::Set{{.speed = 0.5}});
  for (int k = 0; k < 10; ++k) session.advance(0.1);
  EXPECT_NEAR(session.frame().time, 0.5, 1e-9);
  ASSERT_EQ(session.frame().displacements.size(), 2u);
  EXPECT_NEAR(session.frame().displacements[0].col(0).maxCoeff(), 1, 1e-6);
  EXPECT_NEAR(session.frame().error, 0.5 / std::sqrt(evenly.squaredNorm() / 11), 1e-5);
  ask(request::Seek{0.31});
  ask(request::Step{});
  EXPECT_FALSE(session.playing());
  EXPECT_NEAR(session.frame().time, 0.4, 1e-9);
  ask(request::Reset{});
  EXPECT_EQ(session.frame().time, 0);

  ask(request::SetMode{ViewMode::Simulate});
  EXPECT_TRUE(session.frame().displacements.empty());
  EXPECT_EQ(session.frame().q.size(), session.model().dim());
  ask(request::SetMode{ViewMode::Replay});

  ViewSession plain(clamped_view_model());
  plain.join(1);
  EXPECT_THROW(plain.apply(1, request::SetMode{ViewMode::Replay}), std::invalid_argument);
  EXPECT_THROW(plain.apply(1, request::Seek{0}), std::invalid_argument);
  EXPECT_EQ(plain.mode(), ViewMode::Simulate);
}

}  // namespace

}  // namespace supple::test
