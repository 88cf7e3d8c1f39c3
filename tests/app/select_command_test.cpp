#include <core/random.hpp>
#include <sparse/selectors/selector_library.hpp>
#include <tests/app/supple_process.hpp>
#include <tests/sparse/problems.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace supple::test {

namespace {

using nlohmann::json;
using ::testing::HasSubstr;

/// A small problem in files: A.npy with 60 × 40 numbers, b.npy near the sum of its columns.
class SelectCommandTest : public SuppleProcess {
 protected:
  SelectCommandTest() {
    A = uniform(60, 40, 1);
    b = A.rowwise().sum() + 0.3 * gaussian(60, 1, 2);
    write_npy("A.npy", A);
    write_npy("b.npy", b);
  }

  void write_npy(const std::string& name, const Matrix& values) const {
    std::string header = "{'descr': '<f8', 'fortran_order': True, 'shape': (" + std::to_string(values.rows()) + ", " +
                         std::to_string(values.cols()) + "), }";
    header.resize(117, ' ');
    header += '\n';
    std::string bytes = "\x93NUMPY" + std::string{1, 0, static_cast<char>(header.size()), 0} + header;
    bytes.append(reinterpret_cast<const char*>(values.data()),
                 sizeof(double) * static_cast<std::size_t>(values.size()));
    write(name, bytes);
  }

