#include <io/picture/image.hpp>
#include <io/table/csv.hpp>
#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <cmath>

namespace supple::test {

namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* bend = R"({
  "description": "bend the bar",
  "handles": [{"name": "left", "nodes": "x<10%", "samples": 30}, {"name": "right", "nodes": "x>90%", "weight": "5 kN/m"}],
  "edits": [
    {"increments": 4, "moves": [{"handle": "right", "axis": [0, 0, 1], "angle": "40 deg", "centre": [0.5, 0.1, 0.1]}]},
    {"moves": [{"handle": "left", "translation": ["1 cm", 0, 0]}]}
  ]
})";

class EditCommandTest : public SuppleProcess {
 protected:
  void reduce(Arguments more = {}) const {
    Arguments arguments{"reduce",   "bar:8x2x2", "-o",         "bar.supple", "--poses",  "40",
                        "--points", "80",        "--held-out", "0",          "--recipe", "subspace"};
    if (more.empty()) more = {"--modes", "11"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  /// The report of an edit in a subspace that may be too small for it.
  json edit(Arguments arguments) const {
    arguments.insert(arguments.begin(), "edit");
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json();
  }
};

TEST_F(EditCommandTest, BendsABarAndKeepsWhatItReports) {
  reduce();
  write("bend.json", bend);
  const json report = edit({"bar.supple", "--scene", "bend.json", "-o", "bent"});
  EXPECT_EQ(report["solves"], 5);
  EXPECT_EQ(report["missed_solves"], 0);
  EXPECT_LE(report["worst_residual"], report["tolerance"]);
  EXPECT_EQ(report["handles"][0]["samples"], 9);  // all there are
  EXPECT_EQ(report["handles"][1]["weight"], 5000.0);
  EXPECT_GT(report["elastic_energy"], 0.0);
  EXPECT_EQ(json::parse(read("bent/report.json")), report);
  const CsvTable solves = read_csv(folder / "bent/solves.csv");
  ASSERT_EQ(solves.num_rows(), 5);
  EXPECT_NEAR(solves.numbers("elastic")[4], report["elastic_energy"].get<double>(), 1e-9);
  EXPECT_GT(read_png(folder / "bent/picture.png").width, 600);
  EXPECT_TRUE(std::filesystem::exists(folder / "bent/series.pvd"));

  for (const char* solver : {"bfgs", "nlopt"}) {  // the same equilibrium
    const json other = edit({"bar.supple", "--scene", "bend.json", "--solver", solver, "-o", solver});
    EXPECT_NEAR(other["elastic_energy"].get<double>(), report["elastic_energy"].get<double>(),
                1e-3 * report["elastic_energy"].get<double>());
    EXPECT_LT(this->report({"compare", solver, "bent"})["position_error"]["relative"], 5e-3);
  }
  const json full = this->report({"edit", "bar.supple", "--scene", "bend.json", "--full", "-o", "full"});
  EXPECT_EQ(full["missed_solves"], 0);
  EXPECT_LT(full["elastic_energy"], report["elastic_energy"].get<double>() * 1.2);
  EXPECT_LT(this->report({"compare", "bent", "full"})["position_error"]["relative"], 0.1);
}

TEST_F(EditCommandTest, TakesTheLoadsThatSimulationsTake) {
  reduce({"--modes", "8", "--fix", "x<=0", "--young", "2e4"});
  const auto energy = [&](const std::string& loads) -> double {
    write("scene.json", R"({"handles": [{"name": "tip", "nodes": "x>90%", "weight": 1}], )" + loads +
                            R"("edits": [{"moves": [{"handle": "tip", "translation": [0, 0, 0]}]}]})");
    return edit({"bar.supple", "--scene", "scene.json", "-o", "run"})["elastic_energy"];
  };
  EXPECT_LT(energy(""), 1e-12);  // at rest
  const double by_gravity = energy(R"("gravity": [0, 0, "-981 cm/s^2"], )");
  EXPECT_GT(by_gravity, 1e-3);
  (void)edit({"bar.supple", "--scene", "scene.json", "--full", "-o", "full"});
  EXPECT_LT(report({"compare", "run", "full"})["position_error"]["relative"], 0.2);
  // its weight, 62.5 kg, shared out by mass
  EXPECT_NEAR(energy(R"("forces": [{"nodes": "x>=0", "force": [0, 0, -613.125]}], )"), by_gravity, 1e-4 * by_gravity);
  // held against it
  EXPECT_LT(energy(R"("gravity": [0, 0, -9.81], "springs": [{"nodes": "x>90%", "stiffness": 1e5}], )"),
            0.5 * by_gravity);
  write("scene.json",
        R"({"handles": [{"name": "tip", "nodes": "x>90%"}], "gravity": [0, 1], "edits": [{"moves": []}]})");
  expect_refusal({"edit", "bar.supple", "--scene", "scene.json"}, {"/gravity"});
}

TEST_F(EditCommandTest, SaysWhenTheSubspaceDoesNotFollowTheHandles) {
  ASSERT_EQ(supple({"reduce", "bar:16x3x3", "-o", "bar.supple", "--fix", "x<=0", "--full-loads", "0"}).exit_code, 0);
  const double diagonal = std::sqrt(1 + 2 * 9.0 / 256);
  const auto off = [&](const std::string& move) {  // farthest node from the full shape, of the diagonal
    write("scene.json", R"({"handles": [{"name": "tip", "nodes": "x>=100%"}], "edits": [{"increments": 5, "moves":
      [{"handle": "tip", )" +
                            move + "}]}]}");
    EXPECT_EQ(report({"edit", "bar.supple", "--scene", "scene.json", "--full", "-o", "full"})["missed_solves"], 0);
    const Outcome reduced = supple({"edit", "bar.supple", "--scene", "scene.json", "-o", "reduced"});
    EXPECT_EQ(reduced.exit_code, 0);
    EXPECT_THAT(reduced.out, HasSubstr("handles hold"));
    return std::pair(report({"compare", "reduced", "full"})["largest_distance"]["share_of_diagonal"].get<double>(),
                     reduced.err);
  };
  const auto [right, silence] = off(R"("translation": [0, "1 cm", 0])");
  EXPECT_LT(right, 0.003);
  EXPECT_EQ(silence, "");
  const auto [wrong, warning] = off(R"("axis": [0, 0, 1], "angle": "60 deg")");
  EXPECT_GT(wrong, 0.003);
  EXPECT_THAT(warning, AllOf(HasSubstr("does not follow the handles"), HasSubstr("--full")));
  const json full = json::parse(read("full/report.json")), reduced = json::parse(read("reduced/report.json"));
  EXPECT_LT(full["control_energy"], 0.05 * reduced["control_energy"].get<double>());
  // √(2 E / (λ₁ M)), where the springs of a handle are 10⁵ λ₁ M together
  const json& tip = reduced["handles"][0];
  const double unit = 2 * tip["weight"].get<double>() * tip["samples"].get<double>() / 1e5;
  EXPECT_NEAR(reduced["held_over_diagonal"].get<double>(),
              std::sqrt(2 * reduced["control_energy"].get<double>() / unit) / diagonal, 1e-9);
  EXPECT_NEAR(read_csv(folder / "reduced/solves.csv").numbers("held").maxCoeff(),
              reduced["most_held_over_diagonal"].get<double>(), 1e-9);
}

TEST_F(EditCommandTest, RunsEveryCommandOnHexahedraAndQuadraticTets) {
  write("bend.json", bend);
  for (const std::string mesh : {"hexbox:8x2x2", "tet10:bar:4x1x1"}) {
    SCOPED_TRACE(mesh);
    const std::string kind = mesh.starts_with("hex") ? "hexahedra" : "quadratic_tets";
    const Outcome made = supple({"reduce", mesh, "-o", "bar.supple", "--modes", "11", "--poses", "40", "--points", "80",
                                 "--held-out", "0", "--components", "gauss-points"});
    ASSERT_EQ(made.exit_code, 0) << made.err;
    const json bent = edit({"bar.supple", "--scene", "bend.json", "-o", "bent", "--frames", "cells"});
    EXPECT_EQ(bent["missed_solves"], 0);
    EXPECT_GT(read_png(folder / "bent/picture.png").width, 600);
    EXPECT_EQ(report({"info", "bent/series_000005.vtu"})[kind], mesh.starts_with("hex") ? 32 : 24);
    const json full =
        report({"edit", "bar.supple", "--scene", "bend.json", "--full", "-o", "full", "--frames", "surface"});
    EXPECT_EQ(full["missed_solves"], 0);
    EXPECT_LT(report({"compare", "bent", "full", "-o", "compared"})["position_error"]["relative"], 0.25);
    EXPECT_GT(
        report({"simulate", "bar.supple", "--full", "--time", "0.05", "-o", "moved", "--frames", "tets"})["steps"], 0);
    EXPECT_TRUE(report({"info", "moved/series_000001.vtu"}).contains(kind));
    const json shapes = report({"fidelity", mesh, "--scene", "bend.json", "--modes", "11", "--subspaces", "extended"});
    EXPECT_NEAR(shapes["measure"].get<double>(), 1.0 / 16, 1e-12);
    EXPECT_EQ(shapes["shapes"].size(), 2u);
  }
}

TEST_F(EditCommandTest, TakesHandlesByLabelsAndMotionsByMatrix) {
  reduce();
  std::string labels = "# one a node\n";
  for (int v = 0; v < 81; ++v) labels += v < 9 ? "0\n" : v >= 72 ? "2\n" : "1\n";
  write("bar.sel", labels);
  write("scene.json",
        R"({"handles": [{"name": "a", "file": "bar.sel", "label": 0}, {"name": "b", "file": "bar.sel", "label": 2}],
    "edits": [{"moves": [{"handle": "b", "matrix": [1,0,0,0, 0,1,0,0.05, 0,0,1,0, 0,0,0,1]}]}]})");
  const json report = edit({"bar.supple", "--scene", "scene.json"});
  EXPECT_EQ(report["handles"][0]["nodes"], 9);
  EXPECT_EQ(report["handles"][1]["nodes"], 9);
  EXPECT_GT(report["elastic_energy"], 0.0);
}

TEST_F(EditCommandTest, SaysWhatAnAngleOfManyTurnsIs) {
  reduce();
  const auto warning = [&](const std::string& angle) {
    write("scene.json", R"({"handles": [{"name": "a", "nodes": "x>90%"}, {"name": "b", "nodes": "x<10%"}],
      "edits": [{"moves": [{"handle": "a", "axis": [1, 0, 0], "angle": )" +
                            angle + "}]}]}");
    return supple({"edit", "bar.supple", "--scene", "scene.json"}).err;
  };
  EXPECT_THAT(warning("30"),
              HasSubstr("/edits/0/moves/0/angle is 30 rad, more than a whole turn; degrees are written as \"30 deg\""));
  EXPECT_THAT(warning("0.1"), testing::Not(HasSubstr("turn")));
  EXPECT_THAT(warning("\"400 deg\""), testing::Not(HasSubstr("more than a whole turn")));
}

TEST_F(EditCommandTest, RefusesBadScenesInOneLineAndLeavesNothing) {
  reduce();
  const auto refuse = [&](const std::string& scene, const std::vector<std::string>& parts) {
    write("scene.json", scene);
    expect_refusal({"edit", "bar.supple", "--scene", "scene.json", "-o", "run"}, parts);
    EXPECT_FALSE(std::filesystem::exists(folder / "run")) << scene;
  };
  const std::string left = R"("handles": [{"name": "left", "nodes": "x<10%"}], )";
  refuse("{" + left + R"("edits": []})", {"edits", "empty"});
  refuse(R"({"handles": [], "edits": []})", {"handles", "empty"});
  refuse("{" + left + R"("edits": [{"moves": [{"handle": "right"}]}]})", {"/edits/0/moves/0/handle", "right"});
  refuse("{" + left + R"("edits": [{"moves": [{"handle": "left", "angle": 1}]}]})", {"axis"});
  refuse("{" + left + R"("edits": [{"moves": [{"handle": "left", "angle": 1, "axis": [0,0,0]}]}]})",
         {"axis", "direction"});
  refuse("{" + left + R"("edits": [{"moves": [{"handle": "left", "centre": [0,0,0]}]}]})", {"centre", "angle"});
  refuse("{" + left + R"("edits": [{"moves": [{"handle": "left", "matrix": [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]}]})",
         {"matrix", "rigid"});
  refuse("{" + left + R"("edits": [{"increments": 0, "moves": []}]})", {"increments"});
  refuse(R"({"handles": [{"name": "a", "nodes": "x<10%", "file": "b"}], "edits": [{"moves": []}]})", {"one of"});
  refuse(R"({"handles": [{"name": "a", "nodes": "x>99"}], "edits": [{"moves": []}]})", {"/handles/0", "no node"});
  refuse(R"({"handles": [{"name": "a", "file": "none.sel", "label": 1}], "edits": [{"moves": []}]})", {"none.sel"});
  refuse("{" + left + R"("edit": [], "edits": [{"moves": []}]})", {"edit"});
  write("short.sel", "1\n2\n");
  refuse(R"({"handles": [{"name": "a", "file": "short.sel", "label": 1}], "edits": [{"moves": []}]})",
         {"short.sel", "81"});
  refuse(R"({"handles": [{"name": "a", "file": "short.sel", "label": 4294967297}], "edits": [{"moves": []}]})",
         {"/handles/0/label", "4294967297"});
  write("bad.sel", "1\nx\n");
  refuse(R"({"handles": [{"name": "a", "file": "bad.sel", "label": 1}], "edits": [{"moves": []}]})", {"bad.sel:2"});
  write("scene.json", bend);
  expect_refusal({"edit", "bar.supple", "--scene", "scene.json", "--full", "--solver", "nlopt"}, {"nlopt", "reduced"});
  expect_refusal({"edit", "bar.supple", "--scene", "scene.json", "--tolerance", "0"}, {"tolerance"});
}

TEST_F(EditCommandTest, RefusesAHandleThatIsHeldAndTakesAnEmptyFolderAway) {
  reduce({"--fix", "x<=0"});
  write("scene.json", R"({"handles": [{"name": "root", "nodes": "x<=0"}],
    "edits": [{"moves": [{"handle": "root", "translation": [1, 0, 0]}]}]})");
  expect_refusal({"edit", "bar.supple", "--scene", "scene.json", "-o", "run"}, {"scene.json", "/handles/0", "'root'"});
  write("scene.json", R"({"handles": [{"name": "tip", "nodes": "x>99%"}],
    "edits": [{"moves": [{"handle": "tip", "translation": [1e200, 0, 0]}]}]})");
  expect_refusal({"edit", "bar.supple", "--scene", "scene.json", "-o", "run"}, {"not finite"}, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "run"));
}

TEST_F(EditCommandTest, SamplesOnlyNodesThatCanMove) {
  reduce({"--fix", "x<=10%"});
  for (int seed = 1; seed <= 8; ++seed) {  // 9 of the 18 nodes below 20 % are held
    write("scene.json", R"({"seed": )" + std::to_string(seed) + R"(, "handles": [{"name": "root", "nodes": "x<20%",
      "samples": 1}], "edits": [{"moves": [{"handle": "root", "translation": [0, 0, 0.01]}]}]})");
    EXPECT_GT(edit({"bar.supple", "--scene", "scene.json"})["elastic_energy"], 0.0) << seed;
  }
}

