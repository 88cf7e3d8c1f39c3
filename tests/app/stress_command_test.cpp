#include <io/picture/image.hpp>
#include <io/table/csv.hpp>
#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

namespace supple::test {
namespace {

using nlohmann::json;

class StressCommandTest : public SuppleProcess {
 protected:
  void SetUp() override {
    SuppleProcess::SetUp();
    const Outcome outcome =
        supple({"reduce", "bar:8x2x2", "-o", "bar.supple", "--fix", "x<=0", "--modes", "6", "--poses", "40", "--points",
                "80", "--held-out", "0", "--recipe", "subspace", "--full-loads", "0"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
};

TEST_F(StressCommandTest, TheDefaultStaysSaneWhateverIsDone) {
  const json report =
      this->report({"stress", "bar.supple", "--brief", "--integrators", "average-vector-field", "-o", "stress"});
  EXPECT_EQ(report["runs"].size(), 8 * 2);
  EXPECT_EQ(report["stopped"], 0);
  for (const json& run : report["runs"]) {
    EXPECT_LE(run["energy_made"].get<double>(), 0.01) << run;
    EXPECT_LE(run["energy_taken"].get<double>(), 0.01) << run;
    EXPECT_EQ(run["steps_done"], run["steps_asked"]) << run;
    EXPECT_GT(run["reach"].get<double>(), 0.05) << run;
  }
  const CsvTable table = read_csv(folder / "stress/stress.csv");
  EXPECT_EQ(table.num_rows(), 8 * 2);
  EXPECT_EQ(table.texts("verdict").front(), report["runs"][0]["verdict"].get<std::string>());
  EXPECT_EQ(json::parse(read("stress/stress.json")), report);
  EXPECT_THAT(read("stress/stress.md"), testing::HasSubstr("| pull-10 | average-vector-field |"));
  EXPECT_GT(read_png(folder / "stress/stress.png").width, 300);
}

TEST_F(StressCommandTest, CountsAddUpAndChoicesAreKept) {
  const json report = this->report({"stress", "bar.supple", "--motions", "pull-10,blow", "--integrators",
                                    "newmark,generalized-alpha:rho_infinity=0.5", "--steps-per-period", "20"});
  ASSERT_EQ(report["runs"].size(), 4);
  EXPECT_EQ(report["sound"].get<int>() + report["warned"].get<int>() + report["stopped"].get<int>(), 4);
  EXPECT_EQ(report["runs"][0]["motion"], "pull-10");
  EXPECT_EQ(report["runs"][1]["integrator"], "generalized-alpha:rho_infinity=0.5");
  EXPECT_EQ(report["runs"][3]["motion"], "blow");
}

TEST_F(StressCommandTest, RefusesWhatItDoesNotKnow) {
  expect_refusal({"stress", "bar.supple", "--motions", "shake"}, {"--motions", "shake"});
  expect_refusal({"stress", "bar.supple", "--integrators", "leapfrog"}, {"leapfrog", "average-vector-field"});
  expect_refusal({"stress", "bar.supple", "--steps-per-period", "0"}, {"--steps-per-period"});
  expect_refusal({"stress", "bar.supple", "--integrators", "newmark:gamma=0.4"}, {"gamma", "0.5"});
  expect_refusal({"stress", "none.supple"}, {"none.supple"});
}

}  // namespace
}  // namespace supple::test
