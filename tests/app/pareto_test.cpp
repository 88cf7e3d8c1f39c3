#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>
#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace supple::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

struct ParetoTest : SuppleProcess {
  /// Few poses and loads: seconds for the lot.
  static Arguments small(const Arguments& more = {}) {
    Arguments arguments{"pareto",     "bar:6x2x2", "--fix",        "x<=0", "--poses",      "20",
                        "--held-out", "0",         "--equilibria", "6",    "--full-loads", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  static constexpr const char* two =
      "derivatives:modes=4:dimension=12:points=20,extended:modes=3:points=30,extended:modes=3:points=40";
};

TEST_F(ParetoTest, MeasuresEveryModelAndLeavesTablesPlotAndPage) {
  const Outcome outcome = supple(small({"--models", two, "-o", "out", "--json", "report.json"}));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("| derivatives:modes=4:dimension=12:points=20 | 12 | "));
  const json report = json::parse(read("report.json"));
  EXPECT_EQ(json::parse(read("out/pareto.json")), report);
  EXPECT_EQ(report["front_of"], "full_error");
  EXPECT_EQ(report["scene"]["source"], "pluck");
  EXPECT_EQ(report["scene"]["steps"], 180);
  EXPECT_GE(report["machine"]["threads"], 1);
  EXPECT_TRUE(report["full_step_seconds"].is_null());
  EXPECT_FALSE(report["options"].contains("modes"));
  ASSERT_EQ(report["points"].size(), 3u);
  for (const json& point : report["points"]) {
    EXPECT_GT(point["step_seconds"], 0.0);
    EXPECT_EQ(point["missed_steps"], 0);
    EXPECT_EQ(point["status"], "complete");
    const json& error = point["full_error"];
    EXPECT_EQ(error["loads"], 2);
    EXPECT_NEAR(std::hypot(error["outside_subspace"].get<double>(), error["inside_subspace"].get<double>()),
                error["total"].get<double>(), 1e-12);
    EXPECT_TRUE(point["trajectory_error"].is_null());
    const bool dominated = std::ranges::any_of(report["points"], [&](const json& other) {
      return other["step_seconds"] < point["step_seconds"] && other["full_error"]["total"] < error["total"];
    });
    EXPECT_EQ(point["front"], !dominated);
  }
  EXPECT_EQ(report["points"][1]["dimension"], 27);
  EXPECT_LE(report["points"][1]["points"], 30);

  const CsvTable table = read_csv(folder / "out" / "pareto.csv");
  ASSERT_EQ(table.num_rows(), 3);
  EXPECT_EQ(table.texts("model")[2], "extended:modes=3:points=40");
  for (Index k = 0; k < 3; ++k) {
    EXPECT_EQ(table.numbers("step")[k], report["points"][k]["step_seconds"].get<double>());
    EXPECT_EQ(table.numbers("front")[k], report["points"][k]["front"].get<bool>() ? 1 : 0);
  }
  EXPECT_THAT(read("out/pareto.md"), HasSubstr("| extended:modes=3:points=30 | 27 | "));
  const std::string page = read("out/pareto.html");
  EXPECT_THAT(page, HasSubstr("<td>extended:modes=3:points=30</td>"));
  EXPECT_THAT(page, HasSubstr("</html>"));
  for (const char* link : {"http", "href", "src=\"p"}) EXPECT_THAT(page, Not(HasSubstr(link)));
  if (can_plot()) {
    EXPECT_THAT(read("out/pareto.png"), HasSubstr("PNG"));
    EXPECT_THAT(page, HasSubstr("src=\"data:image/png;base64,iVBORw0KGgo"));  // a PNG's first bytes
  }
}

TEST_F(ParetoTest, SweepsTheLadderByDefaultAndAgreesWithReduce) {
  const json report = this->report(small());
  ASSERT_EQ(report["points"].size(), 2u);  // what 162 unknowns have room for
  const json& first = report["points"][0];
  EXPECT_EQ(first["model"], "derivatives:num_derivatives=20:modes=10:points=40");
  EXPECT_EQ(first["dimension"], 30);
  Arguments alone =
      small({"--subspace", "derivatives:num_derivatives=20", "--modes", "10", "--points", "40", "-o", "bar.supple"});
  alone[0] = "reduce";
  const json model = this->report(alone);
  EXPECT_EQ(model["full_error"], first["full_error"]);
  EXPECT_EQ(model["points"], first["points"]);
}

TEST_F(ParetoTest, ComparesMotionsAsCompareDoes) {
  const char* model = "derivatives:modes=4:dimension=12:points=20";
  const json report = this->report(
      small({"--models", model, "--trajectory", "--tolerances", "1e-3,1e-7", "--time", "0.5", "--step", "0.05"}));
  EXPECT_EQ(report["front_of"], "trajectory_error");
  EXPECT_EQ(report["scene"]["steps"], 10);
  EXPECT_GT(report["full_step_seconds"], 0.0);
  ASSERT_EQ(report["points"].size(), 2u);  // one for each tolerance
  EXPECT_EQ(report["points"][0]["tolerance"], 1e-3);
  EXPECT_EQ(report["points"][0]["full_error"], report["points"][1]["full_error"]);
  EXPECT_LE(report["points"][0]["mean_iterations"], report["points"][1]["mean_iterations"]);

  Arguments alone =
      small({"--subspace", "derivatives", "--modes", "4", "--dimension", "12", "--points", "20", "-o", "bar.supple"});
  alone[0] = "reduce";
  this->report(alone);
  for (const Arguments& run : {Arguments{"-o", "reduced"}, Arguments{"-o", "full", "--full"}}) {
    Arguments simulate{"simulate", "bar.supple", "--time", "0.5", "--step", "0.05", "--tolerance", "1e-7"};
    simulate.insert(simulate.end(), run.begin(), run.end());
    ASSERT_EQ(supple(simulate).exit_code, 0);
  }
  const double error = this->report({"compare", "reduced", "full"})["position_error"]["relative"];
  // the full motion is kept in single precision there, and was asked for another tolerance
  EXPECT_NEAR(report["points"][1]["trajectory_error"].get<double>(), error, 1e-3 * error + 1e-6);
}

TEST_F(ParetoTest, TakesASceneAndShells) {
  write("push.json", R"({"description": "push", "duration": 0.02, "step": 0.002, "gravity": [0, 0, 1]})");
  Arguments arguments = small({"--models", "extended:modes=3:points=30", "--scene", "push.json"});
  arguments[1] = "plate:8x4";
  arguments[3] = "x<20%";
  const json report = this->report(arguments);
  EXPECT_EQ(report["scene"]["description"], "push");
  EXPECT_EQ(report["scene"]["steps"], 10);
  EXPECT_THAT(report["description"].get<std::string>(), HasSubstr("flaps"));
}

TEST_F(ParetoTest, WorksWithoutGnuplot) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", folder.c_str(), 1);
  const Outcome outcome = supple(small({"--models", "extended:modes=3:points=30", "-o", "out"}));
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("gnuplot"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out" / "pareto.png"));
  EXPECT_THAT(read("out/pareto.html"), HasSubstr("<table>"));
}

TEST_F(ParetoTest, RefusesWhatItCannotRun) {
  expect_refusal(small({"--models", "teapot"}), {"--models", "teapot"});
  expect_refusal(small({"--models", "extended:points=0"}), {"--models", "points", "whole number"});
  expect_refusal(small({"--models", "extended:points=1000"}), {"--models", "points=1000", "tets, 144"});
  expect_refusal(small({"--models", "extended,extended:teapot=1"}), {"teapot"});
  expect_refusal(small({"--tolerances", "1e-3,1e-6"}), {"--tolerances", "--trajectory"});
  expect_refusal(small({"--tolerances", "0"}), {"--tolerances"});
  expect_refusal(small({"--scene", "no.json"}), {"no.json"});
  expect_refusal(small({"--full-loads", "0"}), {"--full-loads"});
  expect_refusal(small({"--time", "soon"}), {"--time"});
  expect_refusal(small({"--time", "0"}), {"--time", "> 0"});
  expect_refusal(small({"--modes", "4"}), {"'--modes'", "--models"});
  expect_refusal(small({"--snapshots", "bar.npy"}), {"--snapshots", "--models"});
  expect_refusal(small({"--json", "no/such/report.json"}), {"no/such"});
  EXPECT_TRUE(files().empty()) << files().front();
}

}  // namespace
}  // namespace supple::test
