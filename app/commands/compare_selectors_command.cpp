#include <app/commands/compare_selectors_command.hpp>
#include <app/commands/mesh_source.hpp>
#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/selector_table.hpp>
#include <app/report/terminal.hpp>
#include <core/output_file.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <physics/body/force_models.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>

namespace supple {

namespace {

/// In the order of their first occurrence.
template <typename T>
std::vector<T> without_copies(const std::vector<T>& values) {
  std::vector<T> result;
  for (const T& value : values)
    if (std::ranges::find(result, value) == result.end()) result.push_back(value);
  return result;
}

/// The sizes asked for, of m components.
std::vector<Index> sizes_to_compare(const CompareSelectorsCommand& command, Index m, std::string_view components) {
  if (command.sizes.empty()) {
    std::vector<Index> usual{50, 100, 150, 250};
    std::erase_if(usual, [m](Index size) { return size > m; });
    return usual.empty() ? std::vector<Index>{m} : usual;
  }
  for (const Index size : command.sizes)
    if (size < 1 || size > m)
      throw InputError("--sizes holds " + std::to_string(size) + ", expected 1 to the number of " +
                       std::string(components) + ", " + std::to_string(m));
  return without_copies(command.sizes);
}

SelectorRun run_selector(const SelectionStudy& study, const std::string& selector, Index size, std::uint64_t seed,
                         std::optional<Index> train_groups, const Progress& progress) {
  SelectionRequest request(size);
  request.progress = progress;
  const double before = processor_seconds();
  const Selection selection = AnySelector(Choice::parse(selector).name == "greedy" && train_groups
                                              ? selector + ":subset_groups=" + std::to_string(*train_groups)
                                              : selector,
                                          seed)(study.problem(), request);
  const double used = processor_seconds() - before;
  const auto points = static_cast<Index>((selection.weights.array() != 0).count());
  return {selector, size, seed, points, used, selection.report, study.measure(selection)};
}

std::string description(const CompareSelectorsCommand& command, const ReduceOptions& options, const Body& body,
                        const SelectionStudy& study) {
  const ReduceReport& report = study.report();
  const Index equilibria = num_equilibria(body, options);
  std::string text =
      shown_count(report.components) + " " + std::string(component_name(body)) + " (" + std::string(law(body)) +
      "), subspace of dimension " + std::to_string(report.dimension) + ", " + std::to_string(report.poses) +
      " training poses" + (equilibria > 0 ? " and " + std::to_string(equilibria) + " equilibria" : "") + " by the " +
      recipe_of(command) + " recipe, errors in the " + (options.norm == ForceNorm::Mass ? "mass" : "stiffness") +
      " norm, " + std::to_string(command.runs) + (command.runs == 1 ? " seed" : " seeds") + ".";
  if (!study.scenes().empty()) text += " Pulls reach";
  for (std::size_t k = 0; k < study.scenes().size(); ++k)
    text += (k == 0 ? " " : ", ") + shown_percent(study.largest_displacements()[k], 2) + " of the diagonal (" +
            study.scenes()[k].name + ")";
  return study.scenes().empty() ? text : text + ".";
}

}  // namespace

void CompareSelectorsCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  if (train_groups && std::ranges::none_of(selectors, [](const std::string& selector) {
        return Choice::parse(selector).name == "greedy";
      }))
    throw InputError("--train-groups is for the selector greedy, which is not among --selectors");
  if (runs < 1) throw InputError("--runs is " + std::to_string(runs) + ", expected at least 1");
  const Stopwatch total;
  const NamedMesh named = load_mesh(mesh, mesh_unit);
  const Body body = load_body(*this, named);
  if (const auto note = locking_note(*this, body)) warn(*note);
  const Index m = with_force_model(body, [](const auto& model) { return model->num_components(); });
  const std::vector<std::string> names = without_copies(selectors);
  const bool only_all = names == std::vector<std::string>{"all"};  // which has its own size
  const std::vector<Index> points = only_all ? std::vector{m} : sizes_to_compare(*this, m, component_name(body));
  const ReduceOptions options = reduce_options(*this, named, body);
  if (std::ranges::find(selectors, "all") != selectors.end()) (void)num_components_to_weight(body, options);
  const OutputFolder folder(output);
  std::vector<PullScene> scenes;
  if (trajectories)
    scenes = {{.name = "pull"}, {.name = "ramped pull", .ramp = 60}, {.name = "damped pull", .damping = 0.05}};
  const SelectionStudy study(body, options, std::move(scenes), progress_bar());
  for (const std::string& note : study.report().notes) warn(note);

