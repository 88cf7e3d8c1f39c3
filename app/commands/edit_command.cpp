#include <app/commands/edit_command.hpp>
#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/frames.hpp>
#include <core/check.hpp>
#include <core/median.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <io/table/csv.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <physics/body/body_system.hpp>
#include <physics/system/node_numbering.hpp>
#include <reduction/editing/editor.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <viewer/scene/edit_scene_file.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

struct SolveRecord {
  SolveReport report;
  double elastic = 0, control = 0;  ///< energies [J]
  double held = 0;                  ///< control_displacement() over the diagonal
  double left = 0;                  ///< what forces leave, rms over the free unknowns of all nodes [N]
  double seconds = 0;               ///< of the solve
};

/// What is asked of an object, reduced or full.
struct EditProblem {
  const Points& rest;  ///< positions [m]
  std::vector<Handle> handles;
  const Loads& loads;                          ///< beside the handles
  std::vector<std::vector<RigidMotion>> path;  ///< of all handles in every solve
  double softest_eigenvalue, mass, diagonal;   ///< of the object [1/s², kg, m]
};

struct EditRun {
  std::vector<SolveRecord> solves;
  RowMatrix states;  ///< (1 + solves) × coordinates: those of the model, or displacements of all nodes
};

/// Solves along the paths. \param frame  unknowns → what a frame keeps.
/// \param nodal  forces in the unknowns → rms of those on nodes [N].
/// \param lead  called before solve k with the state to start from, which it may improve.
template <typename MatrixType, typename Frame, typename Nodal, typename Lead>
EditRun run_edits(const AnySystem<MatrixType>& system, const EditProblem& problem, const StaticOptions& options,
                  const Frame& frame, const Nodal& nodal, const Lead& lead, const Progress& progress) {
  const auto& [rest, handles, loads, path, softest_eigenvalue, mass, diagonal] = problem;
  Editor editor(system, rest, options);
  for (const Handle& handle : handles) (void)editor.add(handle);
  editor.set_loads(loads);
  EditRun run;
  const Vector start = frame(editor.state());
  run.states.resize(static_cast<Index>(path.size()) + 1, start.size());
  run.states.row(0) = start.transpose();
  for (std::size_t k = 0; k < path.size(); ++k) {
    for (std::size_t h = 0; h < handles.size(); ++h) editor.move(static_cast<Index>(h), path[k][h]);
    const Stopwatch watch;
    editor.start_from(lead(static_cast<Index>(k), editor.state()));
    SolveRecord record{editor.solve()};
    record.seconds = watch.seconds();
    const Vector u = system.expand(editor.state());
    record.elastic = editor.elastic_energy();
    record.control = editor.control_energy(u);
    record.held = control_displacement(editor.handles(), rest, u, softest_eigenvalue, mass) / diagonal;
    record.left = nodal(editor.imbalance());
    run.solves.push_back(record);
    run.states.row(static_cast<Index>(k) + 1) = frame(editor.state()).transpose();
    tell(progress, "edits", static_cast<double>(k + 1) / static_cast<double>(path.size()));
    if (record.report.status == Status::NotFinite)
      throw SolverError("solve " + std::to_string(k + 1) + " is not finite; more increments may help");
  }
  return run;
}

void write_solves(const std::filesystem::path& path, const EditRun& run) {
  CsvTable table{{"solve"},    {"elastic", "J"}, {"control", "J"}, {"held"},   {"iterations"},
                 {"tangents"}, {"residual"},     {"left", "N"},    {"status"}, {"seconds", "s"}};
  for (std::size_t k = 0; k < run.solves.size(); ++k) {
    const SolveRecord& solve = run.solves[k];
    table.add_row(k + 1, solve.elastic, solve.control, solve.held, solve.report.iterations, solve.report.tangents,
                  solve.report.residual, solve.left, to_string(solve.report.status), solve.seconds);
  }
  const ExitGuard guard;
  write_csv(path, table);
}

StaticOptions decide(const EditCommand& command, const EditScene& scene) {
  StaticOptions options;
  options.solver = scene.solver.value_or(Newton{});
  if (command.solver) options.solver = solver_named(static_solvers, *command.solver);
  if (command.full && std::holds_alternative<Nlopt>(options.solver)) {
    if (command.solver) throw InputError("--solver nlopt is for reduced systems");
    options.solver = Newton{};
  }
  options.tolerance = command.tolerance.value_or(scene.tolerance.value_or(options.tolerance));
  if (!(options.tolerance > 0)) throw InputError("the tolerance is not positive, expected > 0");
  options.max_iterations = scene.max_iterations.value_or(options.max_iterations);
  return options;
}

}  // namespace

void EditCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  StageTimes times;
  const ReducedModel reduced = load_model(model);
  std::vector<std::string> warnings;
  const EditScene edits = read_edit_scene(scene, reduced.body, &warnings);
  for (const std::string& warning : warnings) warn(warning);
  const StaticOptions options = decide(*this, edits);
  const Points& rest = node_positions(reduced.body);
  const ReducedModes modes = reduced_modes(reduced);
  if (modes.num_zero == modes.omega.size()) throw SolverError("the model has no flexible mode");
  const Vector masses = nodal_mass(reduced.body);
  const double softest = modes.softest_stiffness(), mass = masses.sum();
  const std::vector<Handle> handles = make_handles(edits, softest, mass);
  const EditProblem problem{
      rest, handles, edits.loads, handle_paths(edits, handles, rest), softest, mass, bounding_box(rest).diagonal()};
  const OutputFolder folder(output);
  times.finish("read model");

  const Progress progress = progress_bar();
  const auto as_it_is = [](Index, const Vector& state) { return state; };
  StaticOptions reduced_options = options;
  if (full) reduced_options.solver = Newton{};
  const NodeNumbering numbering(num_nodes(reduced.body), fixed_nodes(reduced.body), held_axes(reduced.body));
  const double unknowns = std::sqrt(3 * static_cast<double>(numbering.num_free()));
  const AnySystem<Matrix> reduced_system = reduced.system();
  EditRun result = run_edits(
      reduced_system, problem, reduced_options, [](VectorIn q) -> Vector { return q; },
      [&](VectorIn g) {  // M U g are the forces in the subspace
        Vector f = reduced_system.expand(g);
        for (Index v = 0; v < masses.size(); ++v) f.segment<3>(3 * v) *= masses[v];
        return f.norm() / unknowns;
      },
      as_it_is, full ? Progress() : progress);
  if (full) {
    const AnySystem<SparseMatrix> system = full_system(reduced.body);
    // each solve begins where the reduced model says that the handles lead
    const auto led = [&](Index k, const Vector& state) -> Vector {
      const Vector way = (result.states.row(k + 1) - result.states.row(k)).transpose();
      return state + numbering.restrict(
                         std::visit([&](const auto& basis) { return basis->reconstruct(way); }, reduced.subspace), 3);
    };
    result = run_edits(
        system, problem, options, [&](VectorIn u) { return system.expand(u); },
        [&](VectorIn g) { return g.norm() / unknowns; }, led, progress);
  }
  times.finish("edits");
  const Index frames_count = result.states.rows();
  double reconstruction = 0;
  if (!output.empty()) {
    Trajectory trajectory{.reduced = !full,
                          .model = std::filesystem::absolute(model).lexically_normal(),
                          .model_checksum = header_checksum(model),
                          .step = 1,
                          .steps_per_second = 0,
                          .time = Vector::LinSpaced(frames_count, 0, static_cast<double>(frames_count - 1)),
                          .kinetic = Vector::Zero(frames_count),
                          .elastic = Vector::Zero(frames_count),
                          .work = Vector::Zero(frames_count),
                          .u = result.states,
                          .v = RowMatrix::Zero(frames_count, result.states.cols())};
    for (Index k = 1; k < frames_count; ++k) trajectory.elastic[k] = result.solves[k - 1].elastic;
    save_trajectory(output / trajectory_file, trajectory);
    write_solves(output / "solves.csv", result);
    reconstruction = write_frames(
        output, frames, reduced, trajectory,
        [](double k) { return k == 0 ? std::string("rest") : "solve " + shown(k); }, progress);
    times.finish("results");
  }
  clear_progress();

  std::vector<double> solve_seconds;
  Index missed = 0, iterations = 0, strained = 0;
  double worst = 0, most_held = 0, most_left = 0;
  for (const SolveRecord& solve : result.solves) {
    solve_seconds.push_back(solve.seconds);
    missed += solve.report.status != Status::Converged;
    iterations += solve.report.iterations;
    worst = std::max(worst, solve.report.residual);
    strained += solve.held > held_over_diagonal_at_most;
    most_held = std::max(most_held, solve.held);
    most_left = std::max(most_left, solve.left);
  }
  const double median_seconds = median(std::move(solve_seconds));
  const SolveRecord& last = result.solves.back();
  Json report;
  report["command"] = "edit";
  report["version"] = SUPPLE_VERSION;
  report["model"] = model.string();
  report["scene"] = scene.string();
  report["description"] = edits.description;
  report["system"] = full ? "full" : "reduced";
  report["solver"] = name_of_solver(static_solvers, options.solver);
  report["tolerance"] = options.tolerance;
  report["handles"] = Json::array();
  for (std::size_t h = 0; h < handles.size(); ++h)
    report["handles"].push_back({{"name", edits.handles[h].name},
                                 {"nodes", edits.handles[h].nodes.size()},
                                 {"samples", handles[h].samples.size()},
                                 {"weight", handles[h].weight}});
  report["solves"] = result.solves.size();
  report["missed_solves"] = missed;
  report["mean_iterations"] = static_cast<double>(iterations) / static_cast<double>(result.solves.size());
  report["worst_residual"] = worst;
  report["most_force_left"] = most_left;
  report["median_solve_seconds"] = median_seconds;
  report["reconstruction_seconds"] = reconstruction;
  report["elastic_energy"] = last.elastic;
  report["control_energy"] = last.control;
  report["held_over_diagonal"] = last.held;
  report["most_held_over_diagonal"] = most_held;
  report["threads"] = num_threads();
  report["seconds"] = json_seconds(times.seconds(), times.total());
  report["peak_memory"] = peak_resident_memory();
  if (!output.empty()) write_json(output / "report.json", report);
  if (!is_stdout(json)) {
    Rows rows{{"scene", edits.description},
              {"system", full ? "full" : "reduced, dimension " + std::to_string(reduced.dim())},
              {"solves", std::to_string(result.solves.size()) + " by " +
                             std::string(name_of_solver(static_solvers, options.solver)) + ", " +
                             shown(report["mean_iterations"].get<double>(), 3) + " iterations each, median " +
                             shown(1e3 * median_seconds, 3) + " ms"},
              {"residual", "at most " + shown(worst, 2) + ", asked for " + shown(options.tolerance) + "; " +
                               shown(most_left, 2) + " N an unknown (rms)"},
              {"energy", shown(last.elastic) + " J elastic, " + shown(last.control) + " J of the handles"},
              {"handles hold", "as much as displaces the softest mode by " + shown_percent(last.held, 2) +
                                   " of the diagonal (at most " + shown_percent(most_held, 2) + ")"}};
    if (reconstruction > 0)
      rows.emplace_back("reconstruction", shown(1e3 * reconstruction / static_cast<double>(frames_count), 3) +
                                              " ms a frame of all nodes");
    if (!output.empty()) rows.emplace_back("results", output.string());
    print_rows(stdout, "edit of " + model.string(), rows);
    print_stages(stdout, times.seconds(), times.total());
  }
  write_json(json, report);
  if (missed > 0)
    warn(std::to_string(missed) + " of " + std::to_string(result.solves.size()) + " solves missed the tolerance " +
         shown(options.tolerance) + " (worst residual " + shown(worst, 2) + "); try more increments");
  if (!full && strained > 0)
    warn(
        "in " + std::to_string(strained) + " of " + std::to_string(result.solves.size()) +
        " solves the subspace does not follow the handles, and shapes may be off by as much as they hold, up to " +
        shown_percent(most_held, 2) + " of the diagonal (in the last: " + shown(last.control, 2) + " J beside " +
        shown(last.elastic, 2) +
        " J elastic); --full solves for the full shape; softer handles ('weight') help, and so do more extended modes");
}

void EditCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("edit", "Deform an object by moving handles on it");
  command.add_option("MODEL", model, "Model that 'supple reduce' made")->required();
  command.add_option("--scene", scene, "Handles and their motions, see docs/edit-scene.md")
      ->required()
      ->type_name("FILE.json");
  command.add_flag("--full", full, "Solve the unreduced system, the reference");
  command.add_option("--solver", solver, "Of the equilibrium [newton]")
      ->check(CLI::IsMember(solver_names(static_solvers)));
  command.add_option("--tolerance", tolerance, "Residual of a solve against the forces of the object [1e-6]");
  command.add_option("--frames", frames, "What ParaView gets of every solve")
      ->capture_default_str()
      ->check(known_in(frame_writers()));
  command.add_option("-o,--output", output, "Folder for picture.png, series.pvd, solves.csv, trajectory and report")
      ->type_name("DIR");
  declare_json(command, json);
  declare_plugins(command);
  declare_threads(command, threads);
  command.footer("Example:\nsupple edit cactus.supple --scene bend.json -o bent");
  command.callback([this] { run(); });
}

}  // namespace supple
