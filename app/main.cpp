#include <app/commands/compare_command.hpp>
#include <app/commands/compare_selectors_command.hpp>
#include <app/commands/edit_command.hpp>
#include <app/commands/fidelity_command.hpp>
#include <app/commands/info_command.hpp>
#include <app/commands/mesh_command.hpp>
#include <app/commands/modes_command.hpp>
#include <app/commands/pareto_command.hpp>
#include <app/commands/reduce_command.hpp>
#include <app/commands/select_command.hpp>
#include <app/commands/simulate_command.hpp>
#include <app/commands/static_command.hpp>
#include <app/commands/stress_command.hpp>
#ifdef SUPPLE_HAS_VIEWER
#include <app/commands/view_command.hpp>
#endif
#include <app/report/exit_guard.hpp>
#include <app/report/terminal.hpp>
#include <core/check.hpp>
#include <core/version.hpp>
#include <io/text/json_fields.hpp>

#include <CLI/CLI.hpp>

#include <cstdio>
#include <iostream>
#include <new>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

namespace {

using namespace supple;

/// In the order of the help.
using Commands = std::tuple<ReduceCommand, SimulateCommand, StaticCommand, ModesCommand, EditCommand,
#ifdef SUPPLE_HAS_VIEWER
                            ViewCommand,
#endif
                            FidelityCommand, CompareCommand, CompareSelectorsCommand, ParetoCommand, StressCommand,
                            SelectCommand, InfoCommand, MeshCommand>;

/// Messages of any origin on one line.
int fail(int code, std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (std::size_t at; (at = message.find('\n')) != std::string::npos;) message.replace(at, 1, "; ");
  clear_progress();
  std::fflush(stdout);
  std::fprintf(stderr, "supple: %s\n", message.c_str());
  return code;
}

/// The code, unless what was printed got nowhere.
int end_of_output(int code) {
  std::cout.flush();
  return std::fflush(stdout) == 0 && !std::ferror(stdout) ? code : fail(1, "stdout cannot be written");
}

/// "; did you mean --fix?" if a known word is near.
std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::optional<std::string> nearest = nearest_word(word, known);
  return nearest ? "; did you mean " + *nearest + "?" : "";
}

/// The first word on the command line that no command or option takes.
std::string not_expected(const CLI::App& app) {
  std::vector<std::string> known;
  if (app.get_subcommands().empty()) {
    for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  } else {
    for (const CLI::Option* option : app.get_subcommands().front()->get_options())
      for (const std::string& name : option->get_lnames()) known.push_back("--" + name);
  }
  const std::vector<std::string> words = app.remaining(true);
  if (words.empty()) return "";
  const std::string word = words.front().substr(0, words.front().find('='));
  return "'" + word + "' is not known here" + suggestion(word, known);
}

int run(int argc, char** argv) {
  CLI::App app{"Supple: reduced deformable objects, from a mesh to a real-time model with a measured error", "supple"};
  app.set_version_flag("--version", "supple " SUPPLE_VERSION);
  app.require_subcommand(1);
  app.footer(
      "Examples:\n"
      "supple reduce octopus -o octopus.supple --fix 'y<4%'\n"
      "supple info octopus.supple\n"
      "supple simulate octopus.supple -o run\n"
      "supple simulate octopus.supple --full --time 0.1 -o full\n"
      "supple compare run full -o comparison\n"
      "\n'supple COMMAND --help' says more.");
  Commands commands;  // options write into them, so they stay where they are until the line is parsed
  std::apply([&](auto&... command) { (command.declare(app), ...); }, commands);
  try {
    app.parse(argc, argv);
    return end_of_output(0);
  } catch (const CLI::Success& asked) {  // --help, --version
    return end_of_output(app.exit(asked));
  } catch (const CLI::ParseError& error) {
    const std::string stray = not_expected(app);
    return fail(2, stray.empty() ? error.what() : stray);
  } catch (const InputError& error) {
    return fail(2, error.what());
  } catch (const std::invalid_argument& error) {
    return fail(2, error.what());
  } catch (const std::bad_alloc&) {
    return fail(1, "there is not enough memory");
  } catch (const std::exception& error) {
    return fail(1, error.what());
  }
}

/// Run by the loader before the initialisers of libraries.
[[gnu::section(".preinit_array"), gnu::used]] void (*before_libraries)() = hold_signals;

}  // namespace

int main(int argc, char** argv) {
  supple::watch_for_signals();
  return supple::exit_code(run(argc, argv));
}
