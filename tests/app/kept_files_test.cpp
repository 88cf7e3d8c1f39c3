/// \file Nothing is lost: whatever stops a command, a kill, a full disk or a folder that cannot be written to, its files are the
/// old ones or the new ones, each complete.

#include <core/output_file.hpp>
#include <core/random.hpp>
#include <core/stopwatch.hpp>
#include <core/tensor_file.hpp>
#include <tests/app/supple_process.hpp>
#include <tests/support/long_run.hpp>

#include <gmock/gmock.h>

#include <csignal>
#include <map>
#include <unistd.h>

namespace supple::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::StartsWith;

Arguments reduced_bar(const std::string& young, const std::string& output) {
  return {"reduce",       "bar:3x1x1", "-o",           output, "--fix",    "x<=0",     "--modes",    "3",
          "--poses",      "10",        "--points",     "18",   "--recipe", "subspace", "--held-out", "0",
          "--full-loads", "0",         "--equilibria", "0",    "--young",  young};
}
Arguments simulated_bar(const std::string& time, const std::string& output) {
  return {"simulate", "bar.supple", "--time", time, "--step", "0.01", "--every", "2", "-o", output};
}

class KeptFiles : public SuppleProcess {
 protected:
  void run(const Arguments& arguments) const {
    const Outcome outcome = supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }

  double seconds_of(const Arguments& arguments) const {
    const Stopwatch watch;
    run(arguments);
    return watch.seconds();
  }

  /// Kills the command at a random moment: of its whole run, or while it writes.
  void kill(const Arguments& arguments, double seconds, Random& random) const {
    if (random.below(2) == 0)
      (void)run_supple_until_signal_while_writing(arguments, folder, SIGKILL);
    else
      (void)run_supple_until_signal(arguments, folder, SIGKILL,
                                    std::chrono::microseconds(static_cast<Index>(1.1e6 * seconds * random.uniform())));
  }

  /// Takes the temporary files away, which must be hidden. \return the others below a folder, by name.
  std::map<std::string, std::string> contents(const fs::path& of) const {
    std::map<std::string, std::string> result;
    std::vector<fs::path> temporary;
    if (fs::exists(folder / of))
      for (const auto& entry : fs::recursive_directory_iterator(folder / of)) {
        const std::string name = entry.path().filename().string();
        if (entry.path().extension() == ".tmp") {
          EXPECT_THAT(name, StartsWith("."));
          temporary.push_back(entry.path());
        } else {
          result[name] = read_file(entry.path());
        }
      }
    for (const fs::path& path : temporary) fs::remove(path);
    return result;
  }
  void restore(const fs::path& to, const std::map<std::string, std::string>& files) const {
    fs::remove_all(folder / to);
    if (!files.empty()) fs::create_directories(folder / to);
    for (const auto& [name, bytes] : files) write((to / name).string(), bytes);
  }
};

TEST_F(KeptFiles, AKilledReductionLeavesTheOldModelOrTheNewOne) {
  fs::create_directories(folder / "out");
  const Arguments command = reduced_bar("2e5", "out/bar.supple");
  run(reduced_bar("1e5", "out/bar.supple"));
  const auto old_files = contents("out");
  const double seconds = seconds_of(command);
  const auto new_files = contents("out");
  ASSERT_NE(old_files, new_files);

  Random random(1);
  std::map<std::string, int> count;
  for (int k = 0, trials = repetitions(12, 500); k < trials; ++k) {
    const bool is_first = k % 3 == 0;
    restore("out", is_first ? std::map<std::string, std::string>{} : old_files);
    fs::create_directories(folder / "out");
    kill(command, seconds, random);
    if (k % 4 == 0) run({"info", "bar:1x1x1"});  // beside what the killed one left
    const auto now = contents("out");
    ++count[now == new_files ? "new" : now == old_files ? "old" : "none"];
    ASSERT_TRUE(now == new_files || now == (is_first ? std::map<std::string, std::string>{} : old_files))
        << "kill " << k;
    if (k % 10 == 0) {
      run(command);
      ASSERT_EQ(contents("out"), new_files);
    }
  }
  for (const auto& [what, times] : count) RecordProperty(what, times);
  EXPECT_GT(count["old"] + count["none"], 0);
}

/// What differs from run to run: times.
bool is_timed(const std::string& name) {
  return name == "report.json" || name == "trajectory.safetensors";
}

TEST_F(KeptFiles, AKilledSimulationLeavesCompleteFiles) {
  run(reduced_bar("1e5", "bar.supple"));
  const Arguments command = simulated_bar("0.2", "run");
  run(simulated_bar("0.1", "run"));
  const auto old_files = contents("run");
  const double seconds = seconds_of(command);
  const auto new_files = contents("run");
  ASSERT_GT(new_files.size(), old_files.size());

  Random random(2);
  for (int k = 0, trials = repetitions(12, 500); k < trials; ++k) {
    restore("run", k % 3 == 0 ? std::map<std::string, std::string>{} : old_files);
    kill(command, seconds, random);
    for (const auto& [name, bytes] : contents("run")) {
      SCOPED_TRACE(name);
      const auto was = old_files.find(name), is = new_files.find(name);
      if (name == "report.json") {
        ASSERT_TRUE(nlohmann::json::accept(bytes));
      } else if (name == "trajectory.safetensors") {
        ASSERT_NO_THROW(TensorFile(folder / "run" / name));  // with all checksums
      } else if (name == "series.pvd") {                     // lists the frames that there are
        ASSERT_THAT(bytes, testing::EndsWith("</Collection>\n</VTKFile>\n"));
      } else {
        ASSERT_TRUE((is != new_files.end() && bytes == is->second) || (was != old_files.end() && bytes == was->second))
            << "kill " << k;
      }
    }
    if (k % 10 == 0) {
      run(command);
      for (const auto& [name, bytes] : contents("run"))
        ASSERT_TRUE(is_timed(name) || bytes == new_files.at(name)) << name;
    }
  }
}

