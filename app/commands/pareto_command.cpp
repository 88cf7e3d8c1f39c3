#include <app/commands/option_checks.hpp>
#include <app/commands/pareto_command.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/machine.hpp>
#include <app/report/pareto_table.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/motion_study.hpp>
#include <core/output_file.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <io/picture/plot.hpp>
#include <physics/body/force_models.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/model_ladder.hpp>
#include <reduction/pipeline/model_series.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>

namespace supple {

namespace {

constexpr Index usual_loads = 8;  // that a model is compared with the full object under

/// What `supple reduce` would do with these words.
ReduceOptions options_of(const ParetoCommand& command, const std::string& text, const NamedMesh& named,
                         const Body& body) {
  const ModelWords words = ModelWords::parse(text);
  const Index m = with_force_model(body, [](const auto& model) { return model->num_components(); });
  if (words.points > m)
    throw InputError("--models holds " + text + ", expected points from 1 to the number of " +
                     std::string(component_name(body)) + ", " + std::to_string(m));
  ProblemOptions own = command;
  own.subspace = words.subspace;
  own.modes = words.modes;
  own.dimension = words.dimension;
  const std::vector<std::string> parts = parts_of_subspace(words.subspace);
  if (std::ranges::find(parts, "pca") == parts.end()) own.snapshots.reset();
  ReduceOptions options = reduce_options(own, named, body);
  if (words.points) options.points = *words.points;
  return options;
}

/// Those that were asked for, each once, or else the ladder.
std::vector<ReduceOptions> models_to_make(const ParetoCommand& command, const NamedMesh& named, const Body& body) {
  std::vector<ReduceOptions> models;
  if (command.models.empty()) {
    if (command.snapshots) throw InputError("--snapshots are for pca, which is not among --models");
    for (ModelRung& rung : model_ladder(body, reduce_options(command, named, body)))
      models.push_back(std::move(rung.options));
  }
  for (const std::string& text : command.models) {
    ReduceOptions options = options_of(command, text, named, body);
    if (std::ranges::find(models, in_words(options), in_words) == models.end()) models.push_back(std::move(options));
  }
  for (ReduceOptions& options : models) {
    if (!command.full_loads) options.full_loads = usual_loads;
    check(options);
  }
  return models;
}

ParetoPoint point_of(const ReduceOptions& options, const ReduceReport& report, double tolerance,
                     const MotionMeasure& motion) {
  return {.model = in_words(options),
          .subspace = options.subspace,
          .modes = options.modes,
          .dimension = report.dimension,
          .points = report.points,
          .tolerance = tolerance,
          .reduce_seconds = report.total_seconds,
          .step_seconds = motion.step_seconds,
          .mean_iterations = motion.mean_iterations,
          .missed_steps = motion.missed_steps,
          .complete = motion.complete,
          .full_error = report.full_error,
          .training_error = report.training_error,
          .held_out_error = report.held_out_error,
          .trajectory_error = motion.trajectory_error};
}

std::string description(const ParetoCommand& command, const Body& body, const ReduceReport& report,
                        const MotionStudy& motions) {
  const SimulationOptions& options = motions.options();
  std::string text = shown_count(report.components) + " " + std::string(component_name(body)) + " (" +
                     std::string(law(body)) + "), " + recipe_of(command) + " recipe. Steps are of " +
                     shown(options.step, 3) + " s, " + shown_count(options.num_steps) + " of them" +
                     (motions.scene().description.empty() ? "" : ": " + motions.scene().description) +
                     ". Measured on " + machine_in_words() + ".";
  if (command.trajectory)
    text += " A step of the full object takes " + shown(1e3 * motions.full_step_seconds(), 3) + " ms.";
  return text;
}

double positive_seconds(const std::string& option, const std::string& text) {
  const double seconds = option_quantity(option, text, "s");
  if (!(seconds > 0)) throw InputError(option + " is " + shown(seconds) + " s, expected > 0");
  return seconds;
}

/// The models, one after the other; each is measured before the next one is made.
class Sweep {
 public:
  Sweep(const ParetoCommand& command, const Body& body) : command_(command), series_(body, progress_) {
    if (command.scene) scene_ = read_scene(*command.scene, body);
    if (command.time) duration_ = positive_seconds("--time", *command.time);
    if (command.step) step_ = positive_seconds("--step", *command.step);
  }

