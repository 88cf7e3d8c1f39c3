#include <app/commands/mesh_source.hpp>
#include <app/commands/option_checks.hpp>
#include <app/commands/reduce_command.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/machine.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/model_search.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <io/picture/plot.hpp>
#include <io/text/index_file.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/material_law.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <CLI/CLI.hpp>

#include <cmath>
#include <numbers>

namespace supple {

namespace {

constexpr Index largest_search = 1000;  // points, if only a target error is given

/// What an earlier model of the same object has selected.
Selection selection_of(const std::filesystem::path& path, const Body& body, Index num_components) {
  const ReducedModel model = load_model(path);
  const Index m = with_force_model(model.body, [](const auto& force) { return force->num_components(); });
  if (m != num_components || component_name(model.body) != component_name(body))
    throw InputError(path.string() + ": has " + std::to_string(m) + " " + std::string(component_name(model.body)) +
                     ", expected " + std::to_string(num_components) + " " + std::string(component_name(body)) +
                     " as the mesh");
  if (!has_nodes(model.body, node_positions(body)))
    throw InputError(path.string() + ": is a model of another mesh, expected one with the same nodes");
  return {.indices = model.indices, .weights = model.weights, .report = {}};
}

ReduceOptions method(const ReduceCommand& command, const NamedMesh& named, const Body& body) {
  ReduceOptions options = reduce_options(command, named, body);
  if (command.target_error) {
    options.target_error = *command.target_error;
    options.points = largest_search;
  }
  if (!command.full_loads) options.full_loads = 8;
  options.singular = SingularModels::Refuse;
  if (command.points) options.points = *command.points;
  if (command.selector) options.selector = *command.selector;
  const Index m = with_force_model(body, [](const auto& model) { return model->num_components(); });
  if (!command.candidates.empty()) options.candidates = read_indices(command.candidates, "component", m);
  if (!command.must_keep.empty()) options.must_keep = read_indices(command.must_keep, "component", m);
  if (!command.warm_start.empty()) options.warm_start = selection_of(command.warm_start, body, m);
  if (options.selector == "all") {
    const Index all = num_components_to_weight(body, options);
    if (command.target_error)
      throw InputError("--target-error is for selectors that take few components, not for --selector all");
    if (command.points && *command.points < all)
      throw InputError("--selector all takes all " + std::to_string(all) + " candidates, more than --points " +
                       std::to_string(*command.points));
    options.points = all;
  }
  if (options.points > 0 && static_cast<Index>(options.must_keep.size()) > options.points)
    throw InputError(command.must_keep.string() + ": names " + std::to_string(options.must_keep.size()) +
                     " components, expected at most --points " + std::to_string(options.points));
  return options;
}

/// What the model is asked for, if sizes are to follow from it.
std::optional<ModelGoal> goal_of(const ReduceCommand& command) {
  if (!command.full_error && !command.step_time) return {};
  if (command.full_error && command.step_time)
    throw InputError("--full-error and --step-time each choose a model, expected one of them");
  const bool by_error = command.full_error.has_value();
  const std::string option = by_error ? "--full-error" : "--step-time";
  const ModelGoal goal{
      by_error ? ModelGoal::Limit::Error : ModelGoal::Limit::StepTime,
      by_error ? option_quantity(option, *command.full_error, "1") : option_quantity(option, *command.step_time, "s")};
  if (!(goal.most > 0 && std::isfinite(goal.most)))
    throw InputError(option + " is " + shown(goal.most) + (by_error ? "" : " s") + ", expected > 0");
  const auto refuse = [&](bool given, const std::string& other) {
    if (given)
      throw InputError(option + " chooses the size of the model, which " + other + " sets: expected one of them");
  };
  refuse(command.points.has_value(), "--points");
  refuse(command.modes.has_value(), "--modes");
  refuse(command.dimension.has_value(), "--dimension");
  refuse(command.target_error.has_value(), "--target-error");
  refuse(command.selector == "all", "--selector all");
  if (command.full_loads == 0)
    throw InputError(option + " compares models with the full object, which --full-loads 0 forbids");
  return goal;
}

/// The ladder, as far as it is in the subspace that was asked for and has room for what is to be kept.
std::vector<ModelRung> ladder_of(const ReduceCommand& command, const Body& body, const ReduceOptions& options) {
  std::vector<ModelRung> ladder = model_ladder(body, options);
  const auto kind = [](const ModelRung& rung) { return Choice::parse(rung.options.subspace).name; };
  if (command.subspace) {
    std::erase_if(ladder, [&](const ModelRung& rung) { return kind(rung) != *command.subspace; });
    if (ladder.empty())
      throw InputError("--subspace " + *command.subspace + " is in none of the models that " +
                       (command.full_error ? "--full-error" : "--step-time") +
                       " chooses from here, expected derivatives or extended");
  }
  std::erase_if(ladder, [&](const ModelRung& rung) {
    return static_cast<Index>(options.must_keep.size()) > rung.options.points;
  });
  if (ladder.empty())
    throw InputError(command.must_keep.string() + ": names " + std::to_string(options.must_keep.size()) +
                     " components, more than any of the models has points that " +
                     (command.full_error ? "--full-error" : "--step-time") + " chooses from");
  return ladder;
}

std::string in_words(const ModelGoal& goal) {
  return goal.limit == ModelGoal::Limit::Error ? "equilibria at most " + shown_percent(goal.most) + " off"
                                               : "a step in at most " + shown(1e6 * goal.most, 3) + " µs";
}

/// Why the search has chosen its model.
std::string reason(const ModelSearch& search, const ModelGoal& goal) {
  const std::string count = std::to_string(search.tried.size()) + (search.tried.size() == 1 ? " model" : " models");
  if (goal.limit == ModelGoal::Limit::Error)
    return search.met ? "the first of " + count + " tried, coarse to fine, with " + in_words(goal)
                      : "the nearest to the full object of " + count + ", none of which has " + in_words(goal);
  return search.met ? "the nearest to the full object of those that make " + in_words(goal) + ", of " + count + " tried"
                    : "the fastest of " + count + " tried, none of which makes " + in_words(goal);
}

Json search_json(const ModelSearch& search, const ModelGoal& goal) {
  Json tried = Json::array();
  for (const TriedModel& model : search.tried)
    tried.push_back({{"model", model.model},
                     {"dimension", model.dimension},
                     {"points", model.points},
                     {"full_error", model.measure.error},
                     {"step_seconds", model.measure.step_seconds}});
  return {{goal.limit == ModelGoal::Limit::Error ? "full_error" : "step_seconds", goal.most},
          {"met", search.met},
          {"chosen", search.tried[search.chosen].model},
          {"reason", reason(search, goal)},
          {"tried", std::move(tried)},
          {"machine", {{"processor", processor_name()}, {"threads", num_threads()}}}};
}

/// Rows of the report: what was tried, and which it is.
void add_search(Rows& rows, const ModelSearch& search, const ModelGoal& goal) {
  for (std::size_t k = 0; k < search.tried.size(); ++k) {
    const auto& [model, dimension, points, measure] = search.tried[k];
    std::string text = "d = " + std::to_string(dimension) + ", s = " + std::to_string(points) + ": " +
                       shown_percent(measure.error) + " off";
    if (!std::isnan(measure.step_seconds)) text += ", a step in " + shown(1e6 * measure.step_seconds, 3) + " µs";
    rows.emplace_back(k == 0 ? "tried" : "", text + (k == search.chosen ? "; chosen" : ""));
  }
  rows.emplace_back("chosen as", reason(search, goal));
}

/// What made the model, and nothing that differs between two runs of the same job.
Json options_json(const ReduceCommand& command, const ReduceOptions& options, const Body& body) {
  Json json = problem_json(command, options, body);
  json["points"] = options.points;
  json["target_error"] = options.target_error;
  json["selector"] = options.selector;
  const auto file = [&](const char* key, const std::filesystem::path& path) {
    if (!path.empty()) json[key] = path.string();
  };
  file("candidates", command.candidates);
  file("must_keep", command.must_keep);
  file("warm_start", command.warm_start);
  if (command.full_error) json["full_error"] = *command.full_error;
  if (command.step_time) json["step_time"] = *command.step_time;
  return json;
}

Json report_json(const ReduceCommand& command, const ReduceOptions& options, const NamedMesh& named,
                 const ReducedModel& model, const ReduceReport& report) {
  Json json;
  json["command"] = "reduce";
  json["version"] = SUPPLE_VERSION;
  json["mesh"] = {{"source", command.mesh},
                  {"format", named.notes.format},
                  {"nodes", report.nodes},
                  {json_key(component_name(model.body)), report.components},
                  {"fixed_nodes", report.fixed_nodes},
                  {"sliding_nodes", held_axes(model.body).size()},
                  {"mass", nodal_mass(model.body).sum()},
                  {"diagonal", bounding_box(node_positions(model.body)).diagonal()},
                  {"warnings", named.notes.warnings}};
  json["mesh"][json_key(cell_name(model.body))] = num_cells(model.body);
  json["dimension"] = report.dimension;
  json["points"] = report.points;
  json["full_error"] = json_full_error(report.full_error);
  json["training_error"] = report.training_error;
  json["held_out_error"] = report.held_out_error;
  json["equilibrium_error"] = report.equilibrium_error;
  json["equilibrium_loads"] = report.equilibrium_loads;
  json["equilibrium_unfinished"] = report.equilibrium_unfinished;
  json["equilibrium_training_error"] = report.equilibrium_training_error;
  json["held_out"] = Json::array();
  const double largest = options.poses.largest_amplitude();
  for (const auto& [share, error] : report.held_out)
    json["held_out"].push_back({{"share", share}, {"amplitude", share * largest}, {"error", error}});
  json["poses"] = {{"count", report.poses},
                   {"inverted", report.inverted_poses},
                   {"redrawn", report.redrawn_poses},
                   {"shrunk", report.shrunk_poses}};
  json["modes"] = {{"omega", json_numbers(report.omega)}, {"rigid", report.rigid_modes}, {"dropped", report.dropped}};
  json["eigenvalues"] = {{"fitted", json_numbers(report.fitted_eigenvalues)},
                         {"exact", json_numbers(report.exact_eigenvalues)}};
  json["rest_stiffness"] = {{"smallest", report.rest_stiffness.smallest},
                            {"largest", report.rest_stiffness.largest},
                            {"sound", report.rest_stiffness.is_sound()},
                            {"weak", report.rest_stiffness.is_weak()},
                            {"points_for_sound", report.points_for_sound_stiffness},
                            {"points_too_weak", report.points_too_weak}};
  const SelectionReport& selection = report.selection;
  json["selection"] = {{"selector", options.selector},
                       {"status", to_string(selection.status)},
                       {"stop_reason", selection.stop_reason},
                       {"iterations", selection.iterations},
                       {"residual", selection.residual},
                       {"kkt_residual", selection.kkt_residual},
                       {"columns_evaluated", selection.columns_evaluated},
                       {"history", json_history(selection)}};
  json["notes"] = report.notes;
  json["options"] = options_json(command, options, model.body);
  json["seed"] = options.seed;
  json["threads"] = num_threads();
  json["model"] = command.model.string();
  return json;
}

/// The object with its selected components as balls.
void draw_selection(const std::filesystem::path& path, const ReducedModel& model, const ReduceReport& report) {
  const Points& nodes = node_positions(model.body);
  Points centres(static_cast<Index>(model.indices.size()), 3);
  with_force_model(model.body, [&](const auto& force) {
    for (std::size_t k = 0; k < model.indices.size(); ++k) {
      const auto stencil = force->stencil(model.indices[k]);
      Point sum = Point::Zero();
      for (const Index v : stencil) sum += nodes.row(v).transpose();
      centres.row(k) = sum.transpose() / static_cast<double>(stencil.size());
    }
  });
  const Surface surface(model.body);
  PictureObject object{.positions = surface.rows(nodes), .triangles = surface.triangles};
  object.markers = centres;
  object.caption = std::to_string(report.points) + " of " + shown_count(report.components) + " " +
                   std::string(component_name(model.body)) +
                   (report.full_error.loads > 0
                        ? ", equilibria " + shown_percent(report.full_error.total, 2) + " off the full object"
                        : ", training error " + shown_percent(report.training_error, 2));
  write_picture(path, {object});
}

void draw_error_history(const std::filesystem::path& path, const std::string& kind, const ReduceReport& report) {
  const std::vector<SelectionStep>& history = report.selection.history;
  const Index count = static_cast<Index>(history.size());
  if (count == 0) return;
  PlotSeries training{"training poses", Vector(count), Vector(count), PlotStyle::LinePoints};
  for (Index k = 0; k < count; ++k) {
    training.x[k] = static_cast<double>(k + 1);
    training.y[k] = 100 * history[k].training_error;
  }
  Plot plot{.title = "Force error while choosing " + std::to_string(report.points) + " of " +
                     shown_count(report.components) + " " + kind,
            .x = {.label = "iteration"},
            .y = {.label = "relative force error [%]", .scale = Scale::Log},
            .series = {training}};
  PlotSeries held_out = training;
  held_out.name = "held-out poses, largest amplitude";
  for (Index k = 0; k < count; ++k) held_out.y[k] = 100 * history[k].held_out_error;
  if (!held_out.y.array().isNaN().all()) plot.series.push_back(held_out);
  const ExitGuard guard;
  draw_plot(path, plot);
}

void draw_spectrum(const std::filesystem::path& path, const std::string& kind, const ReduceReport& report) {
  const auto hertz = [](const Vector& eigenvalues) -> Vector {
    return eigenvalues.cwiseMax(0).cwiseSqrt() / (2 * std::numbers::pi);
  };
  const Vector number =
      Vector::LinSpaced(report.exact_eigenvalues.size(), 1, static_cast<double>(report.exact_eigenvalues.size()));
  const ExitGuard guard;
  draw_plot(path, {.title = "Softest frequencies of the reduced model at rest",
                   .x = {.label = "flexible mode", .low = 0.5, .high = number.size() + 0.5},
                   .y = {.label = "frequency [Hz]", .low = 0.0},
                   .series = {{"all " + kind, number, hertz(report.exact_eigenvalues), PlotStyle::LinePoints},
                              {std::to_string(report.points) + " selected " + kind, number,
                               hertz(report.fitted_eigenvalues), PlotStyle::Markers}}});
}

std::string held_in_words(const Body& body) {
  if (is_free(body)) return "free";
  const auto count = [](const auto& nodes) { return shown_count(static_cast<long long>(nodes.size())); };
  std::string text;
  if (!fixed_nodes(body).empty()) text = count(fixed_nodes(body)) + " nodes fixed";
  if (!held_axes(body).empty()) text += (text.empty() ? "" : ", ") + count(held_axes(body)) + " nodes slide";
  return text;
}

void print_summary(const ReduceCommand& command, const ReducedModel& model, const ReduceReport& report,
                   const Rows& search) {
  const std::string kind(component_name(model.body));
  Rows rows{{"object", shown_count(report.nodes) + " nodes, " + shown_count(report.components) + " " + kind + ", " +
                           held_in_words(model.body)},
            {"subspace", "dimension " + std::to_string(report.dimension) + " from " +
                             std::to_string(report.omega.size()) + " modes" +
                             (report.rigid_modes > 0 ? " (" + std::to_string(report.rigid_modes) + " rigid)" : "")},
            {"points", std::to_string(report.points) + " " + kind}};
  if (report.points_too_weak > 0)
    rows.emplace_back("", "as few as hold the object at rest: " + std::to_string(report.points_too_weak) + " have " +
                              (command.target_error ? "the target error" : "the usual number") +
                              " and leave a direction with less than 10 % of its stiffness");
  rows.insert(rows.end(), search.begin(), search.end());
  const FullError& full = report.full_error;
  if (full.loads > 0) {
    rows.emplace_back("full object", "equilibria " + shown_percent(full.total) + " off, rms of " +
                                         std::to_string(full.loads) + " fresh loads (worst " +
                                         shown_percent(full.worst) + ")");
    rows.emplace_back(
        "", shown_percent(full.outside) + " outside of the subspace, " + shown_percent(full.inside) + " in it");
  }
  if (report.equilibrium_loads > 0)
    rows.emplace_back("fresh equilibria",
                      shown_percent(report.equilibrium_error) + " off those fitted to, rms of " +
                          std::to_string(report.equilibrium_loads) + " loads" +
                          (report.equilibrium_unfinished > 0
                               ? " (under " + std::to_string(report.equilibrium_unfinished) + " more, those find none)"
                               : ""));
  rows.emplace_back("training error", shown_percent(report.training_error));
  std::string held_out;
  for (const auto& [share, error] : report.held_out)
    held_out += (held_out.empty() ? "" : ", ") + shown_percent(error) +
                (share < 1 ? " at " + shown(share) + " of the amplitude" : "");
  if (std::isfinite(report.equilibrium_training_error))
    rows.emplace_back("equilibria in training", "displaced by " + shown_percent(report.equilibrium_training_error));
  rows.emplace_back("held-out error", held_out.empty() ? "not measured" : held_out);
  if (report.exact_eigenvalues.size() > 0)
    rows.emplace_back("softest eigenvalue",
                      shown_percent(report.fitted_eigenvalues[0] / report.exact_eigenvalues[0] - 1, 2) + " off");
  if (const StiffnessRange& range = report.rest_stiffness; range.largest > 0) {
    rows.emplace_back("stiffness at rest",
                      shown(range.smallest, 3) + " to " + shown(range.largest, 3) + " of the exact one");
    if (!range.is_sound())
      rows.emplace_back(
          "", report.points_for_sound_stiffness > 0
                  ? "0.7 to 1.3 would take about " + std::to_string(report.points_for_sound_stiffness) + " points"
                  : "more points would not bring it to 0.7 to 1.3: forces relaxed");
  }
  rows.emplace_back("selection", shown_iterations(report.selection.iterations) + ", " + report.selection.stop_reason);
  rows.emplace_back("peak memory", shown_bytes(report.peak_memory));
  rows.emplace_back("model", command.model.string());
  print_rows(stdout, "reduced model of " + model.provenance.at("mesh"), rows);
  print_stages(stdout, report.seconds, report.total_seconds);
}

}  // namespace

void ReduceCommand::run() const {
  set_num_threads(threads);
  for (const std::filesystem::path& file : {model, json, picture}) require_writable(file);
  const Stopwatch total;
  Stopwatch watch;
  const NamedMesh named = load_mesh(mesh, mesh_unit);
  const Body body = load_body(*this, named);
  const std::optional<ModelGoal> goal = goal_of(*this);
  ReduceOptions options = method(*this, named, body);
  const std::vector<ModelRung> ladder = goal ? ladder_of(*this, body, options) : std::vector<ModelRung>();
  const OutputFolder folder(plots);
  keep_stages(options.checkpoint);
  const double read_seconds = watch.seconds();

  ReduceReport report;
  ReducedModel result;
  std::optional<ModelSearch> found;
  if (goal) {
    found = search(body, ladder, *goal, progress_bar());
    options = found->options;
    report = found->report;
    result = std::move(found->model);
    report.seconds.emplace_back("search", found->other_seconds);
  } else {
    result = reduce(body, options, &report, progress_bar());
  }
  clear_progress();
  if (const auto note = locking_note(*this, body)) report.notes.insert(report.notes.begin(), *note);
  result.provenance = {
      {"version", SUPPLE_VERSION},
      {"mesh", mesh},
      {"seed", std::to_string(options.seed)},
      {"options", options_json(*this, options, body).dump()},
      {"full_error", exact(report.full_error.total)},
      {"equilibrium_error", exact(report.equilibrium_error)},
      {"rest_stiffness", exact(report.rest_stiffness.smallest) + " " + exact(report.rest_stiffness.largest)},
      {"training_error", exact(report.training_error)},
      {"held_out_error", exact(report.held_out_error)}};
  for (const std::string& note : report.notes) warn(note);
  if (options.target_error > 0 && report.training_error > options.target_error)
    warn("the training error is " + shown_percent(report.training_error) + ", not " +
         shown_percent(options.target_error) + ": " +
         (!options.candidates.empty() && static_cast<Index>(options.candidates.size()) <= options.points
              ? "the " + shown_count(static_cast<long long>(options.candidates.size())) + " candidates cannot do better"
              : "allow more --points than " + std::to_string(options.points)));
  if (found && !found->met) warn("the goal is missed: the model is " + reason(*found, *goal));

  watch.restart();
  {
    const ExitGuard guard(model);
    save_model(model, result);
  }
  report.seconds.insert(report.seconds.begin(), {"read mesh", read_seconds});
  report.seconds.emplace_back("write model", watch.seconds());
  watch.restart();
  if (!picture.empty()) draw_selection(picture, result, report);
  if (!plots.empty()) {
    const std::string kind(component_name(body));
    draw_error_history(plots / "error.png", kind, report);
    draw_spectrum(plots / "spectrum.png", kind, report);
  }
  if (!picture.empty() || !plots.empty()) report.seconds.emplace_back("pictures", watch.seconds());
  report.total_seconds = total.seconds();
  report.peak_memory = peak_resident_memory();

  Json json_report = report_json(*this, options, named, result, report);
  json_report["seconds"] = json_seconds(report.seconds, report.total_seconds);
  json_report["peak_memory"] = report.peak_memory;
  Rows search_rows;
  if (found) {
    json_report["search"] = search_json(*found, *goal);
    add_search(search_rows, *found, *goal);
  }
  if (!is_stdout(json)) print_summary(*this, result, report, search_rows);
  write_json(json, json_report);
}

void ReduceCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("reduce", "Make a reduced model of a mesh");
  declare_problem(command, *this);
  declare_training(command, *this);

