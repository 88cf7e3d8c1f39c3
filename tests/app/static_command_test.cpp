#include <io/table/csv.hpp>
#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <vector>

namespace supple::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

/// On three planes of symmetry, pulled at the far end.
class StaticCommandTest : public SuppleProcess {
 protected:
  static constexpr double traction = 2e4, young = 1e5;

  StaticCommandTest() {
    write("pull.json", R"({"description": "pulled", "surface": [{"nodes": "x>=100%", "traction": ["20 kPa", 0, 0]}]})");
    write("press.json", R"({"surface": [{"nodes": "x>=100%", "pressure": 100}], "gravity": [0, -0.5, 0]})");
  }
  Arguments bar(const std::string& mesh, Arguments more) const {
    Arguments arguments{"static", mesh, "--fix", "x=0:x", "--fix", "y=0:y", "--fix", "z=0:z", "--poisson", "0.3"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// a (a² − 1) / 2 = t / Y
  static double stretch() {
    double a = 1;
    for (int k = 0; k < 50; ++k) a -= (a * (a * a - 1) / 2 - traction / young) / ((3 * a * a - 1) / 2);
    return a;
  }
  static Eigen::Vector3d vector(const json& numbers) {
    return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
  }
};

TEST_F(StaticCommandTest, StretchesABarAsTheClosedFormSays) {
  for (const std::string mesh : {"bar:4x1x1", "hexbox:4x1x1", "tet10:bar:2x1x1"}) {
    const json report = this->report(bar(mesh, {"--scene", "pull.json", "--cut", "x=50%", "-o", "out"}));
    const double a = stretch(), b2 = 1 - 0.3 * (a * a - 1), area = mesh == "tet10:bar:2x1x1" ? 0.25 : 1.0 / 16;
    EXPECT_NEAR(report["largest_displacement"]["displacement"][0], a - 1, 1e-6) << mesh;
    EXPECT_NEAR(report["largest_von_mises"]["stress"], traction / b2, 1e-4 * traction) << mesh;
    EXPECT_LT((vector(report["load"]) - Eigen::Vector3d(traction * area, 0, 0)).norm(), 1e-9 * traction) << mesh;
    EXPECT_LT((vector(report["load"]) + vector(report["reaction"]["force"])).norm(), 1e-8 * traction * area) << mesh;
    EXPECT_LT(report["imbalance"], 1e-8) << mesh;
    EXPECT_LT((vector(report["cuts"][0]["force"]) - vector(report["load"])).norm(), 1e-8 * traction * area) << mesh;
    // the planes y = 0 and z = 0 bear nothing, the plane x = 0 bears all
    const CsvTable table = read_csv(folder / "out/reactions.csv");
    const Vector x = table.numbers("x"), rx = table.numbers("rx"), ry = table.numbers("ry");
    EXPECT_NEAR(rx.sum(), -traction * area, 1e-8 * traction * area) << mesh;
    for (Index k = 0; k < x.size(); ++k)
      if (x[k] > 0) EXPECT_EQ(rx[k], 0) << mesh;
    EXPECT_LT(ry.cwiseAbs().maxCoeff(), 1e-6 * traction * area) << mesh;
    for (const char* file : {"out/state.vtu", "out/picture.png", "out/report.json"})
      EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
    EXPECT_THAT(read("out/state.vtu"), HasSubstr("von Mises stress [Pa]"));
    EXPECT_THAT(read("out/state.vtu"), HasSubstr("reaction [N]"));
  }
}

TEST_F(StaticCommandTest, SolvesAModelReducedAndInFull) {
  const Outcome made = supple({"reduce", "bar:8x2x2", "-o", "bar.supple", "--fix", "x=0", "--fix", "z=0:z", "--modes",
                               "10", "--points", "60", "--held-out", "0"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(made.out, HasSubstr("nodes slide"));
  const json reduced = report({"static", "bar.supple", "--scene", "press.json"});
  const json full = report({"static", "bar.supple", "--full", "--scene", "press.json", "--track", "8"});
  EXPECT_EQ(reduced["system"], "reduced");
  EXPECT_LT(reduced["unknowns"], 100);
  const Eigen::Vector3d u = vector(reduced["largest_displacement"]["displacement"]),
                        exact = vector(full["largest_displacement"]["displacement"]);
  EXPECT_LT((u - exact).norm(), 0.05 * exact.norm());
  EXPECT_EQ(full["tracked"].size(), 1u);
  EXPECT_LT(full["imbalance"], 1e-8);
  EXPECT_LT(reduced["imbalance"], 0.2);
  EXPECT_NEAR(reduced["elastic_energy"].get<double>(), full["elastic_energy"],
              0.1 * full["elastic_energy"].get<double>());
  const json info = report({"info", "bar.supple"});
  EXPECT_EQ(info["fixed_nodes"], 9);
  EXPECT_EQ(info["sliding_nodes"], 24);
  // motions: the same supports bear the same weight once the object is at rest
  write("start.json",
        R"({"gravity": [0, -0.5, 0], "surface": [{"nodes": "x>=100%", "pressure": 100}], "start": "equilibrium",
            "duration": 0.05, "step": 0.005})");
  const json still = report({"simulate", "bar.supple", "--full", "--scene", "start.json", "-o", "run"});
  EXPECT_LT(still["energy"]["kinetic"].get<double>(), 1e-12 * still["energy"]["elastic"].get<double>());
  const CsvTable table = read_csv(folder / "run/reactions.csv");
  const Eigen::Vector3d expected = vector(full["reaction"]["force"]);
  for (Index k = 0; k < table.numbers("time").size(); ++k)
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(table.numbers(std::vector<std::string>{"rx", "ry", "rz"}[c])[k], expected[c], 1e-4 * expected.norm());
}

// Forces of a stiff object are differences of large numbers: rounding ends the iteration, not the answer.
TEST_F(StaticCommandTest, SettlesSteelUnderItsWeight) {
  write("weight.json", R"({"gravity": [0, -9.81, 0], "start": "equilibrium", "duration": 0.001, "step": 1e-4})");
  const json report = this->report({"static", "tet10:bar:10x1x1", "--young", "210 GPa", "--poisson", "0.3", "--density",
                                    "7850", "--fix", "x=0", "--scene", "weight.json"});
  const double g = 9.81, h = 0.1, expected = 1.5 * 7850 * g / (210e9 * h * h);  // ρ g A L⁴ / (8 E I), I = h⁴/12
  EXPECT_NEAR(report["largest_displacement"]["size"], expected, 0.05 * expected);
  EXPECT_LT(report["imbalance"], 1e-6);
}

// Loads that end before others begin are not forgotten in silence.
TEST_F(StaticCommandTest, SaysWhichLoadsDoNotAct) {
  write("both.json", R"({"forces": [{"nodes": "x=100%", "force": [0, 0, 1], "until": 0.2},
                                    {"nodes": "x=100%", "force": [0, 1, 0], "from": 0.5}]})");
  const Outcome outcome = supple({"static", "bar:4x1x1", "--fix", "x=0", "--scene", "both.json", "--json", "-"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("1 of its loads and springs do not act at t = 0.5 s"));
  write("ends.json", R"({"forces": [{"nodes": "x=100%", "force": [0, 0, 1], "ramp": 1, "until": 0.5}]})");
  const json report = this->report({"static", "bar:4x1x1", "--fix", "x=0", "--scene", "ends.json"});
  EXPECT_NEAR(report["load"][2].get<double>(), 0.5, 1e-12);
  // and a load along an axis that is held moves nothing
  write("held.json", R"({"forces": [{"nodes": "x=0", "force": [5, 0, 0]}]})");
  const Outcome held =
      supple({"static", "bar:4x1x1", "--fix", "x=0:x", "--fix", "y=0:y", "--fix", "z=0:z", "--scene", "held.json"});
  EXPECT_THAT(held.err, HasSubstr("100 % of this force acts on nodes that the model holds"));
}

TEST_F(StaticCommandTest, WritesStressesIntoFramesOfCells) {
  ASSERT_EQ(supple({"reduce", "bar:4x1x1", "-o", "bar.supple", "--fix", "x=0", "--modes", "4", "--held-out", "0",
                    "--selector", "all"})
                .exit_code,
            0);
  report({"simulate", "bar.supple", "-o", "run", "--time", "0.1", "--step", "0.05", "--frames", "cells"});
  EXPECT_THAT(read("run/series_000001.vtu"), HasSubstr("Cauchy stress [Pa]"));
}

TEST_F(StaticCommandTest, RefusesWhatHasNoEquilibriumAndSaysWhy) {
  expect_refusal({"static", "bar:4x1x1", "--scene", "pull.json"}, {"nothing holds the object", "move along x"});
  expect_refusal({"static", "bar:4x1x1", "--fix", "z=0:z", "--scene", "pull.json"},
                 {"nothing holds the object", "move along x, move along y, turn about z"});
  expect_refusal({"static", "bar:4x1x1", "--fix", "z=0:w", "--scene", "pull.json"}, {"z=0:w"});
  expect_refusal({"static", "bar:4x1x1", "--fix", "z=0:zz", "--scene", "pull.json"}, {"z=0:zz"});
  expect_refusal({"static", "bar:4x1x1", "--fix", "x=0", "--scene", "pull.json", "--cut", "x=2"},
                 {"on one side of the cut"});
  expect_refusal({"static", "bar:4x1x1", "--fix", "x=0", "--scene", "pull.json", "--cut", "x<0.5"},
                 {"expected a plane"});
  write("nowhere.json", R"({"surface": [{"nodes": "x=50%", "pressure": 1}]})");
  expect_refusal({"static", "bar:4x1x1", "--fix", "x=0", "--scene", "nowhere.json"},
                 {"nowhere.json", "selects no face"});
  write("both.json", R"({"surface": [{"nodes": "x=0", "pressure": 1, "traction": [1, 0, 0]}]})");
  expect_refusal({"static", "bar:4x1x1", "--fix", "x=0", "--scene", "both.json"}, {"both.json", "one of 'traction'"});
}

TEST_F(StaticCommandTest, TakesGroupsOfAFileForSupportsAndLoads) {
  // a cube of six tets, its lower and upper sides named
  write("cube.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n1 1 0 0\n0 0 1 0\n1 0 1 0\n"
        "0 1 1 0\n1 1 1 0\nTriangles\n4\n1 2 4 1\n1 4 3 1\n5 6 8 2\n5 8 7 2\n"
        "Tetrahedra\n6\n1 2 4 8 1\n1 4 3 8 1\n1 3 7 8 1\n1 7 5 8 1\n1 5 6 8 1\n1 6 2 8 1\nEnd\n");
  write("load.json", R"({"surface": [{"region": "surface 2", "traction": [0, 0, 100]}],
                         "forces": [{"region": "surface 2", "force": [30, 0, 0]}]})");
  const json report = this->report({"static", "cube.mesh", "--fix-region", "surface 1", "--scene", "load.json"});
  EXPECT_LT((vector(report["reaction"]["force"]) - Eigen::Vector3d(-30, 0, -100)).norm(), 1e-6);
  EXPECT_EQ(report["reaction"]["nodes"], 4);
  // a model knows them, too
  ASSERT_EQ(supple({"reduce", "cube.mesh", "-o", "cube.supple", "--fix-region", "surface 1:xy", "--fix", "z=0:z",
                    "--modes", "3", "--held-out", "0", "--selector", "all", "--recipe", "subspace"})
                .exit_code,
            0);
  const json again = this->report({"static", "cube.supple", "--full", "--scene", "load.json"});
  EXPECT_NEAR(again["elastic_energy"].get<double>(), report["elastic_energy"], 1e-9);
  write("none.json", R"({"surface": [{"region": "top", "pressure": 1}]})");
  expect_refusal({"static", "cube.supple", "--scene", "none.json"}, {"none.json", "top", "surface 1, surface 2"});
}

// An Abaqus file has all but the load: two materials, a support, sets.
TEST_F(StaticCommandTest, TakesAnAbaqusFileWithItsMaterialsAndSupports) {
  write(
      "bar.inp",
      "*Node\n1,0,0,0\n2,10,0,0\n3,20,0,0\n4,0,10,0\n5,10,10,0\n6,20,10,0\n7,0,0,10\n8,10,0,10\n9,20,0,10\n10,0,10,10\n"
      "11,10,10,10\n12,20,10,10\n*Element, type=C3D8, elset=soft\n1, 1,2,5,4,7,8,11,10\n"
      "*Element, type=C3D8, elset=stiff\n2, 2,3,6,5,8,9,12,11\n*Nset, nset=end\n3,6,9,12\n*Nset, nset=wall\n1,4,7,10\n"
      "*Solid Section, elset=soft, material=a\n*Solid Section, elset=stiff, material=b\n"
      "*Material, name=a\n*Elastic\n1e5, 0\n*Density\n1000\n*Material, name=b\n*Elastic\n3e5, 0\n*Density\n1000\n"
      "*Boundary\nwall, XSYMM\n1, 2, 3\n4, 3\n");
  write("load.json", R"({"surface": [{"region": "end", "traction": [100, 0, 0]}]})");
  const json report = this->report({"static", "bar.inp", "--scene", "load.json"});
  // springs in a row, by St. Venant–Kirchhoff without lateral strain: a (a² − 1) / 2 = t / Y each, 10 m long
  double length = 0;
  for (const double young : {1e5, 3e5}) {
    double a = 1;
    for (int k = 0; k < 50; ++k) a -= (a * (a * a - 1) / 2 - 100 / young) / ((3 * a * a - 1) / 2);
    length += 10 * (a - 1);
  }
  EXPECT_NEAR(report["largest_displacement"]["displacement"][0], length, 1e-7 * length);
  EXPECT_EQ(report["reaction"]["nodes"], 4);
  // in millimetres a thousandth of all lengths, and the same stress
  const Outcome small = supple({"static", "bar.inp", "--mesh-unit", "mm", "--scene", "load.json", "--json", "-"});
  ASSERT_EQ(small.exit_code, 0) << small.err;
  EXPECT_THAT(small.err, HasSubstr("taken as they are"));
  EXPECT_NEAR(small.json()["largest_displacement"]["displacement"][0], 1e-3 * length, 1e-9 * length);
  // options replace the supports of the file, with a word
  const Outcome other = supple({"static", "bar.inp", "--fix-region", "end", "--fix", "x=0:y", "--scene", "load.json"});
  ASSERT_EQ(other.exit_code, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("the supports of bar.inp are not used"));
  expect_refusal({"static", "bar:2x1x1", "--mesh-unit", "mm", "--scene", "load.json"},
                 {"built-in meshes are in metres"});
  expect_refusal({"static", "bar.inp", "--mesh-unit", "parsec", "--scene", "load.json"}, {"parsec"});
  expect_refusal({"static", "tet10:bar.inp", "--scene", "load.json"}, {"expected a mesh of tets"});
}

// A bar free at both ends, by the theory of rods: f = c / 2L along it for ν = 0, c = √(Y/ρ), beside bending.
TEST_F(StaticCommandTest, FindsTheFrequenciesOfARod) {
  const json report = this->report({"modes", "bar:20x1x1", "--poisson", "0", "--count", "12", "-o", "modes"});
  EXPECT_EQ(report["motions_without_energy"], 6);
  ASSERT_EQ(report["frequencies"].size(), 18u);
  double nearest = 1e9;
  for (const json& f : report["frequencies"]) nearest = std::min(nearest, std::abs(f.get<double>() - 5));
  EXPECT_LT(nearest, 0.05);  // √(1e5 / 1000) / 2
  const CsvTable table = read_csv(folder / "modes/frequencies.csv");
  EXPECT_EQ(table.numbers("frequency").size(), 18);
  EXPECT_THAT(read("modes/modes.vtu"), HasSubstr("mode 18, "));
  // on one plane of symmetry three motions are left
  const json half = this->report({"modes", "bar:6x2x2", "--fix", "z=0:z", "--count", "2"});
  EXPECT_EQ(half["motions_without_energy"], 3);
  EXPECT_EQ(half["frequencies"].size(), 5u);
}

TEST_F(StaticCommandTest, RaisesTheTetsOfAFileToTheSecondOrder) {
  ASSERT_EQ(supple({"mesh", "bar:4x2x2", "-o", "bar.vtu"}).exit_code, 0);
  write("bend.json", R"({"surface": [{"nodes": "x>=100%", "traction": [0, 0, 50]}]})");
  const auto tip = [&](const std::string& mesh) {
    const Outcome outcome = supple({"static", mesh, "--fix", "x=0", "--scene", "bend.json", "--json", "-"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json()["largest_displacement"]["size"].get<double>();
  };
  const double raised = tip("tet10:bar.vtu");
  EXPECT_NEAR(raised, tip("tet10:bar:4x2x2"), 1e-6 * raised);
  EXPECT_GT(raised, 1.1 * tip("bar.vtu"));
}

TEST_F(StaticCommandTest, FollowsAPressureThatTurns) {
  // a thin cantilever under follower pressure from below ends up beyond the vertical, under a dead one it does not
  const std::string rule = R"("nodes": "z=0 and x>=5%")";
  write("dead.json", "{\"surface\": [{" + rule + ", \"pressure\": 4}]}");
  write("follows.json", "{\"outside\": [{\"force\": \"pressure\", " + rule + ", \"pressure\": 4}]}");
  const Arguments plate{"static", "hexbox:20x2x1", "--fix", "x=0", "--steps", "4"};
  const auto end = [&](const std::string& scene) {
    Arguments arguments = plate;
    for (const char* word : {"--scene", scene.c_str()}) arguments.emplace_back(word);
    return vector(report(arguments)["largest_displacement"]["displacement"]);
  };
  const Eigen::Vector3d dead = end("dead.json"), follows = end("follows.json");
  EXPECT_GT(dead[2], 0.05);
  EXPECT_LT(follows[0], dead[0]);  // it curls further back
}

}  // namespace
}  // namespace supple::test
