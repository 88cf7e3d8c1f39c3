#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/commands/simulate_command.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/frames.hpp>
#include <app/scene/simulation.hpp>
#include <app/scene/trajectory.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <io/frames/vtu_writer.hpp>
#include <io/picture/plot.hpp>
#include <io/table/csv.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <physics/body/reactions.hpp>
#include <physics/load/outside_force_library.hpp>
#include <physics/time/integrator_library.hpp>
#include <reduction/model/reduced_model.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

namespace supple {

namespace {

std::vector<Index> tracked_nodes(const std::vector<Index>& places_to_track, const Body& body) {
  const NodePlaces& places = node_places(body);
  const Index count = places.num_places(num_nodes(body));
  std::vector<Index> nodes;
  for (const Index place : places_to_track) {
    if (place < 0 || place >= count)
      throw InputError("--track: there is no node " + std::to_string(place) + ", expected 0 to " +
                       std::to_string(count - 1));
    nodes.push_back(places.node(place));
    if (nodes.back() < 0) throw InputError("--track: no cell has node " + std::to_string(place));
  }
  return nodes;
}

/// The scene with the command line's word on top, and all that was left open decided.
SimulationOptions decide(const SimulateCommand& command, const ReducedModel& model, Scene& scene) {
  if (command.time) scene.duration = option_quantity("--time", *command.time, "s");
  if (command.step) scene.step = option_quantity("--step", *command.step, "s");
  if (command.time && !command.step && !command.scene)  // nobody has asked for a longer step
    scene.step = std::min(*scene.step, *scene.duration);
  if (command.solver) scene.solver = solver_named(step_solvers, *command.solver);
  if (command.tolerance) scene.tolerance = *command.tolerance;
  if (command.halvings) scene.max_halvings = *command.halvings;
  if (command.every) scene.every = *command.every;
  if (!command.track.empty()) scene.track = tracked_nodes(command.track, model.body);
  if (command.every && *command.every < 1)
    throw InputError("--every is " + std::to_string(*command.every) + ", expected at least 1");
  if (command.integrator) scene.integrator = Choice::parse(*command.integrator);
  if (command.solver && !is_step_solver_for(command.full, *scene.solver))
    throw InputError("--solver " + *command.solver + " is for " +
                     (command.full ? "reduced systems; --full runs with warped-bfgs or newton"
                                   : "full systems (--full); reduced ones run with bfgs, broyden or newton"));
  if (command.full && command.precision) throw InputError("--precision is for reduced systems, not for --full");
  SimulationOptions options = complete(scene, model);
  if (energy_behaviour(options.integrator) == EnergyBehaviour::BoundedForShortSteps)
    warn("with 2 beta < gamma, " + options.integrator.name +
         " lets motions grow that are fast against the step; beta = (gamma + 0.5)^2 / 4 does not");
  if (command.precision) options.precision = value_named<RowPrecision>(*command.precision, "precision");
  return command.full ? for_full_system(options) : options;
}

void write_energies(const std::filesystem::path& path, const Simulation& run) {
  CsvTable table{{"time", "s"}, {"kinetic", "J"}, {"elastic", "J"}, {"work", "J"}, {"damped", "J"},
                 {"made", "J"}, {"iterations"},   {"refreshes"},    {"residual"},  {"status"}};
  for (const StepRecord& step : run.steps) {
    const bool is_end = !run.complete() && &step == &run.steps.back();
    table.add_row(step.time, step.energy.kinetic, step.energy.elastic, step.energy.work, step.energy.damped,
                  step.energy.made(), step.iterations, step.refreshes, step.residual,
                  is_end ? to_string(run.ending) : to_string(step.status));
  }
  const ExitGuard guard;
  write_csv(path, table);
}

void write_errors(const std::filesystem::path& path, const std::vector<ErrorRecord>& errors) {
  CsvTable table{{"time", "s"},  {"fit", "m"},          {"outside", "m"},
                 {"total", "m"}, {"displacement", "m"}, {"beyond_training"}};
  for (const ErrorRecord& error : errors)
    table.add_row(error.time, error.fit, error.outside, error.total, error.size, error.beyond_training ? 1 : 0);
  const ExitGuard guard;
  write_csv(path, table);
}

/// Resultant of what supports exert, in every frame.
void write_reactions(const std::filesystem::path& path, const Scene& scene, const RayleighDamping& damping,
                     const Trajectory& trajectory, const ReducedModel& model) {
  const Reactions reactions(model.body);
  CsvTable table{{"time", "s"}, {"rx", "N"}, {"ry", "N"}, {"rz", "N"}, {"mx", "N m"}, {"my", "N m"}, {"mz", "N m"}};
  for (Index k = 0; k < trajectory.num_frames(); ++k) {
    const Vector u = frame_displacement(trajectory, model, k), v = frame_velocity(trajectory, model, k);
    const Points r = reactions(u, loads_at(scene, trajectory.time[k]), v, damping);
    const auto [force, moment] = reactions.resultant(r, node_positions(model.body) + as_points(u));
    table.add_row(trajectory.time[k], force[0], force[1], force[2], moment[0], moment[1], moment[2]);
  }
  const ExitGuard guard;
  write_csv(path, table);
}

void write_tracked(const std::filesystem::path& path, const Scene& scene, const NodePlaces& places,
                   const Simulation& run) {
  std::vector<CsvTable::Column> columns{{"time", "s"}};
  for (const Index node : scene.track)
    for (const char* axis : {"x", "y", "z"})
      columns.push_back({"u" + std::string(axis) + std::to_string(places.place(node)), "m"});
  CsvTable table(columns);
  for (std::size_t k = 0; k < run.steps.size(); ++k) {
    std::vector<std::string> row{exact(run.steps[k].time)};
    for (Index j = 0; j < run.tracked.cols(); ++j) row.push_back(exact(run.tracked(k, j)));
    table.add_cells(std::move(row));
  }
  const ExitGuard guard;
  write_csv(path, table);
}

void draw_energies(const std::filesystem::path& path, const Simulation& run) {
  const Index count = static_cast<Index>(run.steps.size());
  Vector time(count), kinetic(count), elastic(count), work(count), accounted(count);
  for (Index k = 0; k < count; ++k) {
    time[k] = run.steps[k].time;
    const EnergyBalance& energy = run.steps[k].energy;
    kinetic[k] = energy.kinetic;
    elastic[k] = energy.elastic;
    work[k] = energy.work;
    accounted[k] = energy.start + energy.work - energy.damped;
  }
  const ExitGuard guard;
  draw_plot(path, {.title = "Energy",
                   .x = {.label = "time [s]", .low = 0.0, .high = time[count - 1]},
                   .y = {.label = "energy [J]"},
                   .series = {{"kinetic", time, kinetic},
                              {"elastic", time, elastic},
                              {"kinetic + elastic", time, kinetic + elastic},
                              {"work of loads", time, work, PlotStyle::DashedLine},
                              {"work less what damping took", time, accounted, PlotStyle::DashedLine}}});
}

Json report_json(const SimulateCommand& command, const Scene& scene, const NodePlaces& places,
                 const SimulationOptions& options, const Simulation& run) {
  const Effort& effort = run.effort;
  Json json;
  json["command"] = "simulate";
  json["version"] = SUPPLE_VERSION;
  json["model"] = command.model.string();
  json["system"] = command.full ? "full" : "reduced";
  json["unknowns"] = run.unknowns;
  json["scene"] = command.scene ? command.scene->string() : "pluck";
  json["description"] = scene.description;
  json["status"] = to_string(run.ending);
  json["duration"] = run.last_good.time;
  json["step"] = options.step;
  json["steps"] = run.num_steps;
  json["integrator"] = options.integrator.name;
  for (const auto& [option, value] : options.integrator.options) json["integrator_options"][option] = value;
  json["solver"] = name_of_solver(step_solvers, options.steps.solver);
  json["tolerance"] = options.steps.tolerance;
  if (!command.full) json["precision"] = name_of(options.precision);
  json["steps_per_second"] = effort.steps_per_second();
  json["mean_iterations"] = effort.mean_iterations();
  json["most_iterations"] = effort.most_iterations;
  json["refreshes"] = effort.refreshes;
  json["worst_residual"] = effort.worst_residual;
  json["missed_steps"] = effort.missed;
  json["halved_steps"] = run.halved_steps;
  json["rescued_parts"] = run.rescued_parts;
  const EnergyBalance& energy = run.last_good.energy;
  json["energy"] = {{"kinetic", energy.kinetic},
                    {"elastic", energy.elastic},
                    {"work", energy.work},
                    {"damped", energy.damped},
                    {"made", energy.made()},
                    {"most_made", effort.energy_made()},
                    {"most_taken", effort.energy_taken()}};
  if (run.indicated.estimates > 0)
    json["indicated_error"] = {{"relative", run.indicated.relative()},
                               {"worst", run.indicated.worst()},
                               {"worst_time", run.indicated.worst_time},
                               {"estimates", run.indicated.estimates},
                               {"beyond_training", run.indicated.beyond_training},
                               {"share_of_steps", run.estimate_seconds / effort.seconds}};
  json["rows_every"] = run.stride;
  json["frames"] = run.times.size();
  json["every"] = options.every;
  json["tracked"] = Json::array();
  for (std::size_t j = 0; j < scene.track.size(); ++j)
    json["tracked"].push_back(
        {{"node", places.place(scene.track[j])}, {"largest_displacement", run.reach[static_cast<Index>(j)]}});
  json["threads"] = num_threads();
  return json;
}

void print_summary(const SimulateCommand& command, const Scene& scene, const NodePlaces& places,
                   const SimulationOptions& options, const Simulation& run, double reconstruction) {
  const Effort& effort = run.effort;
  Rows rows{
      {"scene", scene.description},
      {"system", (command.full ? "full, " : "reduced, ") + shown_count(run.unknowns) + " unknowns"},
      {"steps", shown_count(run.num_steps) + " of " + shown(options.step, 3) + " s"},
      {"speed", shown(effort.steps_per_second()) + " steps/s, " + shown(effort.steps_per_second() * options.step, 3) +
                    " times real time"},
      {"iterations", shown(effort.mean_iterations(), 3) + " a step, " + std::to_string(effort.most_iterations) +
                         " at most; " + shown_count(effort.refreshes) + " tangents"},
      {"residual", "at most " + shown(effort.worst_residual, 2) + ", asked for " + shown(options.steps.tolerance)}};
  if (run.halved_steps > 0)
    rows.emplace_back(
        "halved steps",
        shown_count(run.halved_steps) + " were taken in parts" +
            (run.rescued_parts > 0 ? ", " + shown_count(run.rescued_parts) + " of these by backward Euler" : ""));
  rows.emplace_back("energy balance", "the integrator made at most " + shown_percent(effort.energy_made()) +
                                          " of what loads brought, took at most " +
                                          shown_percent(effort.energy_taken()));
  if (run.indicated.estimates > 0)
    rows.emplace_back("indicated error", shown_percent(run.indicated.relative()) + ", at worst " +
                                             shown_percent(run.indicated.worst()) +
                                             " at t = " + shown(run.indicated.worst_time, 3) + " s");
  if (reconstruction > 0)
    rows.emplace_back("reconstruction", shown(1e3 * reconstruction / static_cast<double>(run.times.size()), 3) +
                                            " ms a frame of all nodes");
  for (std::size_t j = 0; j < scene.track.size(); ++j)
    rows.emplace_back("node " + std::to_string(places.place(scene.track[j])),
                      "displaced by at most " + shown(run.reach[static_cast<Index>(j)], 3) + " m");
  if (!command.output.empty()) rows.emplace_back("results", command.output.string());
  print_rows(stdout, "simulation of " + command.model.string(), rows);
}

}  // namespace

void SimulateCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  StageTimes times;
  const ReducedModel reduced = load_model(model);
  const NodePlaces& places = node_places(reduced.body);
  Scene what = scene ? read_scene(*scene, reduced.body) : pluck_scene(reduced);
  const SimulationOptions options = decide(*this, reduced, what);
  const OutputFolder folder(output);
  times.finish("read model");

