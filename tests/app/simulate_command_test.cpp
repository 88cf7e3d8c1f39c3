#include <io/picture/image.hpp>
#include <io/table/csv.hpp>
#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <cmath>

namespace supple::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

class SimulateCommandTest : public SuppleProcess {
 protected:
  void reduce_bar(Arguments more = {}) const {
    Arguments arguments{"reduce",  "bar:8x2x2", "-o",       "bar.supple", "--fix",      "x<=0", "--modes",  "6",
                        "--poses", "40",        "--points", "60",         "--held-out", "0",    "--recipe", "subspace"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void reduce_ball() const {
    const Outcome outcome = supple({"reduce", "ball:5", "-o", "ball.supple", "--modes", "9", "--poses", "20",
                                    "--points", "30", "--held-out", "0", "--recipe", "subspace"});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  CsvTable table(const std::string& name) const { return read_csv(folder / name); }
};

TEST_F(SimulateCommandTest, KeepsARowOfSeveralStepsInLongRuns) {
  const Outcome made = supple({"reduce", "bar:2x1x1", "-o", "bar.supple", "--fix", "x<=0", "--subspace", "modal",
                               "--modes", "2", "--selector", "all", "--recipe", "subspace", "--held-out", "0"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const json report = this->report({"simulate", "bar.supple", "-o", "run", "--step", "1e-4", "--time", "10.0001",
                                    "--frames", "none", "--every", "20000"});
  EXPECT_EQ(report["steps"], 100'001);  // one more than there is a row for each
  EXPECT_EQ(report["rows_every"], 2);
  EXPECT_EQ(report["frames"], 6);
  for (const char* name : {"run/energies.csv", "run/tracked.csv"}) {
    const Vector time = table(name).numbers("time");
    ASSERT_EQ(time.size(), 50'002) << name;
    for (Index k = 0; k < time.size(); ++k)
      ASSERT_NEAR(time[k], 1e-4 * static_cast<double>(std::min<Index>(2 * k, 100'001)), 1e-9) << name;
  }
  // sums and extremes count all steps
  const CsvTable energies = table("run/energies.csv");
  EXPECT_GE(report["most_iterations"], energies.numbers("iterations").maxCoeff());
  EXPECT_GE(report["worst_residual"], energies.numbers("residual").tail(50'001).maxCoeff());
  EXPECT_NEAR(report["mean_iterations"], energies.numbers("iterations").sum() / 50'001, 0.05);
}

TEST_F(SimulateCommandTest, WritesWhatItReports) {
  reduce_bar();
  const json report =
      this->report({"simulate", "bar.supple", "-o", "run", "--track", "7", "--track", "80", "--every", "4"});
  const Index steps = report["steps"];
  EXPECT_EQ(steps, 180);
  EXPECT_EQ(report["status"], "complete");
  EXPECT_EQ(report["system"], "reduced");
  EXPECT_EQ(report["unknowns"], 54);
  EXPECT_EQ(report["solver"], "bfgs");
  EXPECT_EQ(report["missed_steps"], 0);
  EXPECT_LE(report["worst_residual"], report["tolerance"]);
  EXPECT_GT(report["steps_per_second"], 0.0);
  EXPECT_NEAR(report["steps_per_second"].get<double>() * report["seconds"]["time steps"].get<double>(),
              static_cast<double>(steps), 1e-6);
  EXPECT_EQ(json::parse(read("run/report.json")), report);

  const CsvTable energies = table("run/energies.csv"), tracked = table("run/tracked.csv");
  ASSERT_EQ(energies.num_rows(), steps + 1);
  ASSERT_EQ(tracked.num_rows(), steps + 1);
  double mean = 0;
  for (const double count : energies.numbers("iterations")) mean += count / static_cast<double>(steps);
  EXPECT_NEAR(mean, report["mean_iterations"].get<double>(), 1e-9);
  double largest = 0;
  for (Index k = 0; k <= steps; ++k)
    largest = std::max(largest,
                       std::hypot(tracked.numbers("ux80")[k], tracked.numbers("uy80")[k], tracked.numbers("uz80")[k]));
  EXPECT_NEAR(largest, report["tracked"][1]["largest_displacement"].get<double>(), 1e-12);

  const std::string list = read("run/series.pvd");
  Index frames = 0;
  for (std::size_t at = 0; (at = list.find(".vtu", at)) != std::string::npos; ++at) ++frames;
  EXPECT_EQ(frames, report["frames"].get<Index>());
  EXPECT_EQ(frames, steps / 4 + 1);
  EXPECT_TRUE(std::filesystem::exists(folder / "run/series_000045.vtu"));
  EXPECT_GT(read_png(folder / "run/picture.png").width, 600);
  EXPECT_GT(read_png(folder / "run/energy.png").width, 300);
}

TEST_F(SimulateCommandTest, EstimatesItsError) {
  ASSERT_EQ(supple({"reduce", "bar:8x2x2", "-o", "bar.supple", "--fix", "x<=0", "--modes", "8"}).exit_code, 0);
  const Outcome quiet = supple({"simulate", "bar.supple", "--json", "-", "-o", "run", "--frames", "none"});
  ASSERT_EQ(quiet.exit_code, 0) << quiet.err;
  const json report = json::parse(quiet.out), error = report["indicated_error"];
  const Index estimates = error["estimates"];
  EXPECT_EQ(estimates, report["steps"].get<Index>() / 4);
  const CsvTable errors = table("run/errors.csv");
  ASSERT_EQ(errors.num_rows(), estimates);
  double squares = 0, sizes = 0, worst = 0, worst_time = 0, largest = 0;
  for (Index k = 0; k < estimates; ++k) {
    const double total = errors.numbers("total")[k], size = errors.numbers("displacement")[k];
    EXPECT_NEAR(total, std::hypot(errors.numbers("fit")[k], errors.numbers("outside")[k]), 1e-12 * total);
    squares += total * total;
    sizes += size * size;
    largest = std::max(largest, size);
    if (total > worst) worst = total, worst_time = errors.numbers("time")[k];
  }
  EXPECT_NEAR(error["relative"].get<double>(), std::sqrt(squares / sizes), 1e-9);
  EXPECT_NEAR(error["worst"].get<double>(), worst / largest, 1e-9);
  EXPECT_EQ(error["worst_time"].get<double>(), worst_time);
  EXPECT_GT(error["relative"].get<double>(), 1e-5);
  EXPECT_LT(error["relative"].get<double>(), 0.2);
  EXPECT_EQ(error["beyond_training"], 0);
  EXPECT_THAT(quiet.err, Not(HasSubstr("forces were fitted to")));

  // far beyond what was trained
  write("scene.json", R"({"duration": 1, "pulls": [{"acceleration": [0, 0, -9]}]})");
  const Outcome far = supple({"simulate", "bar.supple", "--scene", "scene.json", "--json", "-"});
  ASSERT_EQ(far.exit_code, 0) << far.err;
  EXPECT_GT(json::parse(far.out)["indicated_error"]["beyond_training"].get<Index>(), 0);
  EXPECT_THAT(far.err, HasSubstr("larger than what forces were fitted to"));

  reduce_bar();  // another recipe, which cannot tell
  const json silent = this->report({"simulate", "bar.supple", "-o", "silent", "--frames", "none"});
  EXPECT_FALSE(silent.contains("indicated_error"));
  EXPECT_FALSE(std::filesystem::exists(folder / "silent/errors.csv"));
}

TEST_F(SimulateCommandTest, TakesTheIntegratorOfTheSceneOrTheLine) {
  reduce_bar();
  const json plain = report({"simulate", "bar.supple", "--time", "0.3", "-o", "plain"});
  EXPECT_EQ(plain["integrator"], "average-vector-field");
  EXPECT_EQ(
      report({"simulate", "bar.supple", "--time", "0.3", "--integrator", "newmark", "-o", "average"})["integrator"],
      "newmark");
  EXPECT_NE(read("average/tracked.csv"), read("plain/tracked.csv"));
  // average acceleration by any of its names is the same motion to the last bit
  const json named =
      report({"simulate", "bar.supple", "--time", "0.3", "--integrator", "newmark:beta=0.25:gamma=0.5", "-o", "named"});
  EXPECT_EQ(named["integrator_options"]["beta"], "0.25");
  EXPECT_EQ(read("named/tracked.csv"), read("average/tracked.csv"));
  EXPECT_THAT(supple({"simulate", "bar.supple", "--time", "0.1", "--integrator", "newmark:beta=0.1"}).err,
              HasSubstr("2 beta < gamma"));
  // what is too fast for the step dies out
  const json damped = report(
      {"simulate", "bar.supple", "--time", "0.3", "--integrator", "generalized-alpha:rho_infinity=0", "-o", "damped"});
  EXPECT_EQ(damped["integrator"], "generalized-alpha");
  EXPECT_NE(read("damped/tracked.csv"), read("plain/tracked.csv"));
  write("scene.json", R"({"duration": 0.3, "step": 0.01, "gravity": [0, -1, 0],
                          "integrator": {"method": "generalized-alpha", "rho_infinity": 0.5}})");
  const json scene = report({"simulate", "bar.supple", "--scene", "scene.json"});
  EXPECT_EQ(scene["integrator"], "generalized-alpha");
  EXPECT_EQ(scene["integrator_options"]["rho_infinity"], "0.5");
  EXPECT_EQ(report({"simulate", "bar.supple", "--scene", "scene.json", "--full"})["integrator"], "generalized-alpha");
  EXPECT_EQ(report({"simulate", "bar.supple", "--scene", "scene.json", "--integrator", "newmark"})["integrator"],
            "newmark");
}

TEST_F(SimulateCommandTest, NamesIntegratorsAndForcesItDoesNotKnow) {
  reduce_bar();
  expect_refusal({"simulate", "bar.supple", "--integrator", "leapfrog"}, {"--integrator", "leapfrog", "newmark"});
  expect_refusal({"simulate", "bar.supple", "--integrator", "newmark:gamma=0.4"}, {"gamma", "at least 0.5"});
  expect_refusal({"simulate", "bar.supple", "--integrator", "newmark:rho=1"}, {"--integrator", "'rho'"});
  expect_refusal({"simulate", "bar.supple", "--integrator", "generalized-alpha:rho_infinity=7"}, {"0 to 1"});
  write("late.json", R"({"integrator": {"method": "generalized-alpha", "rho_infinity": 7}})");
  expect_refusal({"simulate", "bar.supple", "--scene", "late.json"}, {"late.json", "/integrator/method", "0 to 1"});
  const auto refused = [&](const char* scene, const std::vector<std::string>& parts) {
    write("scene.json", scene);
    expect_refusal({"simulate", "bar.supple", "--scene", "scene.json"}, parts);
  };
  refused(R"({"integrator": {"method": "leapfrog"}})", {"/integrator", "leapfrog", "newmark, generalized-alpha"});
  refused(R"({"integrator": {"method": "newmark", "rho_infinity": 0.5}})", {"rho_infinity"});
  refused(R"({"solver": {"beta": 0.3}})", {"/solver", "beta", "integrator"});
  refused(R"({"outside": [{"force": "ceiling"}]})", {"/outside/0", "ceiling", "floor"});
  refused(R"({"outside": [{"force": "floor", "axis": "w"}]})", {"/outside/0", "'w'", "x, y, z"});
  refused(R"({"outside": [{"force": "floor", "depth": 1}]})", {"depth"});
}

TEST_F(SimulateCommandTest, AFloorStopsWhatFalls) {
  reduce_ball();
  const auto lowest = [&](const char* scene, const char* output) {
    write("scene.json", scene);
    EXPECT_EQ(report({"simulate", "ball.supple", "--scene", "scene.json", "--track", "0", "-o", output})["status"],
              "complete");
    double least = 0;
    for (const double y : table(std::string(output) + "/tracked.csv").numbers("uy0")) least = std::min(least, y);
    return least;
  };
  const double free = lowest(R"({"duration": 0.6, "step": 0.005, "gravity": [0, -9.81, 0]})", "free");
  EXPECT_NEAR(free, -0.5 * 9.81 * 0.36, 0.02);
  const double stopped = lowest(R"({"duration": 0.6, "step": 0.005, "gravity": [0, -9.81, 0],
      "outside": [{"force": "floor", "axis": "y", "height": -1.2, "stiffness": 2e6}]})",
                                "stopped");
  EXPECT_GT(stopped, 0.8 * free);
}

TEST_F(SimulateCommandTest, KeepsRowsOfDenseBasesInSinglePrecisionUnlessTold) {
  reduce_bar();
  EXPECT_EQ(report({"simulate", "bar.supple", "-o", "run"})["precision"], "double");
  EXPECT_EQ(report({"simulate", "bar.supple", "--precision", "single", "-o", "run"})["precision"], "single");
  EXPECT_FALSE(report({"simulate", "bar.supple", "--full", "--time", "0.01", "-o", "run"}).contains("precision"));
  reduce_bar({"--subspace", "modal"});
  double reach[2];
  for (const bool is_double : {false, true}) {
    Arguments arguments{"simulate", "bar.supple", "--tolerance", "1e-10", "--track", "80", "-o", "run"};
    if (is_double) arguments.insert(arguments.end(), {"--precision", "double"});
    const json report = this->report(arguments);
    EXPECT_EQ(report["precision"], is_double ? "double" : "single");
    EXPECT_EQ(report["missed_steps"], 0);
    reach[is_double] = report["tracked"][0]["largest_displacement"];
  }
  EXPECT_NE(reach[0], reach[1]);
  EXPECT_NEAR(reach[0], reach[1], 1e-5 * reach[1]);
}

TEST_F(SimulateCommandTest, ConservesEnergyAsLoadsGiveIt) {
  reduce_bar();
  for (const Arguments& how : {Arguments{}, Arguments{"--full"}}) {
    Arguments arguments{"simulate", "bar.supple", "-o", "run", "--frames", "none"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    (void)report(arguments);
    const CsvTable energies = table("run/energies.csv");
    const Vector total = energies.numbers("kinetic") + energies.numbers("elastic"), work = energies.numbers("work");
    // exactly for this material, but for the tolerance of steps
    EXPECT_LT((total - work).cwiseAbs().maxCoeff(), 1e-4 * work.maxCoeff());
    EXPECT_GT(work.maxCoeff(), 0);
    EXPECT_FALSE(std::filesystem::exists(folder / "run/series.pvd"));
  }
}

/// A free body under gravity: Newmark's average acceleration is exact for constant accelerations.
TEST_F(SimulateCommandTest, LetsFreeObjectsFall) {
  reduce_ball();
  write("fall.json", R"({"duration": 0.5, "step": "10 ms", "gravity": [0, -9.81, 0], "output": {"track": [3]}})");
  for (const Arguments& how : {Arguments{}, Arguments{"--full"}}) {
    Arguments arguments{"simulate", "ball.supple", "--scene", "fall.json", "-o", "run"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    (void)report(arguments);
    const CsvTable tracked = table("run/tracked.csv");
    const Vector t = tracked.numbers("time"), y = tracked.numbers("uy3");
    ASSERT_EQ(t.size(), 51);
    EXPECT_LT((y + 0.5 * 9.81 * t.cwiseAbs2()).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_LT(tracked.numbers("ux3").cwiseAbs().maxCoeff(), 1e-5);
  }
}

/// A pull that ends between two steps: each sees the load amid it, so the push is a · until, exactly.
TEST_F(SimulateCommandTest, EndsLoadsInTime) {
  reduce_ball();
  const double a = 2, h = 0.01, until = 0.1;
  write("push.json",
        R"({"duration": 0.4, "step": 0.01, "pulls": [{"acceleration": [2, 0, 0], "until": "100 ms"}],
                         "output": {"track": [3]}})");
  (void)report({"simulate", "ball.supple", "--scene", "push.json", "-o", "run"});
  const CsvTable tracked = table("run/tracked.csv");
  const Vector x = tracked.numbers("ux3");
  for (Index k = 30; k < 40; ++k) EXPECT_NEAR((x[k + 1] - x[k]) / h, a * until, 1e-6);
}

/// The same force as a resultant over a side, and as a force on its nodes; a ramp starts from nothing.
TEST_F(SimulateCommandTest, AcceptsEachWayToNameThings) {
  reduce_bar();
  const auto displacement = [&](const std::string& scene) -> Vector {
    write("scene.json", scene);
    (void)report({"simulate", "bar.supple", "--scene", "scene.json", "-o", "run", "--frames", "none", "--track", "80"});
    return table("run/tracked.csv").numbers("uy80");
  };
  const std::string start = R"({"duration": 0.2, "step": 0.01, )";
  const Vector by_node = displacement(start + R"("forces": [{"node": 80, "force": [0, 1, 0]}]})");
  const Vector by_point =
      displacement(start + R"("forces": [{"at": [1.2, 0.3, 0.3], "force": ["0 N", "1000 mN", 0]}]})");
  EXPECT_EQ(by_node, by_point);
  EXPECT_GT(by_node.maxCoeff(), 1e-6);
  const Vector by_rule = displacement(start + R"("forces": [{"nodes": "x>=1", "force": [0, 1, 0]}]})");
  EXPECT_NEAR(by_rule.maxCoeff() / by_node.maxCoeff(), 1, 0.3);
  const Vector ramped = displacement(start + R"("forces": [{"node": 80, "force": [0, 1, 0], "ramp": 0.2}]})");
  EXPECT_LT(ramped[1], 0.1 * by_node[1]);
  EXPECT_GT(ramped[1], 0);

  // node 80 is the corner (1, 0.25, 0.25) at rest
  const Vector to_target =
      displacement(start + R"("springs": [{"node": 80, "stiffness": 50, "target": [1, 0.35, 0.25]}]})");
  const Vector by_displacement =
      displacement(start + R"("springs": [{"node": 80, "stiffness": "0.05 N/mm", "displacement": [0, 0.1, 0]}]})");
  const Vector along_path = displacement(
      start + R"("springs": [{"node": 80, "stiffness": 50, "path": [{"time": 0, "displacement": [0, 0.1, 0]},
                                                                   {"time": 1, "displacement": [0, 0.1, 0]}]}]})");
  EXPECT_LT((to_target - by_displacement).cwiseAbs().maxCoeff(), 1e-7 * to_target.cwiseAbs().maxCoeff());
  EXPECT_LT((along_path - by_displacement).cwiseAbs().maxCoeff(), 1e-7 * to_target.cwiseAbs().maxCoeff());
}

TEST_F(SimulateCommandTest, SaysWhatActsOnNodesThatAreHeld) {
  reduce_bar();
  const auto warning = [&](const std::string& scene) {
    write("scene.json", scene);
    const Outcome outcome = supple({"simulate", "bar.supple", "--scene", "scene.json"});
    EXPECT_EQ(outcome.exit_code, 0);
    return outcome.err;
  };
  const std::string start = R"({"duration": 0.1, "step": 0.05, )";
  EXPECT_THAT(warning(start + R"("forces": [{"nodes": "x<=0", "force": [0, 0, 100]}]})"),
              HasSubstr("/forces/0: 100 % of this force acts on nodes that the model holds"));
  EXPECT_THAT(warning(start + R"("springs": [{"node": 0, "stiffness": 1}]})"), HasSubstr("100 % of this spring"));
  // a half and a whole layer of mass
  EXPECT_THAT(warning(start + R"("forces": [{"nodes": "x<20%", "force": [0, 0, 1]}]})"),
              HasSubstr("33.3 % of this force"));
  EXPECT_EQ(warning(start + R"("forces": [{"nodes": "x>0", "force": [0, 0, 1]}]})"), "");
}

TEST_F(SimulateCommandTest, TakesOneStepWhereTheDefaultStepIsLongerThanTheScene) {
  reduce_bar();
  write("short.json", R"({"duration": 1e-5})");
  EXPECT_EQ(report({"simulate", "bar.supple", "--scene", "short.json"})["steps"], 1);
}

/// A stiff spring wins: the node ends where the spring pulls it, reduced and full.
TEST_F(SimulateCommandTest, SpringsPullNodesToTheirTargets) {
  reduce_bar({"--damping-alpha", "20"});
  write("hold.json", R"({"duration": 2, "step": 0.02, "output": {"track": [80]},
                         "springs": [{"nodes": "x>=1", "stiffness": 1e6, "displacement": [0, 0.05, 0], "ramp": 0.5}]})");
  for (const Arguments& how : {Arguments{}, Arguments{"--full"}, Arguments{"--solver", "newton"}}) {
    Arguments arguments{"simulate", "bar.supple", "--scene", "hold.json", "-o", "run", "--frames", "none"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    EXPECT_EQ(report(arguments)["missed_steps"], 0);
    const Vector y = table("run/tracked.csv").numbers("uy80");
    EXPECT_NEAR(y[y.size() - 1], 0.05, 1e-3);
  }
}

TEST_F(SimulateCommandTest, ComparesTrajectories) {
  reduce_bar();
  (void)report({"simulate", "bar.supple", "-o", "run", "--every", "2"});
  (void)report({"simulate", "bar.supple", "--full", "-o", "full", "--every", "1", "--time", "0.5"});
  const json same = report({"compare", "run", "run/trajectory.safetensors"});
  EXPECT_EQ(same["position_error"]["relative"], 0.0);
  EXPECT_EQ(same["velocity_error"]["largest"], 0.0);
  EXPECT_EQ(same["energy_error"]["relative"], 0.0);

  const json report = this->report({"compare", "run", "full", "-o", "comparison"});
  EXPECT_GT(report["position_error"]["relative"], 0.0);
  EXPECT_LT(report["position_error"]["relative"], 0.15);
  EXPECT_LE(report["position_error"]["relative"], report["position_error"]["largest"].get<double>() * 3);
  EXPECT_GT(report["speed_up"], 0.0);
  EXPECT_NEAR(report["until"].get<double>(), 0.5, 0.02);
  const CsvTable errors = table("comparison/errors.csv");
  EXPECT_EQ(errors.num_rows(), report["frames"].get<Index>());
  EXPECT_NEAR(errors.numbers("position_error").maxCoeff(), report["position_error"]["largest"].get<double>(), 1e-12);
  EXPECT_NEAR(errors.numbers("largest_distance").maxCoeff(), report["largest_distance"]["metres"].get<double>(), 1e-12);
  EXPECT_GT(read_png(folder / "comparison/errors.png").width, 300);
  EXPECT_GT(read_png(folder / "comparison/comparison.png").width, 600);

  (void)this->report({"simulate", "bar.supple", "-o", "other", "--step", "0.011"});
  expect_refusal({"compare", "other", "full"}, {"no frame"});
  reduce_bar({"--seed", "2"});
  expect_refusal({"compare", "run", "full"}, {"changed"});
  std::filesystem::remove(folder / "bar.supple");
  expect_refusal({"compare", "run", "full"}, {"gone"});
}

TEST_F(SimulateCommandTest, RefusesBadScenesInOneLineAndLeavesNothing) {
  reduce_bar();
  const auto refuse = [&](const std::string& scene, const std::vector<std::string>& parts) {
    write("scene.json", scene);
    expect_refusal({"simulate", "bar.supple", "--scene", "scene.json", "-o", "run"}, parts);
    EXPECT_FALSE(std::filesystem::exists(folder / "run")) << scene;
  };
  refuse(R"({"gravty": [0, 0, 0]})", {"scene.json", "gravty", "gravity"});
  refuse(R"({"gravity": [0, 0]})", {"/gravity", "3"});
  refuse(R"({"step": "5 kg"})", {"/step", "kg"});
  refuse(R"({"duration": -1})", {"/duration"});
  refuse(R"({"forces": [{"force": [0, 0, 1]}]})", {"/forces/0", "node"});
  refuse(R"({"forces": [{"node": 1, "at": [0, 0, 0], "force": [0, 0, 1]}]})", {"/forces/0", "one of"});
  refuse(R"({"forces": [{"node": 81, "force": [0, 0, 1]}]})", {"/forces/0/node", "81", "80"});
  refuse(R"({"forces": [{"nodes": "x>9", "force": [0, 0, 1]}]})", {"/forces/0/nodes", "x>9"});
  refuse(R"({"forces": [{"node": 1, "force": [0, 0, 1], "from": 2, "until": 1}]})", {"/forces/0/until"});
  refuse(R"({"forces": [{"nodes": [1, 2, 3], "force": [0, 0, 1]}]})", {"/forces/0/nodes", "list of 3", "text"});
  refuse(R"({"forces": [{"at": [1000, 0, 0], "force": [0, 0, 1]}]})", {"/forces/0/at", "999 m", "metres"});
  refuse(R"({"springs": [{"at": [0, 60, 0], "stiffness": 1}]})", {"/springs/0/at", "metres"});
  refuse(R"({"duration": 0.01, "step": 0.1})", {"step is 0.1 s", "duration of 0.01 s"});
  refuse(R"({"springs": [{"node": 1, "stiffness": 0}]})", {"/springs/0/stiffness"});
  refuse(R"({"springs": [{"node": 1, "stiffness": 1, "target": [0, 0, 0], "displacement": [0, 0, 0]}]})",
         {"/springs/0"});
  refuse(R"({"springs": [{"nodes": "x>50%", "stiffness": 1, "target": [0, 0, 0]}]})", {"/springs/0/target"});
  refuse(R"({"springs": [{"node": 1, "stiffness": 1, "path": [{"time": 1, "displacement": [0, 0, 0]},
                                                          {"time": 1, "displacement": [0, 0, 0]}]}]})",
         {"/springs/0/path/1/time"});
  refuse(R"({"solver": {"method": "magic"}})", {"/solver/method", "magic"});
  refuse(R"({"output": {"track": [99]}})", {"/output/track", "99"});
  refuse(R"({"duration": 1)", {"scene.json"});
  refuse("", {"scene.json"});
  expect_refusal({"simulate", "bar.supple", "--scene", "none.json", "-o", "run"}, {"none.json"});
  expect_refusal({"simulate", "bar.supple", "--step", "0", "-o", "run"}, {"step"});
  expect_refusal({"simulate", "bar.supple", "--time", "1e12", "-o", "run"}, {"steps"});
  expect_refusal({"simulate", "bar.supple", "--track", "-1", "-o", "run"}, {"track"});
  expect_refusal({"simulate", "bar.supple", "--every", "0", "-o", "run"}, {"every"});
  expect_refusal({"simulate", "bar.supple", "--full", "--solver", "broyden", "-o", "run"}, {"newton"});
  expect_refusal({"simulate", "bar.supple", "--solver", "warped-bfgs", "-o", "run"}, {"--full", "broyden"});
  expect_refusal({"simulate", "bar.supple", "--precision", "half", "-o", "run"}, {"--precision", "single"});
  expect_refusal({"simulate", "bar.supple", "--full", "--precision", "single", "-o", "run"}, {"--precision"});
  expect_refusal({"simulate", "bar.supple", "-o", "bar.supple"}, {"bar.supple"});
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

TEST_F(SimulateCommandTest, StopsWithAnErrorWhenTheMotionIsNotFinite) {
  reduce_bar();
  write("burst.json",
        R"({"duration": 1, "step": 0.05, "forces": [{"node": 80, "force": [1e250, 0, 0], "from": 0.46}]})");
  expect_refusal({"simulate", "bar.supple", "--scene", "burst.json", "-o", "run", "--json", "report.json"},
                 {"step 10", "finite"}, 1);
  const json report = json::parse(read("report.json"));
  EXPECT_EQ(report["status"], "not-finite");
  EXPECT_NEAR(report["duration"].get<double>(), 0.45, 1e-9);
  EXPECT_EQ(table("run/energies.csv").num_rows(), 11);  // the last row says why it ended
  EXPECT_EQ(table("run/energies.csv").texts("status").back(), "not-finite");
}

TEST_F(SimulateCommandTest, KeepsItsReportsWhenTheFirstStepIsNotFinite) {
  reduce_bar();
  write("burst.json", R"({"duration": 1, "step": 0.05, "forces": [{"node": 80, "force": [1e250, 0, 0]}]})");
  const Outcome outcome =
      supple({"simulate", "bar.supple", "--scene", "burst.json", "-o", "run", "--json", "report.json"});
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.err, testing::AllOf(HasSubstr("step 1 "), HasSubstr("finite")));
  EXPECT_EQ(json::parse(read("report.json"))["status"], "not-finite");
  EXPECT_EQ(read("run/report.json"), read("report.json"));
}

TEST_F(SimulateCommandTest, ComparesWithAReferenceAtRest) {
  reduce_bar();
  write("rest.json", R"({"duration": 0.5, "step": 0.05})");
  write("load.json", R"({"duration": 0.5, "step": 0.05, "gravity": [0, -0.1, 0]})");
  ASSERT_EQ(supple({"simulate", "bar.supple", "--scene", "rest.json", "-o", "rest"}).exit_code, 0);
  ASSERT_EQ(supple({"simulate", "bar.supple", "--scene", "load.json", "-o", "load"}).exit_code, 0);
  const Outcome outcome = supple({"compare", "load", "rest", "-o", "comparison", "--json", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("does not move"));
  EXPECT_TRUE(outcome.json()["position_error"]["relative"].is_null());  // nothing to relate it to
  EXPECT_EQ(report({"compare", "rest", "rest"})["position_error"]["relative"], 0.0);
}

// A soft bar whose own weight bends it by several times its length at once, with the step of a sixtieth of its period:
// average acceleration ends such motions with thirty times the work of gravity.
TEST_F(SimulateCommandTest, MakesNoEnergyWhateverFalls) {
  write("fall.json", R"({"gravity": [0, 0, -9.81], "step": "53 ms", "duration": 9.5, "damping": {}})");
  const auto expect_kept = [&](const std::string& what) {
    for (const Arguments& how : {Arguments{}, Arguments{"--full"}}) {
      SCOPED_TRACE(what + (how.empty() ? "" : ", full"));
      Arguments arguments{"simulate", "model.supple", "--scene", "fall.json"};
      arguments.insert(arguments.end(), how.begin(), how.end());
      const json kept = report(arguments);
      EXPECT_EQ(kept["status"], "complete");
      EXPECT_LE(kept["energy"]["most_made"].get<double>(), 0.01);
      EXPECT_LE(kept["energy"]["most_taken"].get<double>(), 0.01);
      EXPECT_GT(kept["energy"]["work"].get<double>(), 0.0);
    }
  };
  for (const char* law : {"stvk", "neo-hookean", "stable-neo-hookean", "corotational"}) {
    ASSERT_EQ(supple({"reduce", "bar:6x2x2", "-o", "model.supple", "--fix", "x<=0", "--modes", "6", "--poses", "40",
                      "--held-out", "0", "--recipe", "subspace", "--young", "5e4", "--material", law})
                  .exit_code,
              0);
    expect_kept(law);
  }
  ASSERT_EQ(supple({"reduce", "cylinder:12x6", "-o", "model.supple", "--fix", "x<=0", "--modes", "6", "--poses", "40",
                    "--held-out", "0", "--recipe", "subspace", "--young", "5e4"})
                .exit_code,
            0);
  expect_kept("a shell");
}

TEST_F(SimulateCommandTest, AccountsForEnergyAndEndsWhatMakesIt) {
  reduce_bar({"--young", "5e4"});
  write("fall.json", R"({"gravity": [0, 0, -9.81], "step": "53 ms", "duration": 30, "damping": {},
                         "integrator": {"method": "newmark"}, "solver": {"max_halvings": 0}})");
  expect_refusal({"simulate", "bar.supple", "--scene", "fall.json", "-o", "run", "--json", "report.json"},
                 {"energy from nothing", "newmark", "average-vector-field"}, 1);
  const json report = json::parse(read("report.json"));
  EXPECT_EQ(report["status"], "energy-from-nothing");
  const CsvTable energies = table("run/energies.csv");
  EXPECT_EQ(energies.texts("status").back(), "energy-from-nothing");
  const Vector balance = energies.numbers("kinetic") + energies.numbers("elastic") - energies.numbers("work") +
                         energies.numbers("damped") - energies.numbers("made");
  EXPECT_LE(balance.cwiseAbs().maxCoeff(), 1e-9 * energies.numbers("work").cwiseAbs().maxCoeff());
  // nothing that was kept has twice what gravity can have given
  EXPECT_LE((energies.numbers("made")).maxCoeff(), energies.numbers("work").maxCoeff());

  // halved steps make less, and say how many they were
  const Outcome halved =
      supple({"simulate", "bar.supple", "--scene", "fall.json", "--time", "10", "--halvings", "8", "--json", "-"});
  EXPECT_GT(halved.json()["halved_steps"], 0);
  EXPECT_LT(halved.json()["energy"]["most_made"].get<double>(), 1);

  // damping is accounted for, too
  write("damped.json", R"({"gravity": [0, 0, -1], "duration": 3, "damping": {"alpha": 2, "beta": 0.01}})");
  const json damped = this->report({"simulate", "bar.supple", "--scene", "damped.json"});
  const json& energy = damped["energy"];
  EXPECT_GT(energy["damped"].get<double>(), 0.1 * energy["work"].get<double>());
  EXPECT_NEAR(energy["kinetic"].get<double>() + energy["elastic"].get<double>() + energy["damped"].get<double>(),
              energy["work"].get<double>(), 1e-3 * energy["work"].get<double>());
}

// Three periods in sixtieths of the softest one would be 9 s in steps of 53 ms; gravity crosses the bar in half a second.
TEST_F(SimulateCommandTest, TheStepFollowsTheLoads) {
  reduce_bar({"--young", "5e4"});
  const auto step = [&](const char* scene) {
    write("scene.json", scene);
    return report({"simulate", "bar.supple", "--scene", "scene.json", "--time", "0.1"})["step"].get<double>();
  };
  const double calm = step("{}"), weak = step(R"({"gravity": [0, 0, -1e-3]})"),
               strong = step(R"({"gravity": [0, 0, -90]})");
  EXPECT_EQ(weak, calm);
  const double diagonal = std::sqrt(1 + 2 * 0.25 * 0.25);
  EXPECT_NEAR(strong, std::sqrt(2 * diagonal / 90) / 60, 1e-9);
  EXPECT_NEAR(step(R"({"forces": [{"nodes": "x>50%", "force": [0, 0, 5625]}]})"), strong, 1e-9) << "of 62.5 kg";
}

TEST_F(SimulateCommandTest, WarnsOfStepsThatMissTheTolerance) {
  reduce_bar();
  write("scene.json", R"({"gravity": [0, -1, 0], "solver": {"max_iterations": 1, "tolerance": 1e-9}})");
  const Outcome outcome = supple({"simulate", "bar.supple", "--scene", "scene.json", "--json", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("missed the tolerance"));
  EXPECT_GT(outcome.json()["missed_steps"], 0);
}

}  // namespace

}  // namespace supple::test