/// All commands that write, with what they write to first.
struct Command {
  std::string file;
  Arguments arguments;
};

class FailedWriting : public KeptFiles {
 protected:
  /// The folder with a model, a scene and two runs.
  void prepare() const {
    run(reduced_bar("1e5", "bar.supple"));
    run(simulated_bar("0.1", "a"));
    run(simulated_bar("0.2", "b"));
    write("edit.json", R"({"handles": [{"name": "tip", "nodes": "x>90%"}],
      "edits": [{"moves": [{"handle": "tip", "translation": ["1 cm", 0, 0]}]}]})");
    write("A.mtx", "%%MatrixMarket matrix array real general\n3 3\n1\n2\n3\n4\n5\n7\n1\n0\n2\n");
  }

  /// \param output  a file or folder that each command is to write, "PLACE" in its arguments.
  static std::vector<Command> commands(const std::string& place) {
    return {{place + "model.supple", reduced_bar("1e5", place + "model.supple")},
            {place + "report.json", {"info", "bar.supple", "--json", place + "report.json"}},
            {place + "mesh.vtu", {"mesh", "bar:20x8x8", "-o", place + "mesh.vtu"}},
            {place + "report.json", {"select", "--matrix", "A.mtx", "--points", "2", "--json", place + "report.json"}},
            {place + "run", simulated_bar("0.1", place + "run")},
            {place + "bent", {"edit", "bar.supple", "--scene", "edit.json", "-o", place + "bent"}},
            {place + "difference", {"compare", "a", "b", "-o", place + "difference"}}};
  }
  static void expect_one_line(const Outcome& outcome, const std::string& part) {
    EXPECT_GT(outcome.exit_code, 0);
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    EXPECT_THAT(outcome.err, StartsWith("supple: "));
    EXPECT_THAT(outcome.err, HasSubstr(part));
  }
};

TEST_F(FailedWriting, OnAFullDiskSaysWhyAndKeepsTheOldFiles) {
  prepare();
  for (const auto& [file, arguments] : commands("")) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    const std::string old = "what stood here before";
    const bool is_file = fs::path(file).has_extension();
    if (is_file) write(file, old);
    const std::vector<std::string> before = files();
    const Outcome outcome = run_supple_with_largest_file(arguments, folder, 100);
    expect_one_line(outcome, "File too large");
    expect_one_line(outcome, fs::path(file).stem().string());
    EXPECT_EQ(files(), before);  // a folder that was made is gone, too
    if (is_file) {
      EXPECT_EQ(read(file), old);
    }
    fs::remove_all(folder / file);
  }
}

TEST_F(FailedWriting, OnADiskThatFillsLeavesWholeFilesOnly) {
  prepare();
  run(simulated_bar("0.1", "run"));
  const auto whole = contents("run");
  for (const std::size_t bytes : {1000, 5000, 20000}) {
    for (const bool is_first : {true, false}) {
      restore("run", is_first ? std::map<std::string, std::string>{} : contents("b"));
      const auto old_files = contents("run");
      const Outcome outcome = run_supple_with_largest_file(simulated_bar("0.1", "run"), folder, bytes);
      expect_one_line(outcome, "File too large");
      for (const auto& [name, now] : contents("run")) {
        EXPECT_FALSE(name.ends_with(".tmp"));
        if (is_timed(name) || name == "series.pvd") continue;
        const auto was = old_files.find(name), is = whole.find(name);
        EXPECT_TRUE((is != whole.end() && now == is->second) || (was != old_files.end() && now == was->second)) << name;
      }
    }
  }
}

TEST_F(FailedWriting, WhereNoFolderCanBeSaysWhy) {
  prepare();
  write("file", "no folder");
  const std::vector<std::string> before = files();
  for (const auto& [file, arguments] : commands("file/")) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    expect_one_line(supple(arguments), file);
    EXPECT_EQ(files(), before);
    EXPECT_EQ(read("file"), "no folder");
  }
}

TEST_F(FailedWriting, InAFolderThatIsNotOpenForWritingSaysWhy) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  prepare();
  fs::create_directories(folder / "closed");
  fs::permissions(folder / "closed", fs::perms::owner_read | fs::perms::owner_exec);
  for (const auto& [file, arguments] : commands("closed/")) {
    SCOPED_TRACE(testing::PrintToString(arguments));
    expect_one_line(supple(arguments), "closed");
    EXPECT_TRUE(fs::is_empty(folder / "closed"));
  }
  fs::permissions(folder / "closed", fs::perms::owner_all);
}

TEST_F(FailedWriting, ToAStreamThatTakesNothingSaysSo) {
  prepare();
  for (const Arguments& arguments : std::vector<Arguments>{
           {"info", "bar.supple"}, {"info", "bar.supple", "--json", "-"}, {"compare", "a", "b"}, {"--help"}})
    expect_one_line(run_supple_on_full_disk(arguments, folder), "stdout cannot be written");
  expect_one_line(supple({"info", "bar.supple", "--json", "/dev/full"}), "No space left on device");
}

}  // namespace
}  // namespace supple::test