  void add(const ReduceOptions& options) {
    const Stopwatch watch;
    ReduceReport report;
    ReducedModel model;
    if (!attempt(options, [&] { model = series_.make(options, report); })) return;
    for (const std::string& note : report.notes) warn(in_words(options) + ": " + note);
    times.add("models", watch.seconds());
    if (!motions) begin_motions(model);
    attempt(options, [&] { measure(model, options, report); });
    if (first_report.components == 0) first_report = std::move(report);
  }

  std::vector<ParetoPoint> points;
  std::optional<MotionStudy> motions;
  ReduceReport first_report;
  StageTimes times;
  std::string last_failure;

 private:
  /// Whether there is an answer; a model without one is left out.
  template <typename Work>
  bool attempt(const ReduceOptions& options, const Work& work) {
    try {
      work();
      return true;
    } catch (const SolverError& failure) {
      last_failure = in_words(options) + " is left out: " + failure.what();
      warn(last_failure);
      return false;
    }
  }

  void begin_motions(const ReducedModel& model) {
    Scene scene = scene_ ? *scene_ : pluck_scene(model);
    if (duration_) scene.duration = duration_;
    if (step_) scene.step = step_;
    MotionStudy study(std::move(scene), model);
    const Stopwatch watch;
    if (command_.trajectory) study.run_full(model, progress_);
    times.add("full motion", watch.seconds());
    motions = std::move(study);
  }

  void measure(const ReducedModel& model, const ReduceOptions& options, const ReduceReport& report) {
    const Stopwatch watch;
    std::vector<double> tolerances = command_.tolerances;
    if (tolerances.empty()) tolerances = {motions->options().steps.tolerance};
    for (const double tolerance : tolerances) {
      const ParetoPoint& point =
          points.emplace_back(point_of(options, report, tolerance, motions->measure(model, tolerance, progress_)));
      if (!point.complete)
        warn(point.model + ": the motion does not run to its end");
      else if (point.missed_steps > 0)
        warn(point.model + ": " + std::to_string(point.missed_steps) + " of " +
             std::to_string(motions->options().num_steps) + " steps missed the tolerance " + shown(tolerance));
    }
    times.add("motions", watch.seconds());
  }

  const ParetoCommand& command_;
  const Progress progress_ = progress_bar();
  ModelSeries series_;
  std::optional<Scene> scene_;
  std::optional<double> duration_, step_;  // instead of the scene's [s]
};

}  // namespace

void ParetoCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  if (tolerances.size() > 1 && !trajectory)
    throw InputError("--tolerances holds several, whose errors show in motions only: expected --trajectory, too");
  const NamedMesh named = load_mesh(mesh, mesh_unit);
  const Body body = load_body(*this, named);
  if (const auto note = locking_note(*this, body)) warn(*note);
  Sweep sweep(*this, body);
  const std::vector<ReduceOptions> wanted = models_to_make(*this, named, body);
  const OutputFolder folder(output);
  keep_stages(Checkpoint(checkpoint));
  const ParetoError error = trajectory ? ParetoError::Trajectory : ParetoError::Equilibria;
  std::vector<ParetoPoint>& points = sweep.points;
  for (const ReduceOptions& model : wanted) {
    sweep.add(model);
    mark_front(points, error);
    if (!output.empty() && !points.empty())
      write_points(output / "pareto.csv", points);  // hours of work survive an end
  }
  clear_progress();
  if (points.empty()) throw SolverError("no model could be measured; " + sweep.last_failure);

