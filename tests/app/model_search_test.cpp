#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace supple::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

/// The command decides by what it measures; the bar has room for two models of the ladder.
struct ModelSearchTest : SuppleProcess {
  static Arguments small(const Arguments& more = {}) {
    Arguments arguments{"reduce", "bar:6x2x2",  "-o", "bar.supple",   "--fix", "x<=0",         "--poses",
                        "20",     "--held-out", "0",  "--equilibria", "6",     "--full-loads", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// The report of a run whose goal is missed.
  json missed(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: the goal is missed"));
    const json report = outcome.json();
    EXPECT_EQ(report["search"]["met"], false);
    return report;
  }
  /// That the model and its report are those of the chosen one.
  void expect_chosen(const json& report, std::size_t index) const {
    const json& search = report["search"];
    const json& chosen = search["tried"][index];
    EXPECT_EQ(search["chosen"], chosen["model"]);
    EXPECT_EQ(report["dimension"], chosen["dimension"]);
    EXPECT_EQ(report["points"], chosen["points"]);
    EXPECT_EQ(report["full_error"]["total"], chosen["full_error"]);
    const json info = this->report({"info", "bar.supple"});
    EXPECT_EQ(info["dimension"], chosen["dimension"]);
    EXPECT_EQ(info["points"], chosen["points"]);
  }
};

TEST_F(ModelSearchTest, ClimbsUntilTheErrorIsSmallEnough) {
  const json nearest = missed(small({"--full-error", "1e-9"}));
  const json& tried = nearest["search"]["tried"];
  ASSERT_EQ(tried.size(), 2u);
  const double coarse = tried[0]["full_error"], fine = tried[1]["full_error"];
  ASSERT_LT(fine, coarse);
  expect_chosen(nearest, 1);

  const json second = this->report(small({"--full-error", std::to_string(50 * (coarse + fine)) + " %"}));
  EXPECT_EQ(second["search"]["met"], true);
  ASSERT_EQ(second["search"]["tried"].size(), 2u);
  expect_chosen(second, 1);
  const json alone =
      this->report(small({"--subspace", "derivatives:num_derivatives=45", "--modes", "15", "--points", "80"}));
  EXPECT_EQ(alone["full_error"], second["full_error"]);
  EXPECT_FALSE(alone.contains("search"));

  const json first = this->report(small({"--full-error", "50%"}));
  ASSERT_EQ(first["search"]["tried"].size(), 1u);
  expect_chosen(first, 0);
  EXPECT_THAT(first["search"]["reason"].get<std::string>(), HasSubstr("the first of 1 model tried"));
  EXPECT_EQ(first["options"]["full_error"], "50%");
}

TEST_F(ModelSearchTest, TakesTheNearestThatIsFastEnough) {
  const json nearest = this->report(small({"--step-time", "10 s"}));
  ASSERT_EQ(nearest["search"]["tried"].size(), 2u);
  for (const json& model : nearest["search"]["tried"]) EXPECT_GT(model["step_seconds"], 0.0);
  expect_chosen(nearest, 1);
  const json fastest = missed(small({"--step-time", "1 ns"}));
  EXPECT_EQ(fastest["search"]["tried"].size(), 1u);  // larger ones are known to take longer
  expect_chosen(fastest, 0);
}

TEST_F(ModelSearchTest, SaysWhatItHasChosenAndWhy) {
  const Outcome outcome = supple(small({"--full-error", "50%"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, testing::AllOf(HasSubstr("d = 30, s = "), HasSubstr("; chosen"),
                                          HasSubstr("coarse to fine, with equilibria at most 50 % off")));
}

TEST_F(ModelSearchTest, StaysInTheSubspaceThatIsAskedFor) {
  Arguments arguments = small({"--full-error", "50%", "--subspace", "extended", "--candidates", "some.txt"});
  arguments[1] = "bar:8x4x4";
  std::string some;
  for (int k = 0; k < 768; k += 3) some += std::to_string(k) + "\n";
  write("some.txt", some);
  const json report = this->report(arguments);
  EXPECT_EQ(report["search"]["chosen"], "extended:modes=15:points=150");
  EXPECT_EQ(report["dimension"], 135);
}

TEST_F(ModelSearchTest, RefusesWhatLeavesNothingToChoose) {
  const auto refused = [&](const Arguments& more, const std::vector<std::string>& parts) {
    expect_refusal(small(more), parts);
  };
  refused({"--full-error", "5%", "--step-time", "1 ms"}, {"--full-error", "--step-time", "one of them"});
  for (const Arguments& size : {Arguments{"--points", "50"},
                                {"--modes", "5"},
                                {"--dimension", "30"},
                                {"--target-error", "0.01"},
                                {"--selector", "all"}})
    for (const Arguments& goal : {Arguments{"--full-error", "5%"}, {"--step-time", "50 us"}}) {
      Arguments both = goal;
      both.insert(both.end(), size.begin(), size.end());
      refused(both, {goal[0], size[0], "one of them"});
    }
  refused({"--full-error", "5%", "--subspace", "modal"}, {"--subspace modal", "--full-error", "derivatives"});
  refused({"--step-time", "50 m"}, {"--step-time", "'m' is not a unit of s"});
  refused({"--step-time", "0"}, {"--step-time", "> 0"});
  refused({"--full-error", "-1%"}, {"--full-error", "> 0"});
  Arguments blind = small({"--full-error", "5%"});
  *(std::ranges::find(blind, "--full-loads") + 1) = "0";
  expect_refusal(blind, {"--full-error", "--full-loads 0"});
  EXPECT_TRUE(files().empty()) << files().front();
}

}  // namespace
}  // namespace supple::test
