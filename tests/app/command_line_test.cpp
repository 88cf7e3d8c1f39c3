#include <tests/app/supple_process.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <sys/stat.h>

namespace supple::test {

namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

using CommandLineTest = SuppleProcess;

TEST_F(CommandLineTest, ExplainsItself) {
  for (const Arguments& arguments :
       {Arguments{"--help"}, Arguments{"reduce", "--help"}, Arguments{"simulate", "--help"},
        Arguments{"compare", "--help"}, Arguments{"select", "--help"}, Arguments{"info", "--help"},
        Arguments{"mesh", "--help"}, Arguments{"pareto", "--help"}}) {
    const Outcome outcome = supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_THAT(outcome.out, HasSubstr("Usage: supple"));
  }
  EXPECT_THAT(supple({"reduce", "--help"}).out, HasSubstr("octopus"));
  const Outcome version = supple({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out.rfind("supple ", 0), 0u);
}

/// The lines of the README that call the command, as words without the call itself.
std::vector<Arguments> commands_of_readme() {
  const std::string call = "build/release/app/supple ";
  std::vector<Arguments> commands;
  std::ifstream readme(SUPPLE_README);
  for (std::string line; std::getline(readme, line);) {
    if (line.rfind(call, 0) != 0) continue;
    std::istringstream words(line.substr(call.size(), line.find(" #") - call.size()));
    Arguments& arguments = commands.emplace_back();
    for (std::string word; words >> std::quoted(word, '\'');) arguments.push_back(word);
  }
  return commands;
}

TEST_F(CommandLineTest, DoesWhatTheReadmeShows) {
  const std::vector<Arguments> commands = commands_of_readme();
  ASSERT_GE(commands.size(), 9u);
  for (Arguments command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto file = std::ranges::find_if(command, [](const std::string& word) {
      return word.ends_with(".msh") || word.ends_with(".off") || word.ends_with(".supple") || word.ends_with(".npy");
    });
    ASSERT_NE(file, command.end());
    if (command[1].find(':') == std::string::npos) {
      expect_refusal(command, {*file, "o such file"});  // the file is the only thing that it misses
    } else {
      command.insert(command.end(), {"--poses", "15", "--equilibria", "0", "--held-out", "0"});  // which take long
      const Outcome outcome = supple(command);
      EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
      EXPECT_TRUE(std::filesystem::exists(folder / *file));
    }
  }
}

TEST_F(CommandLineTest, RefusesWhatItDoesNotKnow) {
  expect_refusal({}, {"subcommand"});
  expect_refusal({"reduse"}, {"'reduse'", "reduce"});
  expect_refusal({"reduce", "cube:2", "-o", "m", "--mode", "3"}, {"'--mode'", "--modes"});
  expect_refusal({"reduce", "cube:2", "-o", "m", "--modes", "few"}, {"--modes", "few"});
  expect_refusal({"info"}, {"SOURCE"});
  expect_refusal({"info", "nothing"}, {"nothing"});
  expect_refusal({"compare", "one"}, {"REFERENCE"});
  expect_refusal({"compare", "one", "two"}, {"one"});
  expect_refusal({"simulate", "nothing.supple"}, {"nothing.supple"});
}

TEST_F(CommandLineTest, IsQuietInPipesAndShowsProgressOnATerminal) {
  const Arguments job{"reduce",  "bar:8x2x2", "-o",      "bar.supple", "--fix",    "x<=0",
                      "--modes", "4",         "--poses", "20",         "--points", "20"};
  const Outcome piped = supple(job), terminal = run_supple_on_terminal(job, folder);
  EXPECT_EQ(piped.exit_code, 0);
  EXPECT_EQ(piped.err, "");
  EXPECT_THAT(piped.out, HasSubstr("total"));
  EXPECT_EQ(terminal.exit_code, 0);
  EXPECT_THAT(terminal.err, HasSubstr("%"));
  EXPECT_EQ(terminal.err.substr(terminal.err.size() - 4), "\r\033[K");  // nothing is left of it
  EXPECT_THAT(terminal.out, HasSubstr("total"));
}

TEST_F(CommandLineTest, EndsOnASignalWithoutPartialFiles) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const Outcome outcome = run_supple_until_signal(
        {"reduce", "bar:60x20x20", "-o", "bar.supple", "--picture", "bar.png"}, folder, signal, 300ms);
    EXPECT_EQ(outcome.exit_code, 128 + signal);
    EXPECT_TRUE(files().empty()) << files().front();
  }
}