  static Arguments with(Arguments arguments, const Arguments& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// On A.npy and b.npy.
  static Arguments job(const Arguments& more = {}) {
    return with({"select", "--matrix", "A.npy", "--rhs", "b.npy"}, more);
  }

  static std::vector<Index> indices(const json& report) { return report["indices"]; }
  static Vector weights(const json& report) {
    const std::vector<double> w = report["weights"];
    return Eigen::Map<const Vector>(w.data(), static_cast<Index>(w.size()));
  }
  static Vector residual(const json& report, const Matrix& A, const Vector& b) {
    return A(Eigen::all, indices(report)) * weights(report) - b;
  }

  Matrix A;
  Vector b;
};

TEST_F(SelectCommandTest, FindsPlantedColumnsAndWeights) {
  const std::vector<Index> planted = random_subset(120, 8, 3);
  const Matrix G = gaussian(80, 120, 4);
  const Vector w = planted_weights(120, planted, 5);
  write_npy("G.npy", G);
  write_npy("g.npy", G * w);
  const json found = report({"select", "--matrix", "G.npy", "--rhs", "g.npy", "--points", "8", "--seed", "1"});
  EXPECT_EQ(indices(found), planted);
  EXPECT_LT((weights(found) - w(planted)).norm(), 1e-8);
  EXPECT_EQ(found["status"], "converged");
  EXPECT_EQ(found["selector"], known_selectors().front());
  EXPECT_EQ(found["rows"], 80);
  EXPECT_EQ(found["columns"], 120);
}

TEST_F(SelectCommandTest, StatesForEverySelectorTheErrorOfItsWeights) {
  for (const std::string& selector : known_selectors()) {
    const Arguments size = selector == "all" ? Arguments{} : Arguments{"--points", "10"};
    const json found = report(job(with(size, {"--selector", selector, "--seed", "3"})));
    const Vector w = weights(found), r = residual(found, A, b);
    ASSERT_GT(w.size(), 0) << selector;
    EXPECT_EQ(found["selector"], selector);
    EXPECT_EQ(found["seed"], 3);
    EXPECT_EQ(found["points"], w.size());
    EXPECT_LE(w.size(), selector == "all" ? 40 : 10) << selector;
    EXPECT_NEAR(found["residual"].get<double>(), r.norm(), 1e-10 * r.norm()) << selector;
    EXPECT_NEAR(found["training_error"].get<double>(), r.norm() / b.norm(), 1e-10) << selector;
    EXPECT_LT(found["training_error"], 0.5) << selector;
    if (selector != "htp" && selector != "niht") {
      EXPECT_GT(w.minCoeff(), 0) << selector;
    }
    if (!selector.ends_with("niht")) {
      EXPECT_LT(found["kkt_residual"], 1e-10) << selector;
    }
    EXPECT_GE(found["seconds"], 0) << selector;
    EXPECT_GE(found["total_seconds"], found["seconds"]) << selector;
    EXPECT_THAT(found["status"].get<std::string>(), ::testing::AnyOf("converged", "max-iterations", "stagnated"));
    for (const char* key : {"iterations", "columns_evaluated", "peak_memory"})
      EXPECT_GT(found[key], 0) << key << selector;
    EXPECT_FALSE(found["history"].empty()) << selector;
    EXPECT_FALSE(found["stop_reason"].get<std::string>().empty()) << selector;
    EXPECT_TRUE(found["held_out_error"].is_null()) << selector;
  }
}

TEST_F(SelectCommandTest, FitsTheSumOfAllColumnsWithoutARightHandSide) {
  write_npy("sum.npy", A.rowwise().sum());
  const json with_sum = report({"select", "--matrix", "A.npy", "--rhs", "sum.npy", "--points", "12"}),
             without = report({"select", "--matrix", "A.npy", "--points", "12"});
  EXPECT_EQ(without["indices"], with_sum["indices"]);
  EXPECT_EQ(without["weights"], with_sum["weights"]);
  EXPECT_TRUE(without["rhs"].is_null());
  EXPECT_NEAR(weights(without).sum(), 40, 4);
}

TEST_F(SelectCommandTest, ReadsMatrixMarketFilesAlike) {
  std::string a_text = "%%MatrixMarket matrix coordinate real general\n60 40 2400\n",
              b_text = "%%MatrixMarket matrix array real general\n60 1\n";
  char line[80];
  for (Index i = 0; i < 60; ++i) {
    for (Index j = 0; j < 40; ++j) {
      std::snprintf(line, sizeof line, "%d %d %.17g\n", static_cast<int>(i + 1), static_cast<int>(j + 1), A(i, j));
      a_text += line;
    }
    std::snprintf(line, sizeof line, "%.17g\n", b[i]);
    b_text += line;
  }
  write("A.mtx", a_text);
  write("b.mtx", b_text);
  const json npy = report(job({"--points", "10"})),
             mtx = report({"select", "--matrix", "A.mtx", "--rhs", "b.mtx", "--points", "10"});
  EXPECT_EQ(mtx["indices"], npy["indices"]);
  EXPECT_EQ(mtx["weights"], npy["weights"]);
}

TEST_F(SelectCommandTest, KeepsWhatMustBeKeptAndChoosesAmongCandidates) {
  A.col(7) = -A.col(7);  // of no use
  write_npy("A.npy", A);
  write("keep.txt", "# of no use\n7\n30\n");
  write("even.txt", "0\n2\n4\n6\n8\n10\n12\n14\n16\n18\n20\n");
  for (const std::string& selector : known_selectors()) {
    const Arguments size = selector == "all" ? Arguments{} : Arguments{"--points", "6"};
    const json found =
        report(job(with(size, {"--selector", selector, "--must-keep", "keep.txt", "--candidates", "even.txt"})));
    EXPECT_THAT(indices(found), ::testing::IsSupersetOf({7, 30})) << selector;
    for (const Index j : indices(found)) EXPECT_TRUE(j == 7 || j == 30 || (j % 2 == 0 && j <= 20)) << selector << j;
    EXPECT_GT(found["points"], 2) << selector;
  }
  const json kept = report(job({"--must-keep", "keep.txt", "--points", "5"}));
  EXPECT_EQ(kept["weights"][std::find(kept["indices"].begin(), kept["indices"].end(), 7) - kept["indices"].begin()], 0);
}

TEST_F(SelectCommandTest, ImprovesAnEarlierAnswer) {
  ASSERT_EQ(supple(job({"--points", "12", "--selector", "ecsw", "--json", "before.json"})).exit_code, 0);
  const json before = json::parse(read("before.json"));
  for (const char* selector : {"nn-sp", "nn-htp", "greedy", "nn-omp", "nn-niht"}) {
    const json after = report(job({"--points", "12", "--selector", selector, "--warm-start", "before.json"}));
    EXPECT_LE(after["training_error"], before["training_error"].get<double>() * (1 + 1e-12)) << selector;
    EXPECT_EQ(
        after["history"][0]["training_error"].get<double>() <= before["training_error"].get<double>() * (1 + 1e-9),
        true)
        << selector;
  }
}

TEST_F(SelectCommandTest, TakesAsFewColumnsAsReachATargetError) {
  const json alone = report(job({"--target-error", "0.05"})),
             within = report(job({"--target-error", "0.05", "--points", "30"}));
  for (const json& found : {alone, within}) {
    EXPECT_LE(found["training_error"], 0.05);
    EXPECT_EQ(found["status"], "converged");
    EXPECT_LT(found["points"], 30);
  }
  const Index fewer = alone["points"].get<Index>() - 3;
  ASSERT_GE(fewer, 1);
  EXPECT_GT(report(job({"--points", std::to_string(fewer)}))["training_error"], 0.05);

  const Outcome missed = supple(job({"--target-error", "1e-6", "--points", "5", "--json", "-"}));
  EXPECT_EQ(missed.exit_code, 0);
  EXPECT_THAT(missed.err, HasSubstr("allow more --points than 5"));
  EXPECT_EQ(missed.json()["status"], "stagnated");
  EXPECT_EQ(missed.json()["points"], 5);
}

TEST_F(SelectCommandTest, MeasuresTheErrorOnHeldOutRows) {
  const Matrix A_held = uniform(25, 40, 9);
  const Vector b_held = A_held.rowwise().sum();
  write_npy("A_held.npy", A_held);
  write_npy("b_held.npy", b_held);
  const json found = report(job({"--points", "10", "--validate-matrix", "A_held.npy", "--validate-rhs", "b_held.npy"}));
  const double expected = residual(found, A_held, b_held).norm() / b_held.norm();
  EXPECT_NEAR(found["held_out_error"].get<double>(), expected, 1e-12);
  for (const json& step : found["history"]) EXPECT_TRUE(step["held_out_error"].is_number());
  const json sums = report({"select", "--matrix", "A.npy", "--points", "10", "--validate-matrix", "A_held.npy"});
  EXPECT_NEAR(sums["held_out_error"].get<double>(), residual(sums, A_held, b_held).norm() / b_held.norm(), 1e-12);
}

TEST_F(SelectCommandTest, TrainsGreedyOnGroupsOfRows) {
  const Arguments grouped = job({"--points", "10", "--selector", "greedy", "--group-size", "6", "--train-groups", "2"});
  const json some = report(grouped), again = report(grouped),
             all = report(job({"--points", "10", "--selector", "greedy"}));
  EXPECT_EQ(some["weights"], again["weights"]);
  EXPECT_NE(some["indices"], all["indices"]);
  const Vector r = residual(some, A, b);  // of all rows
  EXPECT_NEAR(some["residual"].get<double>(), r.norm(), 1e-10 * r.norm());
}

TEST_F(SelectCommandTest, DependsOnTheSeedAndNotOnThreads) {
  json first = report(job({"--points", "10", "--threads", "1"})),
       second = report(job({"--points", "10", "--threads", "3"}));
  EXPECT_EQ(first["weights"], second["weights"]);
  EXPECT_EQ(first["indices"], second["indices"]);
  EXPECT_NE(report(job({"--points", "10", "--selector", "random", "--seed", "2"}))["indices"],
            report(job({"--points", "10", "--selector", "random", "--seed", "3"}))["indices"]);
}

TEST_F(SelectCommandTest, PrintsATableUnlessTheReportTakesItsPlace) {
  const Outcome outcome = supple(job({"--points", "10", "--json", "report.json"}));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_EQ(outcome.err, "");
  for (const char* row :
       {"selection from A.npy", "60 rows, 40 columns", "10 columns", "training error", "residual", "total"})
    EXPECT_THAT(outcome.out, HasSubstr(row));
  EXPECT_EQ(json::parse(read("report.json"))["points"], 10);
  EXPECT_EQ(files(), (std::vector<std::string>{"A.npy", "b.npy", "report.json"}));
  EXPECT_EQ(report(job({"--points", "200"}))["points"].get<Index>() <= 40, true);  // at most
}

TEST_F(SelectCommandTest, RefusesBadInputInOneLineAndLeavesNothing) {
  const Arguments ten{"--points", "10"};
  expect_refusal({"select", "--points", "10"}, {"--matrix"});
  expect_refusal({"select", "--matrix", "none.npy", "--points", "10"}, {"none.npy", "cannot be read"});
  expect_refusal({"select", "--matrix", "A.npy", "--rhs", "none.npy", "--points", "10"}, {"none.npy"});
  expect_refusal(job(), {"--points", "--target-error"});
  expect_refusal(job({"--points", "0"}), {"--points"});
  expect_refusal(job({"--points", "-3"}), {"--points"});
  expect_refusal(job({"--points", "many"}), {"--points", "many"});
  expect_refusal(job({"--points", "5000000000000000000000"}), {"--points", "no whole number"});
  expect_refusal(job(with(ten, {"--seed", "-1"})), {"--seed", "-1"});
  expect_refusal(job({"--target-error", "0"}), {"--target-error"});
  expect_refusal(job({"--target-error", "nan"}), {"--target-error", "nan"});
  expect_refusal(job(with(ten, {"--selector", "best"})), {"--selector", "best", "nn-sp"});
  expect_refusal(job(with(ten, {"--selector", "all"})), {"all 40 candidates", "--points 10"});
  expect_refusal(job(with(ten, {"--candidate", "x"})), {"'--candidate'", "--candidates"});
  expect_refusal(job(with(ten, {"--json", "nowhere/report.json"})), {"nowhere"});
  expect_refusal(job(with(ten, {"--group-size", "7"})), {"A.npy: has 60 rows", "--group-size 7"});
  expect_refusal(job(with(ten, {"--train-groups", "2"})), {"--train-groups", "greedy"});

  write("list.txt", "0\n40\n");
  expect_refusal(job(with(ten, {"--candidates", "list.txt"})), {"list.txt:2: column 40 does not exist", "0 … 39"});
  expect_refusal(job(with(ten, {"--must-keep", "list.txt"})), {"list.txt:2"});
  write("list.txt", "1\n2\nthree\n");
  expect_refusal(job(with(ten, {"--must-keep", "list.txt"})), {"list.txt:3: expected a column index"});
  write("list.txt", "1\n2\n3\n");
  expect_refusal(job({"--points", "2", "--must-keep", "list.txt"}), {"list.txt", "3 columns", "--points 2"});
  write("list.txt", "# none\n");
  expect_refusal(job(with(ten, {"--candidates", "list.txt"})), {"list.txt", "names no column"});

  write("old.json", R"({"indices": [1, 40], "weights": [1, 2]})");
  expect_refusal(job(with(ten, {"--warm-start", "old.json"})), {"old.json: /indices/1 is 40"});
  write("old.json", R"({"indices": [1, 2], "weights": [1]})");
  expect_refusal(job(with(ten, {"--warm-start", "old.json"})), {"old.json: /weights"});
  write("old.json", R"({"indices": [3, 3], "weights": [1, 1]})");
  expect_refusal(job(with(ten, {"--warm-start", "old.json"})), {"old.json: /indices", "3 twice"});
  write("old.json", R"({"weights": [1]})");
  expect_refusal(job(with(ten, {"--warm-start", "old.json"})), {"old.json: /indices is missing"});

  expect_refusal(job(with(ten, {"--validate-rhs", "b.npy"})), {"--validate-matrix"});
  expect_refusal(job(with(ten, {"--validate-matrix", "A.npy"})), {"--validate-rhs"});
  write_npy("narrow.npy", A.leftCols(3));
  expect_refusal(job(with(ten, {"--validate-matrix", "narrow.npy", "--validate-rhs", "b.npy"})),
                 {"narrow.npy: has 3 columns, expected 40"});
  write_npy("short.npy", b.head(59));
  expect_refusal({"select", "--matrix", "A.npy", "--rhs", "short.npy", "--points", "10"},
                 {"short.npy: has 59 numbers, expected 60", "A.npy"});
  expect_refusal({"select", "--matrix", "A.npy", "--rhs", "A.npy", "--points", "10"}, {"expected a vector"});
  A(4, 5) = std::nan("");
  write_npy("bad.npy", A);
  expect_refusal({"select", "--matrix", "bad.npy", "--points", "10"}, {"bad.npy", "row 4, column 5", "nan"});
  b[17] = INFINITY;
  write_npy("bad.npy", b);
  expect_refusal({"select", "--matrix", "A.npy", "--rhs", "bad.npy", "--points", "10"}, {"bad.npy", "row 17", "inf"});
  write("bad.npy", read("A.npy").substr(0, 5000));
  expect_refusal({"select", "--matrix", "bad.npy", "--points", "10"}, {"bad.npy, byte 128: the file ends before"});

  EXPECT_EQ(files(),
            (std::vector<std::string>{"A.npy", "b.npy", "bad.npy", "list.txt", "narrow.npy", "old.json", "short.npy"}));
}

TEST_F(SelectCommandTest, RefusesUnitsInWhichSquaresAreNoNumbers) {
  for (const double unit : {1e-200, 1e160, 1e300}) {
    write_npy("units.npy", unit * A);
    expect_refusal({"select", "--matrix", "units.npy", "--rhs", "b.npy", "--points", "10"},
                   {"units.npy: the largest number is", "from 1e-140 to 1e140"});
    write_npy("units.npy", unit * b);
    expect_refusal({"select", "--matrix", "A.npy", "--rhs", "units.npy", "--points", "10"},
                   {"units.npy: the largest number is", "from 1e-140 to 1e140"});
  }
}

TEST_F(SelectCommandTest, SaysSoWhereStdoutIsFull) {
  for (const char* points : {"1", "40"}) {  // less and more than a buffer holds
    const Outcome outcome = run_supple_on_full_disk(job({"--points", points, "--json", "-"}), folder);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("stdout cannot be written"));
  }
}

TEST_F(SelectCommandTest, LeavesNothingWhenASignalEndsIt) {
  write_npy("large.npy", uniform(800, 4000, 1));
  const Outcome outcome = run_supple_until_signal(
      {"select", "--matrix", "large.npy", "--points", "600", "--selector", "nn-omp", "--json", "report.json"}, folder,
      SIGINT, std::chrono::milliseconds(300));
  EXPECT_EQ(outcome.exit_code, 128 + SIGINT);
  EXPECT_EQ(files(), (std::vector<std::string>{"A.npy", "b.npy", "large.npy"}));
}

}  // namespace

}  // namespace supple::test