  const std::string title = "Time and error of models of " + mesh,
                    text = description(*this, body, sweep.first_report, *sweep.motions),
                    table = markdown_table(points, error);
  Json report;
  report["command"] = "pareto";
  report["version"] = SUPPLE_VERSION;
  report["mesh"] = mesh;
  report["description"] = text;
  const SimulationOptions& steps = sweep.motions->options();
  report["scene"] = {{"source", scene ? scene->string() : "pluck"},
                     {"description", sweep.motions->scene().description},
                     {"step", steps.step},
                     {"steps", steps.num_steps},
                     {"integrator", steps.integrator.name}};
  report["machine"] = {{"processor", processor_name()}, {"threads", num_threads()}};
  report["front_of"] = trajectory ? "trajectory_error" : "full_error";
  report["points"] = points_json(points);
  report["full_step_seconds"] = sweep.motions->full_step_seconds();
  report["options"] = problem_json(*this, wanted.front(), body);
  for (const char* own : {"subspace", "modes", "dimension"}) report["options"].erase(own);  // each model has its own
  report["seconds"] = json_seconds(sweep.times.seconds(), sweep.times.total());
  report["peak_memory"] = peak_resident_memory();
  if (!output.empty()) {
    {
      const ExitGuard guard;
      write_file(output / "pareto.md",
                 "# " + title + "\n\n" + text + "\n\n" + table + "\n" + pareto_notes(error) + "\n");
    }
    std::filesystem::path plot = output / "pareto.png";
    if (!can_plot()) {
      warn("gnuplot is not installed: there will be no pareto.png");
      plot.clear();
    } else if (!draw_pareto_plot(plot, title, points, error)) {
      warn("no model has a time and an error to draw: there will be no pareto.png");
      plot.clear();
    }
    write_pareto_page(output / "pareto.html", title, text, points, error, plot);
    write_json(output / "pareto.json", report);
  }
  if (!is_stdout(json)) std::fputs((title + "\n" + text + "\n\n" + table).c_str(), stdout);
  write_json(json, report);
}

void ParetoCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("pareto", "Measure time and error of models, from coarse to fine");
  declare_object(command, *this);
  declare_snapshots(command, *this);
  declare_seed(command, seed);
  declare_fitting(command, *this);
  declare_full_loads(command, *this, /*least=*/1);
  declare_checkpoint(command, *this);
  const auto sweep = "Sweep";
  command
      .add_option(
          "--models", models,
          "Subspaces and sizes, separated by commas, with modes, dimension and points as further options [those "
          "that the object is large enough for, see docs/command.md]")
      ->delimiter(',')
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(model_words())
      ->group(sweep);
  command.add_option("--scene", scene, "What models run, see docs/scene.md; without: pulled, then released")
      ->type_name("FILE.json")
      ->group(sweep);
  command.add_option("--time", time, "Duration [s], instead of the scene's")->type_name("T")->group(sweep);
  command.add_option("--step", step, "Time step [s], instead of the scene's")->type_name("H")->group(sweep);
  command
      .add_option("--tolerances", tolerances,
                  "Relative residuals of steps, separated by commas: a point each; several with --trajectory [1e-6]")
      ->delimiter(',')
      ->type_name("SHARE")
      ->check(positive_number())
      ->group(sweep);
  command
      .add_flag("--trajectory", trajectory,
                "Compare motions with that of the full object, too, which runs the scene once and takes long")
      ->group(sweep);
  command.add_option("-o,--output", output, "Folder for pareto.csv, .json, .md, .png and the page pareto.html")
      ->type_name("DIR");
  declare_json(command, json);
  declare_threads(command, threads);
  command.footer([] {
    return material_help() + "\n" + subspace_help() + "\n" + builtin_help() +
           "\nExamples:\n"
           "supple pareto dragon.msh --fix 'y<4%' -o front\n"
           "supple pareto dragon.msh --fix 'y<4%' --models derivatives:modes=10:dimension=40:points=60,"
           "extended:points=100,extended:points=200 --trajectory -o front";
  });
  command.callback([this] { run(); });
}

}  // namespace supple
