#include <io/picture/image.hpp>
#include <io/table/csv.hpp>
#include <tests/app/supple_process.hpp>
#include <tests/support/long_run.hpp>
#include <tests/support/meshes.hpp>

#include <gmock/gmock.h>

#include <cstdio>
#include <map>
#include <sstream>

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

/// An object, as options of `supple reduce`.
struct Object {
  std::string name;
  Arguments options;
};

/// The same bar in many materials, sizes and places, and other kinds of objects.
class StressedObjects : public SuppleProcess {
 protected:
  /// A bar of 8 × 2 × 2 cubes of this edge [m], from this point on; region 2 is its far half.
  void write_bar(const std::string& name, double edge, double offset) const {
    const TetMesh mesh = kuhn_box(8, 2, 2, edge);
    std::ostringstream text;
    text.precision(17);
    text << "MeshVersionFormatted 2\nDimension 3\nVertices\n" << mesh.num_nodes() << "\n";
    for (Index i = 0; i < mesh.num_nodes(); ++i) text << mesh.nodes.row(i).array() + offset << " 0\n";
    text << "Tetrahedra\n" << mesh.num_cells() << "\n";
    for (const Tet& tet : mesh.cells) {
      for (const Index i : tet) text << i + 1 << " ";
      text << (mesh.nodes(tet[0], 0) < 3.5 * edge ? 1 : 2) << "\n";
    }
    text << "End\n";
    write(name, text.str());
  }

  std::vector<Object> objects() const {
    const Arguments unit{"unit.mesh", "--fix", "x<1e-3"};
    const auto with = [](Arguments options, const Arguments& more) {
      options.insert(options.end(), more.begin(), more.end());
      return options;
    };
    write_bar("unit.mesh", 0.125, 0);
    write_bar("small.mesh", 1.25e-7, 0);
    write_bar("large.mesh", 1.25e5, 0);
    write_bar("far.mesh", 0.125, 1e6);
    std::vector<Object> all;
    for (const std::string law :
         {"stvk", "neo-hookean", "stable-neo-hookean", "mooney-rivlin", "corotational", "ogden", "fung"})
      all.push_back({law, with(unit, {"--material", law})});
    all.push_back({"Poisson's ratio 0.4999", with(unit, {"--poisson", "0.4999"})});
    for (const std::string contrast : {"1e2", "1e4", "1e8"}) {
      const std::string file = "contrast" + contrast + ".json";
      write(file, R"({"young": 1, "regions": {"1": {"young": )" + contrast + "}}}");
      all.push_back({"stiffness 1 : " + contrast, with(unit, {"--materials", file})});
    }
    all.push_back({"1e-6 m long", {"small.mesh", "--fix", "x<1e-9"}});
    all.push_back({"1e6 m long", {"large.mesh", "--fix", "x<1e3"}});
    all.push_back({"1e6 m from the origin", {"far.mesh", "--fix", "x<1000000.001"}});
    all.push_back({"1e-3 kg/m³", with(unit, {"--density", "1e-3"})});
    all.push_back({"1e9 kg/m³", with(unit, {"--density", "1e9"})});
    all.push_back({"free", {"unit.mesh"}});
    all.push_back({"hexahedra", {"hexbox:8x2x2", "--fix", "x<=0"}});
    all.push_back({"plate", {"plate:12x6", "--fix", "x<0.1", "--thickness", "1%"}});
    all.push_back({"cylinder", {"cylinder:12x8", "--fix", "x<0.1", "--thickness", "1%"}});
    return all;
  }
};

// In a long run all motions and integrators, two steps, and the table of docs/stability.md on stdout.
TEST_F(StressedObjects, AreSoundByTheDefaultWhateverTheyAre) {
  const std::string by_default = "average-vector-field";
  const Arguments choice =
      is_long_run() ? Arguments{"--brief"}
                    : Arguments{"--motions", "crush,blow", "--integrators", by_default, "--steps-per-period", "30"};
  for (const Object& object : objects()) {
    Arguments reduce{"reduce"};
    reduce.insert(reduce.end(), object.options.begin(), object.options.end());
    reduce.insert(reduce.end(), {"-o", "object.supple", "--modes", "9", "--recipe", "subspace", "--poses", "60",
                                 "--points", "100", "--held-out", "0", "--full-loads", "0"});
    const Outcome made = supple(reduce);
    ASSERT_EQ(made.exit_code, 0) << object.name << ": " << made.err;
    Arguments stress{"stress", "object.supple", "--json", "-"};
    stress.insert(stress.end(), choice.begin(), choice.end());
    const Outcome outcome = supple(stress);
    ASSERT_EQ(outcome.exit_code, 0) << object.name << ": " << outcome.err;
    struct Count {
      int sound = 0, warned = 0, stopped = 0;
      double made = 0;
    };
    std::map<std::string, Count> counts;
    for (const json& run : outcome.json()["runs"]) {
      Count& count = counts[run["integrator"]];
      (run["verdict"] == "sound" ? count.sound : run["verdict"] == "warned" ? count.warned : count.stopped)++;
      count.made = std::max(count.made, run["energy_made"].get<double>());
      EXPECT_LE(run["reach"].get<double>(), 1e3) << object.name << ": " << run;
      if (run["integrator"] != by_default) continue;
      EXPECT_EQ(run["status"], "complete") << object.name << ": " << run;
      EXPECT_LE(run["energy_made"].get<double>(), 0.01) << object.name << ": " << run;
      EXPECT_LE(run["worst_residual"].get<double>(), 1e-3) << object.name << ": " << run;
    }
    if (!is_long_run()) continue;
    for (const auto& [integrator, count] : counts)
      std::printf("| %s | %s | %d | %d | %d | %.2g %% |\n", object.name.c_str(), integrator.c_str(), count.sound,
                  count.warned, count.stopped, 100 * count.made);
  }
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
