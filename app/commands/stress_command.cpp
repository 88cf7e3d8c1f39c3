#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/commands/stress_command.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/page.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/stress.hpp>
#include <core/output_file.hpp>
#include <core/parallel.hpp>
#include <core/version.hpp>
#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>
#include <physics/time/integrator_library.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>

namespace supple {

namespace {

/// What a cell of the table says: how much energy was made where that is more than nothing, or when it ended.
std::string in_a_cell(const StressRun& run) {
  switch (run.verdict()) {
    case Verdict::Sound:
      return run.rescued > 0 ? "sound, rescued" : run.halved > 0 ? "sound, halved" : "sound";
    case Verdict::Warned:
      return run.energy_made > Effort::tolerated ? "made " + shown_percent(run.energy_made, 2)
                                                 : shown_count(run.missed) + " missed";
    case Verdict::Stopped:
      return std::string(run.ending == Ending::NotFinite ? "not finite" : "stopped") + " at " +
             shown_percent(static_cast<double>(run.steps_done) / static_cast<double>(run.steps_asked), 2);
  }
  return "";
}

/// A row for each hardship and integrator, a column for each step.
TextTable table_of(const std::vector<StressRun>& runs, const std::vector<double>& steps_per_period) {
  TextTable table{.heading = {"motion", "integrator"}, .rows = {}};
  for (const double steps : steps_per_period) table.heading.push_back("T/" + shown(steps));
  for (const StressRun& run : runs) {
    if (table.rows.empty() || table.rows.back()[0] != run.hardship || table.rows.back()[1] != run.integrator)
      table.rows.push_back({run.hardship, run.integrator});
    table.rows.back().push_back(in_a_cell(run));
  }
  return table;
}

void write_runs(const std::filesystem::path& path, const std::vector<StressRun>& runs) {
  CsvTable table{{"motion"},       {"integrator"}, {"steps_per_period"}, {"steps_asked"},    {"steps_done"},
                 {"halved"},       {"rescued"},    {"missed"},           {"worst_residual"}, {"energy_made"},
                 {"energy_taken"}, {"reach"},      {"seconds", "s"},     {"ending"},         {"verdict"}};
  for (const StressRun& run : runs)
    table.add_row(run.hardship, run.integrator, run.steps_per_period, run.steps_asked, run.steps_done, run.halved,
                  run.rescued, run.missed, run.worst_residual, run.energy_made, run.energy_taken, run.reach,
                  run.seconds, to_string(run.ending), to_string(run.verdict()));
  const ExitGuard guard;
  write_csv(path, table);
}

Json runs_json(const std::vector<StressRun>& runs) {
  Json json = Json::array();
  for (const StressRun& run : runs)
    json.push_back({{"motion", run.hardship},
                    {"integrator", run.integrator},
                    {"steps_per_period", run.steps_per_period},
                    {"steps_asked", run.steps_asked},
                    {"steps_done", run.steps_done},
                    {"halved_steps", run.halved},
                    {"rescued_parts", run.rescued},
                    {"missed_steps", run.missed},
                    {"worst_residual", run.worst_residual},
                    {"energy_made", run.energy_made},
                    {"energy_taken", run.energy_taken},
                    {"reach", run.reach},
                    {"seconds", run.seconds},
                    {"status", to_string(run.ending)},
                    {"verdict", to_string(run.verdict())}});
  return json;
}

/// The most energy that an integrator made in any motion with such steps, but no less than is worth drawing [%].
double most_made(const std::vector<StressRun>& runs, const std::string& integrator, double steps_per_period) {
  double most = 1e-5;
  for (const StressRun& run : runs)
    if (run.integrator == integrator && run.steps_per_period == steps_per_period)
      most = std::max(most, 100 * run.energy_made);
  return most;
}

void draw_runs(const std::filesystem::path& path, const std::string& title, const std::vector<StressRun>& runs,
               const std::vector<std::string>& integrators, const std::vector<double>& steps_per_period) {
  Plot plot{.title = title,
            .x = {.label = "steps a period",
                  .scale = Scale::Log,
                  .low = 0.9 * std::ranges::min(steps_per_period),
                  .high = 1.1 * std::ranges::max(steps_per_period),
                  .ticks = steps_per_period},
            .y = {.label = "energy made, at worst [% of what loads brought]", .scale = Scale::Log},
            .series = {}};
  const Vector steps = Eigen::Map<const Vector>(steps_per_period.data(), static_cast<Index>(steps_per_period.size()));
  for (const std::string& integrator : integrators)
    plot.series.push_back({.name = integrator,
                           .x = steps,
                           .y = steps.unaryExpr([&](double count) { return most_made(runs, integrator, count); }),
                           .style = PlotStyle::LinePoints});
  const ExitGuard guard;
  draw_plot(path, plot);
}

std::vector<std::string> names_of_hardships() {
  std::vector<std::string> names;
  for (const HardshipInfo& hardship : all_hardships) names.emplace_back(hardship.name);
  return names;
}

}  // namespace

void StressCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  const ReducedModel reduced = load_model(model);
  std::vector<std::string> methods = integrators;
  if (methods.empty()) methods = supple::integrators().names();
  for (const std::string& method : methods) (void)energy_behaviour(Choice::parse(method));
  std::vector<double> steps = steps_per_period;
  if (steps.empty()) steps = brief ? std::vector<double>{60, 10} : std::vector<double>{1000, 300, 100, 60, 30, 10};
  std::vector<Hardship> wanted;
  for (Hardship& hardship : supple::hardships(reduced))
    if (hardships.empty() || std::ranges::find(hardships, hardship.info.name) != hardships.end())
      wanted.push_back(std::move(hardship));
  const OutputFolder folder(output);