TEST_F(EditCommandTest, EditsInEverySubspace) {
  write("bend.json", bend);
  reduce();
  ASSERT_EQ(supple({"simulate", "bar.supple", "-o", "run", "--every", "5"}).exit_code, 0);
  ASSERT_EQ(supple({"reduce", "bar:8x2x2", "-o", "reference.supple", "--modes", "8", "--poses", "20", "--points", "40",
                    "--held-out", "0"})
                .exit_code,
            0);
  ASSERT_EQ(supple({"simulate", "reference.supple", "-o", "snapshots", "--every", "5"}).exit_code, 0);
  const std::vector<Arguments> choices{{"--subspace", "derivatives", "--modes", "4", "--dimension", "24"},
                                       {"--subspace", "skinning", "--dimension", "48"},
                                       {"--subspace", "modal", "--modes", "18"},
                                       {"--subspace", "pca", "--snapshots", "snapshots", "--dimension", "12"},
                                       {"--subspace", "skinning+modal", "--modes", "14"},
                                       {"--subspace", "modal+pca+extended", "--snapshots", "snapshots"}};
  for (const Arguments& choice : choices) {
    SCOPED_TRACE(choice[1]);
    reduce(choice);
    const json info = report({"info", "bar.supple"});
    EXPECT_EQ(info["subspace"], choice[1]);
    EXPECT_GT(info["dimension"], 5);
    EXPECT_GT(edit({"bar.supple", "--scene", "bend.json"})["elastic_energy"], 0.0);
    EXPECT_EQ(supple({"simulate", "bar.supple", "--time", "0.1", "--step", "0.01", "--json", "-"}).exit_code, 0);
  }
  expect_refusal({"reduce", "bar:8x2x2", "-o", "x.supple", "--subspace", "pca"}, {"--snapshots"});
  expect_refusal({"reduce", "bar:8x2x2", "-o", "x.supple", "--subspace", "modal+fourier"}, {"'fourier'", "extended"});
  expect_refusal({"reduce", "bar:8x2x2", "-o", "x.supple", "--subspace", "modal+modal"}, {"'modal' twice"});
  expect_refusal({"reduce", "bar:8x2x2", "-o", "x.supple", "--subspace", "modal+extended", "--dimension", "30"},
                 {"modal+extended", "dimensions of its parts"});
  expect_refusal(
      {"reduce", "bar:8x2x2", "-o", "x.supple", "--subspace", "derivatives", "--modes", "9", "--dimension", "10"},
      {"10"});
}