TEST_F(CommandLineTest, FinishesTheFileThatASignalFindsItWriting) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Outcome outcome =
        run_supple_until_signal_while_writing({"mesh", "bar:60x30x30", "-o", "bar.vtu"}, folder, signal);
    EXPECT_EQ(outcome.exit_code, 128 + signal);  // by itself, not killed
    EXPECT_EQ(files(), std::vector<std::string>{"bar.vtu"});
    EXPECT_EQ(report({"info", "bar.vtu"})["tets"], 6 * 60 * 30 * 30);
    std::filesystem::remove(folder / "bar.vtu");
  }
}

TEST_F(CommandLineTest, EndsOnASignalWhileNobodyReadsItsReport) {
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  const Outcome outcome = run_supple_until_signal({"info", "bar:4x2x2", "--json", "pipe"}, folder, SIGTERM, 500ms);
  EXPECT_EQ(outcome.exit_code, 128 + SIGTERM);
}

TEST_F(CommandLineTest, AddsToTheFilesItsOwnStreamsGoTo) {
  write("log", "old\n");
  const std::string command =
      std::string("cd ") + folder.string() + " && " + SUPPLE_COMMAND + " info bar:4x2x2 --json ";
  ASSERT_EQ(std::system((command + "/dev/stdout >> log").c_str()), 0);
  EXPECT_EQ(nlohmann::json::parse(read("log").substr(4))["tets"], 96);  // and no text
  EXPECT_EQ(read("log").substr(0, 4), "old\n");
  write("log", "old\n");
  ASSERT_EQ(std::system((command + "/dev/stderr 2>> log > text").c_str()), 0);
  EXPECT_EQ(nlohmann::json::parse(read("log").substr(4))["tets"], 96);
  EXPECT_EQ(read("log").substr(0, 4), "old\n");
  EXPECT_THAT(read("text"), HasSubstr("bar:4x2x2"));
}

TEST_F(CommandLineTest, DescribesMeshesAndWritesThem) {
  const nlohmann::json info = report({"info", "bar:4x2x1"});
  EXPECT_EQ(info["kind"], "mesh");
  EXPECT_EQ(info["tets"], 48);
  EXPECT_NEAR(info["volume"].get<double>(), 1 * 0.5 * 0.25, 1e-12);
  EXPECT_EQ(info["components"], 1);
  EXPECT_EQ(supple({"mesh", "bar:4x2x1", "-o", "bar.vtu"}).exit_code, 0);
  const nlohmann::json again = report({"info", "bar.vtu"});
  EXPECT_EQ(again["tets"], info["tets"]);
  EXPECT_EQ(again["nodes"], info["nodes"]);
  EXPECT_NEAR(again["volume"].get<double>(), info["volume"].get<double>(), 1e-12);
}

TEST_F(CommandLineTest, ShowsAMeshsWarningsOnStderr) {
  // two tets that meet in an edge only
  write("hinge.mesh",
        "MeshVersionFormatted 2\nDimension 3\nVertices\n6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 -1 0 0\n0 0 "
        "-1 0\n"
        "Tetrahedra\n2\n1 2 3 4 1\n1 2 5 6 1\nEnd\n");
  const Outcome outcome = supple({"info", "hinge.mesh"});
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("supple: warning: hinge.mesh"));
}

}  // namespace

}  // namespace supple::test
