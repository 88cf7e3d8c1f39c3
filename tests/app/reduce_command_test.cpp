#include <core/random.hpp>
#include <core/tensor_file.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/picture/image.hpp>
#include <io/table/csv.hpp>
#include <reduction/model/reduced_model.hpp>
#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <chrono>
#include <csignal>
#include <sstream>

namespace supple::test {

namespace {

using nlohmann::json;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class ReduceCommandTest : public SuppleProcess {
 protected:
  static Arguments small(Arguments more = {}) {
    Arguments arguments{"reduce", "bar:8x2x2", "-o", "bar.supple", "--fix", "x<=0",       "--modes",
                        "4",      "--poses",   "20", "--points",   "30",    "--held-out", "10"};
    return by_the_subspace(std::move(arguments), more);
  }
  /// What a test measures about the fit to all components in the subspace.
  static Arguments by_the_subspace(Arguments arguments, const Arguments& more) {
    if (std::ranges::find(more, "--recipe") == more.end()) arguments.insert(arguments.end(), {"--recipe", "subspace"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }

  /// A mesh of few cells, by so many points.
  static Arguments cells(const std::string& mesh, Arguments more = {}) {
    Arguments arguments{"reduce", mesh,      "-o", "bar.supple", "--fix", "x<=0",       "--modes",
                        "4",      "--poses", "20", "--points",   "24",    "--held-out", "5"};
    return by_the_subspace(std::move(arguments), more);
  }
  /// The report of a model whose few points may be warned of.
  json report_of_few(Arguments arguments) const {
    arguments.insert(arguments.end(), {"--json", "-"});
    const Outcome outcome = supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    if (!outcome.err.empty()) {
      EXPECT_THAT(outcome.err, HasSubstr("leave a direction with"));
    }
    return outcome.json();
  }
  /// Removes and spoils each array of the model that a job makes, in turn.
  void expect_arrays_checked(const Arguments& job) const;

  /// Two tets in regions 1 and 2, on the face x = 0.
  void write_two_regions() const {
    write("two.mesh",
          "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n0 1 0 0\n0 0 1 0\n1 0 0 0\n-1 0 0 0\n"
          "Tetrahedra\n2\n1 2 3 4 1\n1 3 2 5 2\nEnd\n");
  }
};

TEST_F(ReduceCommandTest, ReportsWhatItMeasured) {
  const json report = this->report(small());
  EXPECT_EQ(report["mesh"]["tets"], 8 * 2 * 2 * 6);
  EXPECT_EQ(report["mesh"]["fixed_nodes"], 9);
  EXPECT_EQ(report["dimension"], 36);  // 9 r
  EXPECT_GE(report["points"], 1);
  EXPECT_LE(report["points"], 30);
  EXPECT_GT(report["training_error"], 0.0);
  EXPECT_LT(report["training_error"], 0.5);
  EXPECT_EQ(report["held_out"].size(), 3u);
  EXPECT_EQ(report["held_out_error"], report["held_out"][0]["error"]);
  EXPECT_EQ(report["eigenvalues"]["fitted"].size(), 5u);
  EXPECT_EQ(report["eigenvalues"]["exact"].size(), 5u);
  EXPECT_EQ(report["modes"]["omega"].size(), 4u);
  EXPECT_EQ(report["poses"]["count"], 20);
  EXPECT_GT(report["peak_memory"], 1e6);
  EXPECT_FALSE(report["selection"]["stop_reason"].get<std::string>().empty());
  const auto best = [](const json& some) {
    double least = 1;
    for (const json& step : some["selection"]["history"]) least = std::min(least, step["training_error"].get<double>());
    return least;
  };
  EXPECT_GE(report["training_error"], best(report) * (1 - 1e-9));  // weights are refitted, for the sake of equilibria
  EXPECT_LT(report["training_error"], best(report) * 1.1);
  double sum = 0;
  for (const auto& [stage, seconds] : report["seconds"].items())
    if (stage != "total") sum += seconds.get<double>();
  EXPECT_LE(sum, report["seconds"]["total"].get<double>() * (1 + 1e-9));
  EXPECT_TRUE(report["seconds"].contains("selection"));

  const json info = this->report({"info", "bar.supple"});
  EXPECT_EQ(info["dimension"], report["dimension"]);
  EXPECT_EQ(info["points"], report["points"]);
  EXPECT_EQ(info["mesh"]["nodes"], 9 * 3 * 3);
  EXPECT_EQ(info["fixed_nodes"], 9);
  EXPECT_EQ(info["provenance"]["options"], report["options"]);
  EXPECT_EQ(info["provenance"]["training_error"], report["training_error"]);
  EXPECT_EQ(files(), Arguments{"bar.supple"});

  const json poses_alone = this->report(small({"--equilibria", "0"}));
  EXPECT_NEAR(best(poses_alone), poses_alone["training_error"].get<double>(), 1e-6);
}

TEST_F(ReduceCommandTest, GivesTheSameBytesForTheSameSeedWhateverTheThreads) {
  const auto bytes = [&](const Arguments& more) {
    EXPECT_EQ(supple(small(more)).exit_code, 0);
    return read("bar.supple");
  };
  const std::string one = bytes({"--threads", "1"});
  EXPECT_TRUE(one == bytes({"--threads", "2"}));
  EXPECT_FALSE(one == bytes({"--seed", "2"}));
}

TEST_F(ReduceCommandTest, TakesRecipesAndWhatOverridesThem) {
  const json paper = report(small({"--recipe", "paper", "--amplitude", "0.02", "--amplitude", "0.01"}))["options"];
  EXPECT_EQ(paper["selector"], "nn-htp");
  EXPECT_EQ(paper["norm"], "mass");
  EXPECT_EQ(paper["omega_exponent"], 1);
  EXPECT_EQ(paper["poses"], 20);
  EXPECT_EQ(paper["equilibria"], 0);
  EXPECT_EQ(paper["amplitudes"], json({0.02, 0.01}));
  const json usual = report(small({"--norm", "mass"}))["options"];
  EXPECT_EQ(usual["norm"], "mass");
  EXPECT_EQ(usual["omega_exponent"], 2);
}

TEST_F(ReduceCommandTest, FitsToTheFullObjectByDefault) {
  const auto job = [](const Arguments& more = {}) {
    Arguments arguments{"reduce", "bar:8x2x2", "-o", "bar.supple", "--fix", "x<=0", "--modes", "6", "--held-out", "5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  };
  const json relaxed = report(job());
  EXPECT_EQ(relaxed["options"]["recipe"], "relaxed");
  EXPECT_EQ(relaxed["options"]["relaxed"], true);
  EXPECT_EQ(relaxed["dimension"], 27);  // 4.5 r
  EXPECT_LE(relaxed["points"], 36);     // 4/3 d
  const json& full = relaxed["full_error"];
  const double total = full["total"], outside = full["outside_subspace"], inside = full["inside_subspace"];
  EXPECT_EQ(full["loads"].get<int>() + full["unfinished"].get<int>(), 8);
  EXPECT_NEAR(total * total, outside * outside + inside * inside, 1e-12);
  EXPECT_LT(total, 0.1);
  EXPECT_GE(full["worst"], total);
  EXPECT_THAT(supple(job()).out, HasSubstr("fresh loads"));

  const json alone = report(job({"--full-loads", "0"}));
  EXPECT_TRUE(alone["full_error"]["total"].is_null());
  EXPECT_TRUE(alone["equilibrium_error"].is_null());
  const json extended = report(job({"--subspace", "extended", "--full-loads", "3", "--amplitude", "0.02"}));
  EXPECT_EQ(extended["options"]["recipe"], "relaxed");
  EXPECT_EQ(extended["options"]["equilibrium_amplitudes"], json({0.02}));
  EXPECT_EQ(extended["full_error"]["loads"], 3);
  EXPECT_EQ(extended["dimension"], 54);
  EXPECT_EQ(report(job({"--equilibria", "0"}))["options"]["recipe"], "subspace");
  expect_refusal(job({"--recipe", "relaxed", "--equilibria", "0"}), {"equilibria"});
  expect_refusal(job({"--amplitude", "-1"}), {"amplitude"});
  expect_refusal(job({"--full-loads", "-1"}), {"--full-loads"});
  expect_refusal(job({"--recipe", "best"}), {"--recipe", "best"});
}

// A free object, and one of the sheet kind: what has no energy is held in the comparison.
TEST_F(ReduceCommandTest, ComparesFreeObjectsAndShellsWithTheFullOnes) {
  for (const char* mesh : {"bar:8x2x2", "plate:12x6", "cylinder:12x12"}) {
    SCOPED_TRACE(mesh);
    const json report = report_of_few({"reduce", mesh, "-o", "free.supple", "--modes", "10", "--held-out", "0"});
    EXPECT_EQ(report["options"]["recipe"], "relaxed");
    EXPECT_GE(report["full_error"]["loads"], 6);
    EXPECT_LT(report["full_error"]["total"], 0.5);
  }
}

TEST_F(ReduceCommandTest, UpdatesAnEarlierSelectionAmongCandidates) {
  const json first = report(small({"--selector", "nn-sp"}));
  Arguments again = small({"--warm-start", "bar.supple"});
  again[3] = "again.supple";
  for (const char* selector : {"nn-sp", "nn-omp", "ecm"}) {
    Arguments job = again;
    job.insert(job.end(), {"--selector", selector});
    EXPECT_LE(report_of_few(job)["training_error"], first["training_error"].get<double>() * (1 + 1e-9)) << selector;
  }
  std::string some, kept;
  for (int k = 0; k < 192; k += 3) some += std::to_string(k) + "\n";
  write("some.txt", some);
  write("kept.txt", "1 # no candidate\n");
  EXPECT_LT(report_of_few(small({"--candidates", "some.txt", "--must-keep", "kept.txt"}))["training_error"], 0.5);
  for (const json& component : report({"info", "bar.supple"})["indices"])
    EXPECT_TRUE(component == 1 || component.get<int>() % 3 == 0) << component;
  expect_refusal(small({"--warm-start", "none.supple"}), {"none.supple"});
  Arguments other = again;
  other[1] = "bar:4x2x2";
  expect_refusal(other, {"bar.supple", "192 tets", "expected 96 tets"});
  other[1] = "bar:2x8x2";  // as many tets, in other places
  expect_refusal(other, {"bar.supple", "another mesh"});
  write("bad.txt", "192\n");
  expect_refusal(small({"--must-keep", "bad.txt"}), {"bad.txt:1", "component 192"});
}

TEST_F(ReduceCommandTest, WeightsAllCandidatesByNnls) {
  Arguments all = small({"--selector", "all"});
  all.erase(all.begin() + 10, all.begin() + 12);  // without --points
  EXPECT_EQ(report(all)["options"]["points"], 192);
  std::string some, kept;
  for (int k = 0; k < 160; ++k) kept += std::to_string(k) + "\n";
  for (int k = 0; k < 192; k += 3) some += std::to_string(k) + "\n";
  write("some.txt", some);
  write("kept.txt", kept);
  all.insert(all.end(), {"--must-keep", "kept.txt"});
  EXPECT_EQ(report(all)["options"]["points"], 192);
  all.insert(all.end(), {"--candidates", "some.txt"});
  EXPECT_EQ(report(all)["options"]["points"], 160 + 10);  // 162, 165 … 189
  Arguments large = all;
  large[1] = "bar:20x20x20";
  expect_refusal(large, {"not even 170 points mend that"}, 1);  // so few components are no object
  all.insert(all.end(), {"--target-error", "0.1"});
  expect_refusal(all, {"--target-error", "all"});
  expect_refusal(small({"--selector", "all"}), {"192", "--points 30"});
}

TEST_F(ReduceCommandTest, FitsEquilibriaToo) {
  const json without = report(small({"--equilibria", "0"})), with = report(small({"--equilibria", "12"}));
  EXPECT_EQ(report(small())["options"]["equilibria"], 6);  // a third of 20 poses
  EXPECT_TRUE(without["equilibrium_training_error"].is_null());
  EXPECT_GT(with["equilibrium_training_error"], 0.0);
  EXPECT_EQ(with["equilibrium_loads"], 24);
  EXPECT_GT(with["equilibrium_error"], 0.0);
  EXPECT_LT(with["equilibrium_error"], 0.2);
  EXPECT_EQ(with["options"]["equilibria"], 12);
  EXPECT_LT(with["training_error"], 2 * without["training_error"].get<double>());
  EXPECT_THAT(supple(small({"--equilibria", "3"})).out, testing::HasSubstr("equilibria"));
  expect_refusal(small({"--equilibria", "-1"}), {"--equilibria"});
}

TEST_F(ReduceCommandTest, UnderstandsUnits) {
  const json a = report(small({"--young", "0.2 MPa", "--density", "1.1 g/m^3"}));
  const json b = report(small({"--young", "2e5", "--density", "1.1e-3"}));
  EXPECT_NEAR(a["modes"]["omega"][0].get<double>() / b["modes"]["omega"][0].get<double>(), 1, 1e-9);
  EXPECT_NEAR(a["mesh"]["mass"].get<double>() / b["mesh"]["mass"].get<double>(), 1, 1e-12);
}

TEST_F(ReduceCommandTest, ReducesByModesAloneAndByMooneyRivlin) {
  EXPECT_EQ(report(small({"--subspace", "modal"}))["dimension"], 4);
  EXPECT_EQ(report({"info", "bar.supple"})["subspace"], "modal");
  const json mooney = report(small({"--material", "mooney-rivlin"}));
  EXPECT_EQ(mooney["dimension"], 36);
  EXPECT_EQ(report({"info", "bar.supple"})["law"], "mooney-rivlin");
  EXPECT_EQ(report({"info", "bar.supple"})["materials"][0].size(), 3u);
}

TEST_F(ReduceCommandTest, HoldsNodesByRuleBoxFileAndRegion) {
  write_two_regions();
  write("held.txt", "0\n1 # a comment\n");
  const auto fixed = [&](const Arguments& how) {
    Arguments arguments{"reduce", "two.mesh", "-o", "two.supple", "--modes", "2", "--poses", "10", "--points", "2"};
    arguments.insert(arguments.end(), how.begin(), how.end());
    Outcome outcome = supple([&] {
      auto a = arguments;
      a.insert(a.end(), {"--json", "-"});
      return a;
    }());
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json()["mesh"]["fixed_nodes"].get<int>();
  };
  EXPECT_EQ(fixed({"--fix", "x<=0", "--fix", "y>=1"}), 4);
  EXPECT_EQ(fixed({"--fix-box", "-2,-2,-2:-0.5,2,2", "--fix", "y>=1"}), 2);
  EXPECT_EQ(fixed({"--fix-file", "held.txt"}), 2);
  EXPECT_EQ(fixed({"--fix-region", "1"}), 4);
}

TEST_F(ReduceCommandTest, GivesRegionsTheirOwnMaterials) {
  write_two_regions();
  const Arguments job{"reduce", "two.mesh", "-o", "two.supple", "--fix", "x<=0",        "--modes",
                      "2",      "--poses",  "10", "--points",   "2",     "--materials", "materials.json"};
  write("materials.json", R"({"regions": {"2": {"young": "1 MPa", "density": 500}}})");
  ASSERT_EQ(supple(job).exit_code, 0);
  const ReducedModel model = load_model(folder / "two.supple");
  EXPECT_THAT(std::get<Solid>(model.body).material_of_cell, ElementsAre(0, 1));
  EXPECT_DOUBLE_EQ(std::get<Solid>(model.body).parameters(1, 1) / std::get<Solid>(model.body).parameters(0, 1), 10);
  EXPECT_DOUBLE_EQ(std::get<Solid>(model.body).density[0], 1000);
  EXPECT_DOUBLE_EQ(std::get<Solid>(model.body).density[1], 500);

  std::filesystem::remove(folder / "two.supple");
  write("materials.json", R"({"regions": {"3": {"young": "1 MPa"}}})");
  expect_refusal(job, {"materials.json", "3"});
  write("materials.json", R"({"regions": {"2": {"yung": "1 MPa"}}})");
  expect_refusal(job, {"materials.json", "yung", "young"});
  EXPECT_THAT(files(), ElementsAre("materials.json", "two.mesh"));
}

/// A bar of 96 tets whose file begins with nodes that no tet has, four before each layer of the bar.
TEST_F(ReduceCommandTest, CallsNodesAsTheUsersFileDoes) {
  ASSERT_EQ(supple({"mesh", "bar:4x2x2", "-o", "bar.vtu"}).exit_code, 0);
  const TetMesh bar = read_tet_mesh(folder / "bar.vtu");
  std::ostringstream file;
  file << "MeshVersionFormatted 2\nDimension 3\nVertices\n" << bar.num_nodes() + 20 << "\n";
  std::vector<Index> place;
  Index count = 0;
  for (Index v = 0; v < bar.num_nodes(); ++v) {
    if (v % 9 == 0)
      for (int k = 0; k < 4; ++k, ++count) file << "99 99 99 0\n";
    place.push_back(count++);
    file << bar.nodes(v, 0) << " " << bar.nodes(v, 1) << " " << bar.nodes(v, 2) << " 0\n";
  }
  file << "Tetrahedra\n" << bar.num_cells() << "\n";
  for (const Tet& tet : bar.cells) {
    for (const Index v : tet) file << place[v] + 1 << " ";
    file << "0\n";
  }
  write("more.mesh", file.str());
  std::string list;
  Index tip = 0;
  for (Index v = 0; v < bar.num_nodes(); ++v) {
    if (bar.nodes(v, 0) == 0) list += std::to_string(place[v]) + "\n";
    if (bar.nodes.row(v).sum() > bar.nodes.row(tip).sum()) tip = v;
  }
  write("held.txt", list);
  const Arguments more{"--modes", "4", "--poses", "20", "--points", "30", "--held-out", "0", "--recipe", "subspace"};
  const auto reduced = [&](Arguments job) {
    job.insert(job.end(), more.begin(), more.end());
    const Outcome outcome = supple(job);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  };
  reduced({"reduce", "bar.vtu", "-o", "plain.supple", "--fix", "x<=0"});
  reduced({"reduce", "more.mesh", "-o", "more.supple", "--fix-file", "held.txt"});
  const auto displacement = [&](const std::string& model, Index node) -> Vector {
    const std::string name = std::to_string(node);
    write("pull.json", R"({"duration": 0.1, "step": 0.02, "forces": [{"node": )" + name +
                           R"(, "force": [0, 0, 1]}], "output": {"track": [)" + name + "]}}");
    (void)report({"simulate", model, "--scene", "pull.json", "-o", "run", "--frames", "none"});
    return read_csv(folder / "run/tracked.csv").numbers("uz" + name);
  };
  const Vector plain = displacement("plain.supple", tip), moved = displacement("more.supple", place[tip]);
  EXPECT_GT(plain.maxCoeff(), 0);
  EXPECT_NEAR((plain - moved).norm(), 0, 1e-9 * plain.norm());
  write("pull.json", R"({"forces": [{"node": 0, "force": [0, 0, 1]}]})");
  expect_refusal({"simulate", "more.supple", "--scene", "pull.json"}, {"/forces/0/node is 0", "no cell has"});
  expect_refusal({"simulate", "more.supple", "--track", "0"}, {"--track", "no cell has node 0"});
}

TEST_F(ReduceCommandTest, RefusesMaterialsThatContradictInCellsOfSeveralGroups) {
  write("two.msh",
        "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 20 \"left\"\n3 30 \"all\"\n$EndPhysicalNames\n"
        "$Entities\n0 0 0 2\n1 0 0 0 1 1 1 2 20 30 0\n2 0 0 0 1 1 1 1 30 0\n$EndEntities\n$Nodes\n1 5 1 5\n3 1 0 "
        "5\n1\n2\n3\n"
        "4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n$EndNodes\n$Elements\n2 2 1 2\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 1 3 2 "
        "5\n"
        "$EndElements\n");
  const json regions = report({"info", "two.msh"})["regions"];
  EXPECT_EQ(regions.size(), 2u);
  EXPECT_EQ(regions[0]["tets"], 1);
  EXPECT_EQ(regions[1]["tets"], 2);
  const Arguments job{"reduce", "two.msh", "-o", "two.supple", "--modes", "7", "--materials", "materials.json"};
  write("materials.json", R"({"regions": {"left": {"young": "1 MPa"}, "all": {"young": "2 MPa"}}})");
  expect_refusal(job, {"materials.json", "'left'", "'all'", "differ"});
}

TEST_F(ReduceCommandTest, TakesSnapshotsOfAllNodesWithRoundingWhereTheyAreHeld) {
  const Index nodes = 9 * 3 * 3, held = 9, count = 8;  // at x = 0
  Random random(1);
  Matrix snapshots(3 * nodes, count);
  for (double& x : snapshots.reshaped()) x = 0.01 * random.normal();
  const auto job = [&](double at_held) {
    snapshots.topRows(3 * held).setConstant(at_held);
    TensorFileWriter tensors;
    tensors.add("poses", snapshots);
    tensors.write(folder / "snapshots.safetensors");
    return Arguments{"reduce",     "bar:8x2x2", "-o",         "pca.supple", "--fix",       "x<=0",
                     "--subspace", "pca",       "--points",   "100",        "--snapshots", "snapshots.safetensors",
                     "--poses",    "20",        "--held-out", "0"};
  };
  Arguments rounded = job(1e-18);
  rounded.insert(rounded.end(), {"--json", "-"});
  EXPECT_EQ(supple(rounded).json()["dimension"], count);  // such wild poses are warned of
  expect_refusal(job(0.01), {"node 0, which is fixed"}, 2);
  snapshots.transposeInPlace();
  TensorFileWriter tensors;
  tensors.add("poses", snapshots);
  tensors.write(folder / "turned.safetensors");
  expect_refusal({"reduce", "bar:8x2x2", "-o", "x.supple", "--subspace", "pca", "--snapshots", "turned.safetensors"},
                 {"turned.safetensors", "8 x 243", "expected 243 rows", "transposed"});
}

TEST_F(ReduceCommandTest, BlamesTheCandidatesWhereTheyAreTheLimit) {
  write("three.txt", "1\n50\n100\n");
  const Outcome outcome =
      supple({"reduce",         "bar:8x2x2", "-o",         "bar.supple", "--fix",        "x<=0",
              "--modes",        "2",         "--subspace", "modal",      "--poses",      "20",
              "--held-out",     "0",         "--recipe",   "subspace",   "--candidates", "three.txt",
              "--target-error", "1e-6"});
  EXPECT_THAT(outcome.err, HasSubstr("3 candidates"));
  EXPECT_THAT(outcome.err, testing::Not(HasSubstr("more --points than")));
}

TEST_F(ReduceCommandTest, FitsPosesOfAFile) {
  const Index dofs = 3 * 9 * 3 * 3, count = 12;
  Random random(1);
  Matrix poses(dofs, count);
  for (double& x : poses.reshaped()) x = 0.01 * random.normal();
  TensorFileWriter tensors;
  tensors.add("poses", poses);
  tensors.write(folder / "poses.safetensors");
  std::string npy = "\x93NUMPY\x01";
  npy += '\0';
  std::string header = "{'descr': '<f8', 'fortran_order': True, 'shape': (" + std::to_string(dofs) + ", " +
                       std::to_string(count) + "), }";
  header.resize(118, ' ');
  npy += static_cast<char>(header.size());
  npy += '\0';
  npy += header;
  npy.append(reinterpret_cast<const char*>(poses.data()), sizeof(double) * poses.size());
  write("poses.npy", npy);
  const json a = report(small({"--poses-file", "poses.safetensors"})), b = report(small({"--poses-file", "poses.npy"}));
  EXPECT_EQ(a["poses"]["count"], count);
  EXPECT_EQ(a["training_error"], b["training_error"]);

  write("short.npy", npy.substr(0, npy.size() - 8));
  expect_refusal(small({"--poses-file", "short.npy"}), {"short.npy", "ends"});
  tensors = {};
  tensors.add("poses", Matrix(Matrix::Ones(7, 3)));
  tensors.write(folder / "wrong.safetensors");
  expect_refusal(small({"--poses-file", "wrong.safetensors"}), {"7"});
  poses.col(4).setZero();
  tensors = {};
  tensors.add("poses", poses);
  tensors.write(folder / "rest.safetensors");
  expect_refusal(small({"--poses-file", "rest.safetensors"}), {"rest.safetensors", "pose 4", "at rest"});
}

TEST_F(ReduceCommandTest, FitsPosesOfATrajectoryWhateverItsSubspace) {
  ASSERT_EQ(supple(small({"--subspace", "modal"})).exit_code, 0);
  ASSERT_EQ(supple({"simulate", "bar.supple", "-o", "run", "--every", "10"}).exit_code, 0);
  Arguments arguments = small({"--poses-file", "run"});
  arguments[3] = "again.supple";  // the trajectory needs its own model
  const json fitted = report(arguments);
  EXPECT_EQ(fitted["poses"]["count"], 18);  // the first frame is at rest
  EXPECT_LT(fitted["training_error"], 0.2);
  arguments[1] = "bar:8x2x3";
  expect_refusal(arguments, {"run", "another mesh"});
}

TEST_F(ReduceCommandTest, TakesSurfacesAsShells) {
  const auto plate = [](Arguments more = {}) {
    Arguments arguments{"reduce", "plate:12x6", "-o", "plate.supple", "--fix", "x<12%",      "--modes",
                        "4",      "--poses",    "20", "--points",     "60",    "--held-out", "10"};
    return by_the_subspace(std::move(arguments), more);
  };
  const json report = this->report(plate({"--thickness", "2 cm", "--picture", "plate.png", "--plots", "plots"}));
  EXPECT_GT(report["mesh"]["flaps"], 100);
  EXPECT_EQ(report["options"]["equilibria"], 6);
  EXPECT_LT(report["equilibrium_training_error"], 0.2);
  // few points for a shell, which is too soft somewhere: the report says so, and what it would take
  const json& stiffness = report["rest_stiffness"];
  EXPECT_LT(stiffness["smallest"], 0.7);
  EXPECT_EQ(stiffness["sound"], false);
  const Outcome told = supple(plate());
  EXPECT_THAT(told.out, AllOf(HasSubstr("stiffness at rest"), HasSubstr("0.7 to 1.3 would take")));
  EXPECT_EQ(this->report({"info", "plate.supple"})["provenance"].count("rest_stiffness"), 1u);
  EXPECT_EQ(this->report({"reduce", "plate:12x6", "-o", "free.supple", "--modes", "8", "--poses", "20", "--points",
                          "60", "--held-out", "0", "--recipe", "subspace"})["options"]["equilibria"],
            0);  // free shells have none
  EXPECT_FALSE(report["mesh"].contains("tets"));
  EXPECT_EQ(report["dimension"], 36);
  EXPECT_LT(report["training_error"], 0.4);
  EXPECT_GT(read_png(folder / "plate.png").width, 600);
  const json info = this->report({"info", "plate.supple"});
  EXPECT_EQ(info["law"], "discrete-shell");
  EXPECT_EQ(info["mesh"]["flaps"], report["mesh"]["flaps"]);
  ASSERT_EQ(supple({"simulate", "plate.supple", "-o", "run"}).exit_code, 0);
  EXPECT_GT(read_png(folder / "run/picture.png").width, 600);
  // a share of the diagonal is the default
  const double mass = this->report(plate({"--thickness", "1%"}))["mesh"]["mass"];
  EXPECT_DOUBLE_EQ(this->report(plate())["mesh"]["mass"], mass);
  expect_refusal(plate({"--material", "mooney-rivlin"}), {"discrete shell"});
  expect_refusal(plate({"--thickness", "-1"}), {"thickness"});
  expect_refusal(plate({"--fix-region", "7"}), {"no regions"});
  expect_refusal(small({"--thickness", "1%"}), {"--thickness", "tets"});
}

TEST_F(ReduceCommandTest, KeepsNoPosesOfInfiniteEnergy) {
  EXPECT_EQ(report(small({"--material", "mooney-rivlin"}))["options"]["inverted"], "shrink");
  EXPECT_EQ(report(small({}))["options"]["inverted"], "keep");
  expect_refusal(small({"--material", "mooney-rivlin", "--inverted", "keep"}), {"inverted", "shrink or redraw"});
}

TEST_F(ReduceCommandTest, DrawsWhatItSelected) {
  ASSERT_EQ(supple(small({"--picture", "bar.png", "--plots", "plots"})).exit_code, 0);
  const Image picture = read_png(folder / "bar.png");
  EXPECT_GT(picture.width, 600);
  Index reddish = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) reddish += picture.at(x, y).r > picture.at(x, y).b + 0.2;
  EXPECT_GT(reddish, 100);
  EXPECT_GT(read_png(folder / "plots/error.png").width, 300);
  EXPECT_GT(read_png(folder / "plots/spectrum.png").width, 300);
}

TEST_F(ReduceCommandTest, RefusesBadInputInOneLineAndLeavesNothing) {
  const auto refuse = [&](const Arguments& arguments, const std::vector<std::string>& parts) {
    expect_refusal(arguments, parts);
  };
  refuse({"reduce", "nowhere.msh", "-o", "m"}, {"nowhere.msh"});
  refuse({"reduce", "bar:8x2", "-o", "m"}, {"bar:8x2"});
  refuse(small({"--fix", "w<3"}), {"w<3"});
  refuse(small({"--young", "3 kg"}), {"--young", "kg"});
  refuse(small({"--poisson", "0.5"}), {"0.5"});
  refuse(small({"--material", "jelly"}), {"--material", "jelly"});
  refuse(small({"--selector", "best"}), {"best"});
  refuse({"reduce", "bar:8x2x2", "-o", "m", "--points", "0"}, {"0"});
  refuse(small({"--amplitude", "-1"}), {"amplitude"});
  refuse({"reduce", "bar:8x2x2", "-o", "m", "--held-out", "-1"}, {"held-out"});
  refuse(small({"--fix-file", "none.txt"}), {"none.txt"});
  refuse(small({"--fix-region", "bone"}), {"bone"});
  refuse(small({"--materials", "none.json"}), {"none.json"});
  refuse(small({"--json", "no/such/report.json"}), {"no/such"});
  refuse(small({"--damping-alpha", "-1"}), {"damping"});
  for (const char* target : {"0", "nan", "-1"}) refuse(small({"--target-error", target}), {"--target-error", target});
  for (const char* exponent : {"inf", "nan", "1e300"}) refuse(small({"--omega-exponent", exponent}), {exponent});
  refuse({"reduce", "bar:8x2x2", "-o", "no/such/bar.supple"}, {"no/such"});
  write("lone.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  refuse({"reduce", "lone.off", "-o", "m"}, {"lone.off", "triangle 0"});
  std::filesystem::remove(folder / "lone.off");
  refuse({"reduce", "bar:8x2x2"}, {"--output"});
  refuse({"reduce", "bar:2x1x1", "-o", "m", "--modes", "1000", "--plots", "p1/p2/p3"}, {"1000"});
  EXPECT_TRUE(files().empty()) << files().front();
}

TEST_F(ReduceCommandTest, MakesNoModelThatCannotHold) {
  const auto by = [](const std::string& points, const Arguments& more) {
    Arguments arguments = small(more);
    *(std::ranges::find(arguments, "--points") + 1) = points;
    return arguments;
  };
  const json report = this->report(by("100", {"--target-error", "0.5"}));
  EXPECT_LE(report["training_error"], 0.5);
  EXPECT_EQ(report["rest_stiffness"]["weak"], false);
  EXPECT_GE(report["rest_stiffness"]["smallest"], 0.1);
  const Index too_weak = report["rest_stiffness"]["points_too_weak"];
  ASSERT_GT(too_weak, 0);
  EXPECT_LT(too_weak, report["points"]);
  EXPECT_THAT(supple(by("100", {"--target-error", "0.5"})).out,
              HasSubstr(std::to_string(too_weak) + " have the target error"));

  std::filesystem::remove(folder / "bar.supple");
  expect_refusal(by("4", {}), {"selected tets leave a direction", "it takes", "points"}, 1);
  expect_refusal(by("5", {"--target-error", "0.5"}), {"it takes"}, 1);
  EXPECT_TRUE(files().empty());
  // twice as many as the rank takes hold it, but badly
  const Outcome weak = supple(by("14", {"--json", "-"}));
  EXPECT_EQ(weak.exit_code, 0) << weak.err;
  EXPECT_THAT(weak.err, HasSubstr("warning: the 14 selected tets leave a direction with"));
  EXPECT_EQ(weak.json()["rest_stiffness"]["weak"], true);
}

TEST_F(ReduceCommandTest, NamesElementsThatDoNotLock) {
  const auto warning = [&](const std::string& mesh, const Arguments& more) {
    Arguments arguments = cells(mesh, {"--json", "-"});
    *(std::ranges::find(arguments, "--points") + 1) = "60";
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const json notes = outcome.json()["notes"];
    if (notes.empty()) return std::string();
    EXPECT_THAT(outcome.err, HasSubstr(notes[0].get<std::string>()));
    return notes[0].get<std::string>();
  };
  EXPECT_THAT(warning("bar:8x2x2", {"--poisson", "0.4999"}),
              AllOf(HasSubstr("0.4999: above 0.45 linear tets lock"), HasSubstr("tet10:bar:8x2x2")));
  EXPECT_THAT(warning("hexbox:8x3x3", {"--poisson", "0.46", "--components", "gauss-points"}),
              AllOf(HasSubstr("hexahedra lock"), HasSubstr("tet10:bar:8x3x3")));
  EXPECT_THAT(warning("bar:8x2x2", {"--parameter", "lambda=1e7"}), HasSubstr("lock"));
  EXPECT_EQ(warning("tet10:bar:8x2x2", {"--poisson", "0.4999"}), "");
  EXPECT_EQ(warning("bar:8x2x2", {"--poisson", "0.45"}), "");
  ASSERT_EQ(supple({"mesh", "bar:8x2x2", "-o", "bar.vtu"}).exit_code, 0);
  EXPECT_THAT(warning("bar.vtu", {"--poisson", "0.48"}), HasSubstr("a mesh of tets with 10 nodes"));
}

TEST_F(ReduceCommandTest, SaysWhenATargetIsOutOfReach) {
  const Outcome outcome = supple(small({"--target-error", "1e-9"}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("--points"));
}

/// Damaged in any way, a model is refused with its name, and never crashes the reader.
TEST_F(ReduceCommandTest, RefusesDamagedModels) {
  ASSERT_EQ(supple(small()).exit_code, 0);
  const std::string good = read("bar.supple");
  Random random(3);
  const auto refused = [&](const std::string& bytes) {
    write("bad.supple", bytes);
    try {
      (void)load_model(folder / "bad.supple");
      return false;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("bad.supple"));
      return true;
    }
  };
  for (int k = 0; k < 300; ++k) {
    std::string bad = good;
    char& byte = bad[random.below(k % 2 ? 4000 : static_cast<Index>(bad.size()))];
    byte = static_cast<char>(byte ^ (1 << random.below(8)));
    EXPECT_TRUE(refused(bad)) << k;
    EXPECT_TRUE(refused(good.substr(0, random.below(static_cast<Index>(good.size()))))) << k;
  }
  write("bad.supple", good.substr(0, 5000));
  expect_refusal({"info", "bad.supple"}, {"bad.supple"});
  expect_refusal({"simulate", "bad.supple"}, {"bad.supple"});
}

/// Arrays that are whole but wrong: each is put in place of the good one, with checksums that hold.
void ReduceCommandTest::expect_arrays_checked(const Arguments& job) const {
  ASSERT_EQ(supple(job).exit_code, 0);
  const TensorFile good(folder / "bar.supple");
  const auto with = [&](const std::string& name, const auto& replace) {
    TensorFileWriter file;
    file.metadata = {good.metadata().begin(), good.metadata().end()};
    for (const auto& [key, tensor] : good.tensors()) {
      if (key == name)
        replace(file);
      else if (tensor.dtype == DType::F64)
        file.add(key, good.values<double>(key), tensor.shape);
      else if (tensor.dtype == DType::I32)
        file.add(key, good.values<std::int32_t>(key), tensor.shape);
      else
        file.add(key, good.values<std::int64_t>(key), tensor.shape);
    }
    file.write(folder / "bad.supple");
  };
  for (const auto& [name, tensor] : good.tensors()) {
    with(name, [](TensorFileWriter&) {});
    expect_refusal({"simulate", "bad.supple", "--time", "1 ms"}, {"bad.supple", name});
    // values that no model can have: NaN; indices out of range
    with(name, [&, name = name, tensor = tensor](TensorFileWriter& file) {
      const std::size_t count = tensor.bytes.size() / size_of(tensor.dtype);
      if (tensor.dtype == DType::F64)
        file.add(name, std::span<const double>(std::vector<double>(count, std::nan(""))), tensor.shape);
      else if (tensor.dtype == DType::I32)
        file.add(name, std::span<const std::int32_t>(std::vector<std::int32_t>(count, -1)), tensor.shape);
      else
        file.add(name, std::span<const std::int64_t>(std::vector<std::int64_t>(count, 1 << 30)), tensor.shape);
    });
    const Outcome outcome = supple({"simulate", "bad.supple", "--time", "1 ms"});
    EXPECT_LE(outcome.exit_code, 2) << name;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), outcome.exit_code == 0 ? 0 : 1) << name;
  }
}

TEST_F(ReduceCommandTest, RefusesModelsWhoseArraysContradict) {
  expect_arrays_checked(small());
  expect_arrays_checked(cells("hexbox:6x2x2", {"--components", "gauss-points"}));
  expect_arrays_checked(cells("tet10:bar:3x1x1"));
  // what tells the components apart
  ASSERT_EQ(supple(cells("hexbox:6x2x2", {"--components", "gauss-points"})).exit_code, 0);
  ReducedModel model = load_model(folder / "bar.supple");
  std::get<HexSolid>(model.body).component = SolidComponent::Element;
  model.indices.back() = 191;
  save_model(folder / "bar.supple", model);
  expect_refusal({"info", "bar.supple"}, {"bar.supple", "names component", "0 to 23"});
  TensorFileWriter both;
  both.metadata = {{"format", "supple reduced model"}, {"format_version", "1"}};
  both.add("mesh.nodes", RowMatrix(RowMatrix::Zero(8, 3)));
  both.add("mesh.tets", std::vector<std::array<std::int32_t, 4>>{{0, 1, 2, 3}});
  both.add("mesh.hexahedra", std::vector<std::array<std::int32_t, 8>>{{0, 1, 2, 3, 4, 5, 6, 7}});
  both.write(folder / "both.supple");
  expect_refusal({"info", "both.supple"}, {"both.supple", "both mesh.tets and mesh.hexahedra"});
  both.metadata["component"] = "gauss-point";
  TensorFileWriter tets;
  tets.metadata = both.metadata;
  tets.add("mesh.nodes", RowMatrix(RowMatrix::Zero(8, 3)));
  tets.add("mesh.tets", std::vector<std::array<std::int32_t, 4>>{{0, 1, 2, 3}});
  tets.write(folder / "tets.supple");
  expect_refusal({"info", "tets.supple"}, {"tets.supple", "'gauss-point'", "none for tets"});
}

TEST_F(ReduceCommandTest, GoesOnFromACheckpointWithTheSameBits) {
  for (const Arguments& job : {Arguments{"reduce", "bar:10x3x3", "--fix", "x<=0", "--modes", "6"},
                               Arguments{"reduce", "bar:10x3x3", "--recipe", "subspace", "--modes", "9"},
                               Arguments{"reduce", "bar:10x3x3", "--recipe", "subspace", "--subspace", "skinning"}}) {
    const auto bytes_of = [&](const Arguments& more) {
      Arguments arguments = job;
      arguments.insert(arguments.end(), more.begin(), more.end());
      const Outcome outcome = supple(arguments);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      return read(more[1]);
    };
    const std::string whole = bytes_of({"-o", "whole.supple"});
    EXPECT_EQ(bytes_of({"-o", "first.supple", "--checkpoint", "kept"}), whole);
    std::vector<std::filesystem::path> stages;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "kept")) stages.push_back(entry.path());
    EXPECT_GE(stages.size(), 2u);
    for (const std::filesystem::path& stage : stages) {  // as after a stop before it
      std::filesystem::remove(stage);
      EXPECT_EQ(bytes_of({"-o", "again.supple", "--checkpoint", "kept"}), whole) << "without " << stage;
      EXPECT_TRUE(std::filesystem::exists(stage));
    }
    for (const std::filesystem::path& stage : stages) std::filesystem::last_write_time(stage, {});
    EXPECT_EQ(bytes_of({"-o", "again.supple", "--checkpoint", "kept"}), whole);
    for (const std::filesystem::path& stage : stages)
      EXPECT_EQ(std::filesystem::last_write_time(stage), std::filesystem::file_time_type())
          << stage << " was made twice";
    std::filesystem::remove_all(folder / "kept");
  }
}

TEST_F(ReduceCommandTest, KeepsStagesOfOtherObjectsAndOptionsApart) {
  const auto bytes_of = [&](const Arguments& more, bool keep) {
    Arguments arguments{"reduce", "bar:6x2x2", "-o", "bar.supple", "--fix", "x<=0"};
    if (std::ranges::find(more, "--modes") == more.end()) arguments.insert(arguments.end(), {"--modes", "5"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    if (keep) arguments.insert(arguments.end(), {"--checkpoint", "kept"});
    const Outcome outcome = supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return read("bar.supple");
  };
  for (const Arguments& other : {Arguments{}, Arguments{"--points", "40"}, Arguments{"--seed", "2"},
                                 Arguments{"--material", "stable-neo-hookean"}, Arguments{"--young", "2e5"},
                                 Arguments{"--modes", "7"}, Arguments{"--equilibria", "20"}})
    EXPECT_EQ(bytes_of(other, true), bytes_of(other, false)) << (other.empty() ? "" : other[0]);
}

TEST_F(ReduceCommandTest, GoesOnAfterItWasKilled) {
  const Arguments job{"reduce", "bar:24x8x8", "-o", "bar.supple", "--fix", "x<=0", "--full-loads", "0"};
  ASSERT_EQ(supple(job).exit_code, 0);
  const std::string whole = read("bar.supple");
  Arguments kept = job;
  kept.insert(kept.end(), {"--checkpoint", "kept"});
  const Outcome stopped = run_supple_until_signal_while_writing(kept, folder, SIGINT);  // its first stage
  EXPECT_EQ(stopped.exit_code, 128 + SIGINT);
  EXPECT_THAT(stopped.err, HasSubstr("interrupted; the same command goes on from the stages that kept keeps"));
  for (const std::chrono::milliseconds after : {100ms, 300ms, 600ms, 900ms})
    (void)run_supple_until_signal(kept, folder, SIGKILL, after);
  const Outcome outcome = supple(kept);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(read("bar.supple"), whole);
}

TEST_F(ReduceCommandTest, TakesHexahedraAndQuadraticTets) {
  struct Job {
    std::string mesh, kind;
    Index cells, points_per_cell;
  };
  for (const Job& job : {Job{"hexbox:6x2x2", "hexahedra", 24, 8}, Job{"tet10:bar:3x1x1", "quadratic_tets", 18, 4}}) {
    SCOPED_TRACE(job.mesh);
    const json whole = report(cells(job.mesh, {"--material", "neo-hookean", "--picture", "bar.png"}));
    EXPECT_EQ(whole["mesh"][job.kind], job.cells);
    EXPECT_FALSE(whole["mesh"].contains("tets"));
    EXPECT_EQ(whole["mesh"]["warnings"].size(), 0u);
    EXPECT_LE(whole["points"], job.cells);
    EXPECT_LT(whole["training_error"], 0.5);
    EXPECT_EQ(whole["options"]["components"], "cells");
    EXPECT_NEAR(whole["mesh"]["mass"].get<double>(), 1000.0 / 9, 1e-9);
    EXPECT_GT(read_png(folder / "bar.png").width, 600);
    const json info = report({"info", "bar.supple"});
    EXPECT_EQ(info["mesh"][job.kind], job.cells);
    EXPECT_NEAR(info["mesh"]["volume"].get<double>(), 1.0 / 9, 1e-12);
    EXPECT_EQ(info["mesh"]["boundary_faces"], job.points_per_cell == 8 ? 56 : 28);
    EXPECT_EQ(info["law"], "neo-hookean");
    const json points = report(cells(job.mesh, {"--components", "gauss-points"}));
    EXPECT_EQ(points["mesh"]["gauss_points"], job.cells * job.points_per_cell);
    EXPECT_EQ(points["mesh"][job.kind], job.cells);
    EXPECT_LT(points["training_error"], 0.5);
    EXPECT_EQ(report({"info", "bar.supple"})["component"], "Gauss points");
    // the object is the same one
    EXPECT_NEAR(points["eigenvalues"]["exact"][0].get<double>() / whole["eigenvalues"]["exact"][0].get<double>(), 1,
                1e-6);
    EXPECT_GT(report({"simulate", "bar.supple", "--time", "0.05"})["steps"], 0);
    EXPECT_EQ(report({"info", job.mesh})[job.kind], job.cells);
    ASSERT_EQ(supple({"mesh", job.mesh, "-o", "mesh.vtu"}).exit_code, 0);
    EXPECT_EQ(report({"info", "mesh.vtu"})[job.kind], job.cells);
    EXPECT_EQ(report(cells("mesh.vtu", {"--material", "neo-hookean"}))["training_error"], whole["training_error"]);
  }
  EXPECT_NEAR(report({"info", "hexbox:2x1x1"})["scaled_jacobian"]["worst"].get<double>(), 1, 1e-12);
  expect_refusal(small({"--components", "gauss-points"}), {"--components", "linear tet"});
  expect_refusal({"reduce", "sphere:8", "-o", "m", "--components", "gauss-points"}, {"--components", "flaps"});
  expect_refusal(small({"--components", "corners"}), {"corners"});
  expect_refusal(cells("hexbox:6x2x2", {"--thickness", "1%"}), {"--thickness", "hexahedra"});
  expect_refusal(cells("hexbox:6x2", {}), {"hexbox:6x2", "hexbox:40x10x10"});
}

TEST_F(ReduceCommandTest, GivesRegionsOfHexahedraTheirOwnMaterials) {
  write("two.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n12\n0 0 0 0\n1 0 0 0\n1 1 0 0\n0 1 0 0\n0 0 1 0\n1 0 1 0\n1 1 "
        "1 0\n"
        "0 1 1 0\n0 0 2 0\n1 0 2 0\n1 1 2 0\n0 1 2 0\nHexahedra\n2\n1 2 3 4 5 6 7 8 1\n5 6 7 8 9 10 11 12 2\nEnd\n");
  write("materials.json", R"({"law": "ogden", "regions": {"2": {"young": "1 MPa", "density": 500}}})");
  const json made = report({"reduce", "two.mesh", "-o", "two.supple", "--fix-region", "1", "--modes", "2", "--poses",
                            "10", "--points", "2", "--materials", "materials.json"});
  EXPECT_EQ(made["mesh"]["fixed_nodes"], 8);
  EXPECT_EQ(made["options"]["material"], "ogden");
  const HexSolid solid = std::get<HexSolid>(load_model(folder / "two.supple").body);
  EXPECT_THAT(solid.material_of_cell, ElementsAre(0, 1));
  EXPECT_THAT(solid.mesh.region, ElementsAre(1, 2));
  EXPECT_DOUBLE_EQ(solid.density[1], 500);
  EXPECT_NEAR(solid.parameters(1, 0) / solid.parameters(0, 0), 10, 1e-12);
}

TEST_F(ReduceCommandTest, BlamesTheLawOnWhoNamedIt) {
  write("materials.json", R"({"young": "1 MPa"})");
  const Outcome typed = supple(small({"--material", "gum", "--materials", "materials.json"}));
  EXPECT_EQ(typed.exit_code, 2);
  EXPECT_THAT(typed.err, HasSubstr("--material: material law 'gum'"));
  EXPECT_THAT(typed.err, testing::Not(HasSubstr("materials.json")));
  write("materials.json", R"({"law": "gum"})");
  expect_refusal(small({"--material", "ogden", "--materials", "materials.json"}), {"materials.json", "'gum'"});
}

TEST_F(ReduceCommandTest, TakesLawsAndTheirParametersByName) {
  std::map<std::string, json> reports;
  for (const std::string law : {"neo-hookean", "stable-neo-hookean", "corotational", "ogden", "fung"})
    reports[law] = report(small({"--material", law}));
  for (const auto& [law, report] : reports) EXPECT_LT(report["training_error"], 0.5) << law;
  // at rest all but the last, which has fibres, are the same linear elasticity
  const double softest = reports["ogden"]["eigenvalues"]["exact"][0];
  for (const auto& [law, report] : reports)
    if (law != "fung") {
      EXPECT_NEAR(report["eigenvalues"]["exact"][0].get<double>() / softest, 1, 1e-6) << law;
    }
  const json twice = report(small({"--material", "neo-hookean", "--young", "2e5"}));
  const json named = report(small({"--material", "neo-hookean", "--parameter", "mu=71428.571428571435", "--parameter",
                                   "lambda=285714.28571428580"}));  // of 2e5 Pa and 0.4
  EXPECT_NEAR(named["eigenvalues"]["exact"][0].get<double>() / twice["eigenvalues"]["exact"][0].get<double>(), 1, 1e-6);
  write("law.json",
        R"({"law": "neo-hookean", "parameters": {"mu": 71428.571428571435, "lambda": 285714.28571428580}})");
  const json from_file = report(small({"--materials", "law.json"}));
  EXPECT_EQ(from_file["eigenvalues"]["exact"], named["eigenvalues"]["exact"]);
}

TEST_F(ReduceCommandTest, RefusesLawsAndParametersThatThereAreNot) {
  expect_refusal(small({"--material", "rubber"}), {"'rubber'", "stable-neo-hookean"});
  expect_refusal(small({"--parameter", "nu=1"}), {"stvk", "'nu'", "lambda, mu"});
  expect_refusal(small({"--parameter", "mu"}), {"--parameter 'mu'", "NAME=VALUE"});
  expect_refusal(small({"--parameter", "mu=stiff"}), {"--parameter mu", "stiff"});
  expect_refusal(small({"--parameter", "mu=1", "--parameter", "mu=2"}), {"mu", "twice"});
  write("law.json", R"({"law": "ogden", "parameters": {"mu9": 1}})");
  expect_refusal(small({"--materials", "law.json"}), {"law.json", "mu9"});
  write("law.json", R"({"law": "gum"})");
  expect_refusal(small({"--materials", "law.json"}), {"'gum'"});
  EXPECT_FALSE(std::filesystem::exists(folder / "bar.supple"));
}

#ifdef SUPPLE_PLUGINS
TEST_F(ReduceCommandTest, LoadsMaterialsOfOnesOwn) {
  const std::string plugin = SUPPLE_PLUGINS "/libgent_plugin.so";
  const json gent = report(small({"--plugin", plugin, "--material", "gent", "--parameter", "limit=5"}));
  EXPECT_LT(gent["training_error"], 0.5);
  EXPECT_THAT(report({"info", "bar.supple", "--plugin", plugin}).dump(), HasSubstr("gent"));
  expect_refusal({"info", "bar.supple"}, {"bar.supple", "'gent'", "--plugin"});
  expect_refusal({"simulate", "bar.supple"}, {"bar.supple", "'gent'"});
  EXPECT_GT(report({"simulate", "bar.supple", "--plugin", plugin, "--time", "0.1"})["steps"], 0);
  const json springs =
      report(small({"--plugin", SUPPLE_PLUGINS "/libspring_tets_plugin.so", "--material", "spring-tets"}));
  EXPECT_LT(springs["training_error"], 0.5);
  expect_refusal(
      cells("hexbox:6x2x2", {"--plugin", SUPPLE_PLUGINS "/libspring_tets_plugin.so", "--material", "spring-tets"}),
      {"spring-tets", "hexahedra"});
  EXPECT_LT(report(cells("hexbox:6x2x2", {"--plugin", plugin, "--material", "gent"}))["training_error"], 0.5);
  expect_refusal(small({"--plugin", SUPPLE_PLUGINS "/libspring_tets_plugin.so", "--material", "spring-tets",
                        "--parameter", "modulus=-1"}),
                 {"spring-tets", "not positive"});
  expect_refusal(small({"--plugin", "nowhere.so"}), {"nowhere.so", "no such file"});
  expect_refusal(small({"--plugin", SUPPLE_PLUGINS "/libno_plugin.so"}), {"libno_plugin.so", "not a plug-in"});
}
#endif

}  // namespace

}  // namespace supple::test