  std::vector<SelectorRun> results;
  for (const std::string& selector : names)
    for (const Index size : selector == "all" ? std::vector{m} : points)
      for (Index k = 0; k < (selector == "all" ? 1 : runs); ++k) {
        results.push_back(
            run_selector(study, selector, size, seed + static_cast<std::uint64_t>(k), train_groups, progress_bar()));
        if (!output.empty()) write_runs(output / "runs.csv", results, study.scenes());  // hours of work survive an end
      }
  clear_progress();

  const std::vector<SelectorSummary> summaries = summarize(results);
  const std::string table = markdown_table(summaries, study.scenes()), title = "Selectors on " + mesh,
                    text = description(*this, options, body, study);
  if (!output.empty()) {
    {
      const ExitGuard guard;
      write_file(output / "table.md",
                 "# " + title + "\n\n" + text + "\n\n" + table + "\n" + std::string(selector_table_notes) + "\n");
    }
    write_selector_page(output, title, text, summaries, study.scenes(),
                        draw_selector_plots(output, results, study.scenes()));
  }
  Json report;
  report["command"] = "compare-selectors";
  report["version"] = SUPPLE_VERSION;
  report["mesh"] = mesh;
  report["description"] = text;
  report["options"] = problem_json(*this, options, body);
  report["options"]["train_groups"] = train_groups ? Json(*train_groups) : Json();
  Json scene_list = Json::array();
  for (std::size_t k = 0; k < study.scenes().size(); ++k)
    scene_list.push_back(
        {{"name", study.scenes()[k].name}, {"largest_displacement", study.largest_displacements()[k]}});
  report["scenes"] = std::move(scene_list);
  report["runs"] = runs_json(results);
  report["seconds"] = json_seconds(study.report().seconds, total.seconds());
  report["peak_memory"] = peak_resident_memory();
  if (!is_stdout(json)) std::fputs((title + "\n" + text + "\n\n" + table).c_str(), stdout);
  write_json(json, report);
}

void CompareSelectorsCommand::declare(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("compare-selectors", "Run selectors over sizes and seeds on one fitting problem");
  declare_problem(command, *this);
  declare_training(command, *this);
  const auto comparison = "Comparison";
  command.add_option("--selectors", selectors, "Names, with options if need be, separated by commas; see below")
      ->delimiter(',')
      ->capture_default_str()
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(known_in(supple::selectors()))
      ->group(comparison);
  command
      .add_option("--sizes", sizes,
                  "Numbers of components, separated by commas [50,100,150,250, as far as the object has them]")
      ->delimiter(',')
      ->type_name("N")
      ->group(comparison);
  command.add_option("--runs", runs, "Seeds for each selector and size")
      ->capture_default_str()
      ->type_name("N")
      ->group(comparison);
  command
      .add_option("--train-groups", train_groups,
                  "Poses that 'greedy' compares components on, anew in each step [all; An et al.: 10]")
      ->type_name("N")
      ->check(whole_number())
      ->group(comparison);
  command
      .add_flag("--trajectories", trajectories,
                "Compare pulled motions, too; their reference evaluates every component, which takes a minute")
      ->group(comparison);
  command.add_option("-o,--output", output, "Folder for runs.csv, table.md, plots and the page index.html")
      ->type_name("DIR");
  declare_json(command, json);
  declare_threads(command, threads);
  command.footer([] {
    return selector_help() + "\n" + material_help() + "\n" + subspace_help() + "\n" + builtin_help() +
           "\nExample:\n"
           "supple compare-selectors dragon.msh --fix 'y<4%' --selectors nn-sp,nn-htp,greedy --sizes 50,100,150 -o "
           "comparison";
  });
  command.callback([this] { run(); });
}

}  // namespace supple