  const auto files = "Output";
  command.add_option("-o,--output", model, "The model's file")->required()->type_name("MODEL")->group(files);
  declare_json(command, json).group(files);
  command.add_option("--picture", picture, "Picture of the object and the selected cells")
      ->type_name("FILE.png")
      ->group(files);
  command.add_option("--plots", plots, "Folder for plots of the errors and of the frequencies")
      ->type_name("DIR")
      ->group(files);

  command
      .add_option("--points", points,
                  "Largest number of components that stand for all [150; relaxed: four thirds of the dimension, "
                  "surfaces: 250; 1000 with --target-error]")
      ->type_name("S")
      ->check(whole_number())
      ->group(method_group);
  declare_full_loads(command, *this, /*least=*/0);
  declare_checkpoint(command, *this);
  command.add_option("--target-error", target_error, "Take as few components as reach this training error")
      ->type_name("SHARE")
      ->check(positive_number())
      ->group(method_group);
  command
      .add_option(
          "--full-error", full_error,
          "Choose subspace and points, coarse to fine: the first model whose equilibria are at most so far from "
          "those of the full object, such as 5%")
      ->type_name("SHARE")
      ->group(method_group);
  command
      .add_option("--step-time", step_time,
                  "Choose them: the nearest to the full object whose steps take at most so long here, such as '50 us'")
      ->type_name("T")
      ->group(method_group);
  command.add_option("--selector", selector, "How they are chosen, see below [nn-sp; paper: nn-htp]")
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(known_in(selectors()))
      ->group(method_group);
  command
      .add_option("--candidates", candidates,
                  "Components that may be chosen beside --must-keep, one index a line, from 0 [all]")
      ->type_name("FILE")
      ->group(method_group);
  command.add_option("--must-keep", must_keep, "Components that every choice has, unless their weight would be 0")
      ->type_name("FILE")
      ->group(method_group);
  command.add_option("--warm-start", warm_start, "Earlier model of this mesh whose selection is to be improved")
      ->type_name("MODEL")
      ->group(method_group);
  declare_threads(command, threads);
  command.footer([] {
    return material_help() + "\n" + subspace_help() + "\n" + selector_help() + "\n" + builtin_help() +
           "\nExamples:\n"
           "supple reduce dragon.msh -o dragon.supple --fix 'y<4%' --points 150\n"
           "supple reduce dragon.msh -o dragon.supple --selector nn-sp:max_iterations=100:patience=20\n"
           "supple reduce dragon.msh -o dragon.supple --fix 'y<4%' --full-error 5%\n"
           "supple reduce octopus -o octopus.supple --fix 'y<4%' --picture octopus.png --json -";
  });
  command.callback([this] { run(); });
}

}  // namespace supple