TEST_F(EditCommandTest, ComparesSubspacesByTheirShapes) {
  write("bend.json", bend);
  const json report =
      this->report({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--modes", "10", "-o", "fidelity"});
  ASSERT_EQ(report["shapes"].size(), 5u);
  EXPECT_EQ(report["shapes"][0]["space"], "full");
  EXPECT_EQ(report["shapes"][0]["rms_over_diagonal"], 0.0);
  const auto off = [&](int k) { return report["shapes"][k]["rms_over_diagonal"].get<double>(); };
  EXPECT_EQ(report["shapes"][1]["space"], "extended");
  EXPECT_EQ(report["shapes"][3]["space"], "modal");
  EXPECT_EQ(report["shapes"][3]["dimension"], report["shapes"][1]["dimension"]);
  EXPECT_EQ(report["shapes"][2]["dimension"], report["shapes"][1]["dimension"]) << "as many derivatives as it takes";
  EXPECT_LT(off(1), 0.5 * off(3));  // the paper's finding
  EXPECT_GE(
      report["shapes"][1]["elastic_energy"].get<double>() + report["shapes"][1]["control_energy"].get<double>(),
      (report["shapes"][0]["elastic_energy"].get<double>() + report["shapes"][0]["control_energy"].get<double>()) *
          (1 - 1e-6));
  EXPECT_TRUE(report["shapes"][0]["own_minimum"].is_null());
  EXPECT_FALSE(report["shapes"][1]["own_minimum"].is_null());
  const json& full = report["shapes"][0];
  for (int k = 1; k < 5; ++k) {  // the reference is the best minimum found
    const json& own = report["shapes"][k]["own_minimum"];
    if (own.is_null()) continue;  // linear modes may lead nowhere
    EXPECT_GE(own["energy"].get<double>(),
              (full["elastic_energy"].get<double>() + full["control_energy"].get<double>()) * (1 - 1e-9));
  }
  EXPECT_GT(read_png(folder / "fidelity/shapes.png").width, 1000);
  EXPECT_THAT(read("fidelity/table.md"), HasSubstr("| derivatives |"));

  reduce();
  ASSERT_EQ(supple({"edit", "bar.supple", "--scene", "bend.json", "-o", "bent"}).exit_code, 0);
  const json own = this->report(
      {"fidelity", "bar:8x2x2", "--scene", "bend.json", "--modes", "10", "--subspaces", "pca", "--snapshots", "bent"});
  ASSERT_EQ(own["shapes"].size(), 2u);
  EXPECT_EQ(own["shapes"][1]["space"], "pca");
  EXPECT_LT(own["shapes"][1]["rms_over_diagonal"], 0.1);
  const json several = this->report({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--scene", "bend.json", "--modes",
                                     "8", "--subspaces", "skinning,modal+skinning", "-o", "several"});
  ASSERT_EQ(several["shapes"].size(), 6u);
  for (int k = 0; k < 3; ++k)
    EXPECT_EQ(several["shapes"][k]["rms_over_diagonal"], several["shapes"][k + 3]["rms_over_diagonal"]);
  EXPECT_GT(several["shapes"][2]["dimension"], several["shapes"][1]["dimension"]);
  EXPECT_TRUE(std::filesystem::exists(folder / "several/shapes-2.png"));
  // a failure keeps the scenes before it
  write("torn.json", R"({"handles": [{"name": "tip", "nodes": "x>99%"}],
    "edits": [{"moves": [{"handle": "tip", "translation": [1e200, 0, 0]}]}]})");
  expect_refusal({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--scene", "torn.json", "--modes", "8",
                  "--subspaces", "extended", "-o", "torn"},
                 {"not finite"}, 1);
  EXPECT_EQ(json::parse(read("torn/report.json"))["shapes"].size(), 2u);
  EXPECT_THAT(read("torn/table.md"), HasSubstr("| extended |"));
  // a sum has the dimension of its parts
  const json sum = this->report({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--modes", "8", "--dimension", "30",
                                 "--subspaces", "skinning,modal+skinning"});
  EXPECT_EQ(sum["shapes"][1]["dimension"], 24);
  EXPECT_EQ(sum["shapes"][2]["dimension"], several["shapes"][2]["dimension"]);
  expect_refusal({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--dimension", "9223372036854775807"},
                 {"--dimension", "243"});
  expect_refusal({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--poses", "5"}, {"--poses"});
  expect_refusal({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--subspaces", "pca"}, {"--snapshots"});
  expect_refusal({"fidelity", "bar:8x2x2", "--scene", "bend.json", "--snapshots", "bent"}, {"pca"});
}

}  // namespace

}  // namespace supple::test
