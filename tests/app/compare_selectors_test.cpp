#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <algorithm>

namespace supple::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

struct CompareSelectorsTest : SuppleProcess {
  Arguments small(const Arguments& more = {}) const {
    Arguments arguments{"compare-selectors", "bar:8x2x2", "--fix",      "x<=0", "--modes", "4",
                        "--poses",           "20",        "--held-out", "10"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

TEST_F(CompareSelectorsTest, RunsEverySelectorAtEverySizeWithEverySeed) {
  const Outcome outcome = supple(small({"--selectors", "nn-sp,nn-htp,random", "--sizes", "20,40", "--runs", "2", "-o",
                                        "out", "--trajectories", "--json", "report.json"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("| nn-sp | 20 |"));
  const json report = json::parse(read("report.json"));
  ASSERT_EQ(report["runs"].size(), 12u);
  double best = 1, worst = 0;
  for (const json& run : report["runs"]) {
    EXPECT_LE(run["points"], run["size"]);
    EXPECT_EQ(run["held_out"].size(), 3u);
    EXPECT_EQ(run["trajectory_errors"].size(), 3u);
    if (run["size"] == 40 && run["selector"] == "nn-sp") best = std::min(best, run["training_error"].get<double>());
    if (run["size"] == 40 && run["selector"] == "random") worst = std::max(worst, run["training_error"].get<double>());
  }
  EXPECT_LT(best, worst);
  for (const char* file : {"runs.csv", "table.md", "index.html", "error-size.svg", "error-time.svg", "convergence.svg",
                           "trajectory-1.svg", "trajectory-3.svg"})
    EXPECT_TRUE(std::filesystem::exists(folder / "out" / file)) << file;
  const std::string page = read("out/index.html");
  EXPECT_THAT(page, HasSubstr("<svg"));
  EXPECT_THAT(page, HasSubstr("</html>"));
}

TEST_F(CompareSelectorsTest, RunsEveryOtherSelectorAndTheCeilingAtItsOwnSize) {
  const json report = this->report(small({"--selectors",
                                          "nn-htp-full,htp,niht,nn-niht,greedy,batched-greedy,nn-omp,ecsw,"
                                          "ecm,all",
                                          "--sizes", "20", "--runs", "2"}));
  ASSERT_EQ(report["runs"].size(), 19u);
  const json& all = report["runs"].back();
  EXPECT_EQ(all["selector"], "all");
  EXPECT_EQ(all["size"], 192);
  EXPECT_LT(all["training_error"], 1e-7);
  for (const json& run : report["runs"]) EXPECT_GE(run["training_error"], all["training_error"]);
}

TEST_F(CompareSelectorsTest, TrainsGreedyOnSubsetsOfPoses) {
  const auto error = [&](const Arguments& more) {
    Arguments arguments = small({"--selectors", "greedy", "--sizes", "30", "--runs", "1"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return report(arguments)["runs"][0]["training_error"].get<double>();
  };
  const double all = error({}), some = error({"--train-groups", "3"});
  EXPECT_NE(all, some);
  EXPECT_LT(some, 1);
  EXPECT_EQ(all, error({"--train-groups", "26"}));  // 20 random poses, 6 equilibria
}

TEST_F(CompareSelectorsTest, TakesTheUsualSizesThatTheObjectHasAndNothingTwice) {
  const json report = this->report(small({"--selectors", "random,batched-greedy,random", "--runs", "1"}));
  std::vector<std::pair<std::string, int>> runs;
  for (const json& run : report["runs"]) runs.emplace_back(run["selector"], run["size"]);
  EXPECT_THAT(runs, testing::ElementsAre(std::pair{"random", 50}, std::pair{"random", 100}, std::pair{"random", 150},
                                         std::pair{"batched-greedy", 50}, std::pair{"batched-greedy", 100},
                                         std::pair{"batched-greedy", 150}));  // of 192 tets
  EXPECT_EQ(this->report(small({"--selectors", "random", "--runs", "1", "--sizes", "9,9"}))["runs"].size(), 1u);
  EXPECT_THAT(report["description"].get<std::string>(), HasSubstr("20 training poses and 6 equilibria"));
}

TEST_F(CompareSelectorsTest, LeavesTheCeilingOutOfPlots) {
  ASSERT_EQ(supple(small({"--selectors", "random,all", "--sizes", "20", "--runs", "1", "-o", "out"})).exit_code, 0);
  EXPECT_THAT(read("out/error-size.svg"), testing::Not(HasSubstr(">all<")));
  EXPECT_THAT(read("out/index.html"), testing::AllOf(HasSubstr("<td>all</td>"), HasSubstr("0.3 and 0.1 of their")));
  ASSERT_EQ(supple(small({"--selectors", "all", "-o", "alone"})).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder / "alone" / "error-size.svg"));
}

TEST_F(CompareSelectorsTest, CountsGaussPointsOfHexahedra) {
  Arguments arguments = small({"--components", "gauss-points", "--selectors", "nn-sp", "--sizes", "20", "--runs", "1"});
  arguments[1] = "hexbox:6x2x2";
  EXPECT_THAT(report(arguments)["description"].get<std::string>(), HasSubstr("192 Gauss points"));
  arguments[1] = "bar:8x2x2";
  expect_refusal(arguments, {"--components"});
}

TEST_F(CompareSelectorsTest, RefusesWhatItCannotRun) {
  expect_refusal(small({"--selectors", "nn-sp,best"}), {"best"});
  expect_refusal(small({"--sizes", "20,1000"}), {"--sizes", "1000"});
  expect_refusal(small({"--sizes", "0"}), {"--sizes"});
  expect_refusal(small({"--runs", "0"}), {"--runs"});
  expect_refusal(small({"--selectors", "nn-sp", "--train-groups", "5"}), {"--train-groups", "greedy"});
  Arguments large = small({"--selectors", "all"});
  large[1] = "bar:20x20x20";
  expect_refusal(large, {"48000 tets", "at most 5000"});
  EXPECT_EQ(report(small({"--selectors", "all", "--sizes", "1000"}))["runs"].size(), 1u);  // sizes are not for it
  expect_refusal(small({"--json", "no/such/report.json"}), {"no/such"});
  EXPECT_TRUE(files().empty()) << files().front();
}

}  // namespace
}  // namespace supple::test