  const Progress progress = progress_bar();
  const Simulation result =
      full ? simulate_full(reduced.body, what, options, progress) : simulate_reduced(reduced, what, options, progress);
  times.add("setup", result.setup_seconds);
  times.add("time steps", result.effort.seconds);
  times.add("energies and frames", times.current() - result.setup_seconds - result.effort.seconds);
  times.restart();
  const Effort& effort = result.effort;
  const IndicatedError& indicated = result.indicated;
  double reconstruction = 0;
  if (!output.empty()) {
    Trajectory trajectory = trajectory_of(result, options, !full);
    trajectory.model = std::filesystem::absolute(model).lexically_normal();
    trajectory.model_checksum = header_checksum(model);
    save_trajectory(output / trajectory_file, trajectory);
    write_energies(output / "energies.csv", result);
    write_tracked(output / "tracked.csv", what, places, result);
    if (!is_free(reduced.body))
      write_reactions(output / "reactions.csv", what, options.steps.damping, trajectory, reduced);
    if (!result.errors.empty()) write_errors(output / "errors.csv", result.errors);
    if (result.steps.back().time == 0)
      warn("there is no step to draw: there will be no energy.png");
    else if (can_plot())
      draw_energies(output / "energy.png", result);
    else
      warn("gnuplot is not installed: there will be no energy.png");
    reconstruction = write_frames(
        output, frames, reduced, trajectory, [](double t) { return "t = " + shown(t, 3) + " s"; }, progress);
    times.finish("results");
  }
  clear_progress();
  Json report = report_json(*this, what, places, options, result);
  report["reconstruction_seconds"] = reconstruction;
  report["seconds"] = json_seconds(times.seconds(), times.total());
  report["peak_memory"] = peak_resident_memory();
  if (!output.empty()) write_json(output / "report.json", report);
  if (!is_stdout(json)) {
    print_summary(*this, what, places, options, result, reconstruction);
    print_stages(stdout, times.seconds(), times.total());
  }
  write_json(json, report);
  if (!result.complete()) throw SolverError(reason_to_end(result, options) + "; the results end before it");
  if (indicated.beyond_training > 0)
    warn("from t = " + shown(indicated.first_beyond, 3) + " s on " + std::to_string(indicated.beyond_training) +
         " of " + std::to_string(indicated.estimates) +
         " states are larger than what forces were fitted to; they may be wrong by more than is indicated");
  if (effort.makes_energy())
    warn("the integrator, " + options.integrator.name + ", made " + shown_percent(effort.energy_made()) +
         " of energy that no load brought; a shorter --step, or --integrator average-vector-field or backward-euler, "
         "may help");
  if (effort.missed > 0)
    warn(std::to_string(effort.missed) + " of " + std::to_string(result.num_steps) + " steps missed the tolerance " +
         shown(options.steps.tolerance) + " (worst residual " + shown(effort.worst_residual, 2) +
         "); try a shorter --step or --solver newton");
}

void SimulateCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("simulate", "Run a scene with a reduced model, or with the full one");
  command.add_option("MODEL", model, "Model that 'supple reduce' made")->required();
  declare_plugins(command);
  command
      .add_option("--scene", scene, "Loads and springs over time, see docs/scene.md; without: pulled, then released")
      ->type_name("FILE.json");
  command.add_flag("--full", full, "Run the unreduced system instead: all nodes");
  command.add_option("--time", time, "Duration [s], instead of the scene's")->type_name("T");
  command.add_option("--step", step, "Time step [s], instead of the scene's")->type_name("H");
  command.add_option("--integrator", integrator, "How it moves in time, see below [average-vector-field]")
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(known_in(integrators()));
  command.add_option("--solver", solver, "Nonlinear solver [bfgs; full: warped-bfgs]")
      ->check(CLI::IsMember(solver_names(step_solvers)));
  command.add_option("--halvings", halvings, "How often a step that fails may be halved [6]")
      ->type_name("N")
      ->check(CLI::Range(0, 20));
  command.add_option("--tolerance", tolerance, "Relative residual of a step [1e-6]")
      ->type_name("SHARE")
      ->check(positive_number());
  command
      .add_option(
          "--precision", precision,
          "Of the basis where components are, as kept for forces; sums are double [dense bases: single, others: "
          "double]")
      ->check(CLI::IsMember(all_names_of<RowPrecision>()));
  command.add_option("-o,--output", output, "Folder for trajectory, energies, pictures and ParaView's series.pvd")
      ->type_name("DIR");
  command.add_option("--every", every, "A frame after so many steps [at most 100 frames]")->type_name("N");
  command.add_option("--frames", frames, "What ParaView gets: surface, cells or none")
      ->capture_default_str()
      ->check(known_in(frame_writers()));
  command.add_option("--track", track, "Node whose displacement is recorded in every step; may be repeated")
      ->type_name("NODE")
      ->expected(1)
      ->take_all();
  declare_json(command, json);
  declare_threads(command, threads);
  command.footer([] {
    return "Integrators and their options:\n" + described(integrators()) + "\nForces from outside, of scenes:\n" +
           described(outside_forces()) +
           "\nExamples:\n"
           "supple simulate octopus.supple -o run\n"
           "supple simulate octopus.supple --full --time 0.1 -o full\n"
           "supple simulate octopus.supple --integrator generalized-alpha:rho_infinity=0.5\n"
           "supple simulate dragon.supple --scene pull.json --step '2 ms' --json -";
  });
  command.callback([this] { run(); });
}

}  // namespace supple