  const Progress progress = progress_bar();
  std::vector<StressRun> runs;
  const double all = static_cast<double>(wanted.size() * methods.size() * steps.size());
  for (const Hardship& hardship : wanted)
    for (const std::string& method : methods)
      for (const double count : steps) {
        tell(progress, std::string(hardship.info.name) + ", " + method, static_cast<double>(runs.size()) / all);
        runs.push_back(endure(reduced, hardship, method, count, full));
        if (!output.empty()) write_runs(output / "stress.csv", runs);
      }
  clear_progress();

  Index sound = 0, warned = 0, stopped = 0;
  for (const StressRun& run : runs)
    ++(run.verdict() == Verdict::Sound ? sound : run.verdict() == Verdict::Warned ? warned : stopped);
  const std::string title = "Where motions of " + model.string() + " stay sane",
                    text = std::to_string(runs.size()) + " runs of the " + (full ? "full object" : "reduced model") +
                           ", undamped: " + std::to_string(sound) + " sound, " + std::to_string(warned) +
                           " with a warning, " + std::to_string(stopped) +
                           " stopped with a reason. T is the period of the softest flexible mode.",
                    table = markdown(table_of(runs, steps));
  std::string notes;
  for (const Hardship& hardship : wanted)
    notes += "- `" + std::string(hardship.info.name) + "`: " + std::string(hardship.info.description) + ".\n";
  Json report;
  report["command"] = "stress";
  report["version"] = SUPPLE_VERSION;
  report["model"] = model.string();
  report["system"] = full ? "full" : "reduced";
  report["sound"] = sound;
  report["warned"] = warned;
  report["stopped"] = stopped;
  report["runs"] = runs_json(runs);
  if (!output.empty()) {
    {
      const ExitGuard guard;
      write_file(output / "stress.md", "# " + title + "\n\n" + text + "\n\n" + table + "\n" + notes);
    }
    if (can_plot())
      draw_runs(output / "stress.png", title, runs, methods, steps);
    else
      warn("gnuplot is not installed: there will be no stress.png");
    write_json(output / "stress.json", report);
  }
  if (!is_stdout(json)) std::fputs((title + "\n" + text + "\n\n" + table).c_str(), stdout);
  write_json(json, report);
}

void StressCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("stress", "Find out where simulations of a model stay sane");
  command.add_option("MODEL", model, "Model that 'supple reduce' made")->required();
  declare_plugins(command);
  command.add_flag("--full", full, "Run the unreduced system instead: takes long");
  command.add_flag("--brief", brief, "60 and 10 steps a period only");
  command.add_option("--integrators", integrators, "Separated by commas, see 'supple simulate --help' [all there are]")
      ->delimiter(',')
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(known_in(supple::integrators()));
  command
      .add_option("--steps-per-period", steps_per_period,
                  "Of the softest flexible mode, separated by commas [1000,300,100,60,30,10]")
      ->delimiter(',')
      ->type_name("N")
      ->check(positive_number());
  command.add_option("--motions", hardships, "Separated by commas [all of those below]")
      ->delimiter(',')
      ->type_name("NAME")
      ->check(CLI::IsMember(names_of_hardships()));
  command.add_option("-o,--output", output, "Folder for stress.csv, .json, .md and .png")->type_name("DIR");
  declare_json(command, json);
  declare_threads(command, threads);
  std::string motions;
  for (const auto& [name, description] : all_hardships)
    motions += "  " + std::string(name) + ": " + std::string(description) + "\n";
  command.footer("Motions, undamped, for three periods of the softest flexible mode:\n" + motions +
                 "\nExamples:\n"
                 "supple stress bar.supple -o stress\n"
                 "supple stress bar.supple --full --brief --integrators average-vector-field,newmark -o stress");
  command.callback([this] { run(); });
}

}  // namespace supple
