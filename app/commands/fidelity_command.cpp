#include <app/commands/fidelity_command.hpp>
#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/parallel.hpp>
#include <core/peak_memory.hpp>
#include <core/stopwatch.hpp>
#include <core/version.hpp>
#include <physics/body/force_models.hpp>
#include <physics/system/any_system.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/editing/editor.hpp>
#include <reduction/pipeline/reduce.hpp>
#include <reduction/system/galerkin_system.hpp>
#include <viewer/scene/edit_scene_file.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace supple {

namespace {

bool names_pca(const std::string& subspace) {
  const std::vector<std::string> parts = parts_of_subspace(subspace);
  return std::ranges::find(parts, "pca") != parts.end();
}

/// The last shape of a scene in one space.
struct Shape {
  std::string name;
  Index dimension = 0;
  Vector displacement;  ///< of all nodes [m]
  double elastic = 0, control = 0;
  double construction_seconds = 0, solve_seconds = 0;
  Index solves = 0, missed = 0;
  std::string led_by;  ///< of the full space: the subspace from whose shape it was found
  // of a subspace: the minimum that the full space finds from its shape; NaN and empty if it finds none
  double own_energy = std::numeric_limits<double>::quiet_NaN();
  Vector own_minimum;

  double energy() const { return elastic + control; }
};

template <ObjectSystem System>
void solve_path(const System& system, const Points& rest, const std::vector<Handle>& handles,
                const std::vector<std::vector<RigidMotion>>& path, const Vector& start, const StaticOptions& options,
                const Progress& progress, Shape& shape) {
  const Stopwatch watch;
  Editor editor(system, rest, options);
  for (const Handle& handle : handles) (void)editor.add(handle);
  editor.start_from(start);
  for (std::size_t k = 0; k < path.size(); ++k) {
    for (std::size_t h = 0; h < handles.size(); ++h) editor.move(static_cast<Index>(h), path[k][h]);
    const SolveReport report = editor.solve();
    if (report.status == Status::NotFinite)
      throw SolverError(shape.name + ": solve " + std::to_string(k + 1) + " is not finite; more increments may help");
    ++shape.solves;
    shape.missed += report.status != Status::Converged;
    tell(progress, shape.name, static_cast<double>(k + 1) / static_cast<double>(path.size()));
  }
  shape.displacement = system.expand(editor.state());
  shape.elastic = editor.elastic_energy();
  shape.control = editor.control_energy(shape.displacement);
  shape.solve_seconds = watch.seconds();
}

/// Area of a shell, volume of a solid.
double measure(const Body& body) {
  double sum = 0;
  if (const Shell* shell = std::get_if<Shell>(&body)) {
    for (Index t = 0; t < shell->mesh.num_triangles(); ++t) sum += triangle_area(shell->mesh, t);
    return sum;
  }
  return visit_solid(body, [&](const auto& solid) {
    for (Index e = 0; e < solid.mesh.num_cells(); ++e) sum += cell_volume(solid.mesh, e);
    return sum;
  });
}

struct Distance {
  double rms = 0;  ///< mass-weighted root mean square, of the diagonal
  double l2 = 0;   ///< L² norm over area or volume, as the paper's Table 2 has it
};

Distance distance(const Body& body, const Vector& a, const Vector& b) {
  const Vector mass = nodal_mass(body), difference = a - b;
  const double rms = std::sqrt(as_points(difference).rowwise().squaredNorm().dot(mass) / mass.sum());
  return {rms / bounding_box(node_positions(body)).diagonal(), rms / std::sqrt(measure(body))};
}

void draw_shapes(const std::filesystem::path& path, const Body& body, const std::vector<Shape>& shapes) {
  const Surface surface(body);
  const Points rest = surface.rows(node_positions(body)),
               reference = surface.rows(as_points(shapes.front().displacement));
  std::vector<PictureObject> objects;
  for (const Shape& shape : shapes) {
    const Points moved = surface.rows(as_points(shape.displacement));
    PictureObject object{.positions = rest + moved, .triangles = surface.triangles};
    if (&shape != &shapes.front()) object.scalar = (moved - reference).rowwise().norm();
    object.caption = shape.name;
    objects.push_back(std::move(object));
  }
  write_coloured_picture(path, objects, "distance [m]", 500 * static_cast<int>(shapes.size()), 700);
}

/// Modes r, at least as many as asked for, whose derivatives can fill d dimensions: r + r (r + 1) / 2 >= d.
Index modes_to_differentiate(Index modes, Index d) {
  while (modes + modes * (modes + 1) / 2 < d) ++modes;
  return modes;
}

/// The full shape of a scene first, then those of the extended basis and of the other subspaces.
std::vector<Shape> shapes_of(const Body& body, const EditScene& edits, const ReduceOptions& options,
                             const std::vector<std::string>& subspaces, const Progress& progress) {
  StaticOptions solver;  // Newton, whatever the scene says: it is the reference
  solver.tolerance = edits.tolerance.value_or(solver.tolerance);
  solver.max_iterations = edits.max_iterations.value_or(solver.max_iterations);
  const Points& rest = node_positions(body);
  std::vector<Shape> shapes(1);
  shapes[0].name = "full";
  with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& force) {
    const auto system =
        std::make_shared<const FullSystem<Model>>(force, nodal_mass(body), fixed_nodes(body), held_axes(body));
    std::vector<Handle> handles;
    std::vector<std::vector<RigidMotion>> path;
    Index d = options.dimension;
    const auto in_subspace = [&](const std::string& name, auto&& visit) {
      SubspaceChoice choice = options.subspace_choice();
      choice.name = name;
      choice.dimension = parts_of_subspace(name).size() == 1 ? d : 0;  // a sum has what its parts have
      if (name == "derivatives") choice.modes = modes_to_differentiate(choice.modes, d);
      std::visit(visit, build_subspace(system->rest_state(), choice, {.progress = progress}));
    };
    // the extended basis first: it sets the dimension and the handles
    std::vector<std::string> order{"extended"};
    for (const std::string& name : subspaces)
      if (name != "extended") order.push_back(name);
    for (const std::string& name : order) {
      const Stopwatch watch;
      in_subspace(name, [&]<typename S>(const std::shared_ptr<const S>& space) {
        Shape shape;
        shape.name = name;
        shape.dimension = space->dim();
        shape.construction_seconds = watch.seconds();
        if (d == 0) d = space->dim();
        const GalerkinSystem<Model, S> reduced(system, space);
        if (handles.empty()) {
          const ReducedModes spectrum = reduced_modes(reduced.rest_stiffness(), space->report.known_zero_modes());
          if (spectrum.num_zero == spectrum.omega.size()) throw SolverError("the object has no flexible mode");
          handles = make_handles(edits, spectrum.softest_stiffness(), system->nodal_mass().sum());
          path = handle_paths(edits, handles, rest);
        }
        solve_path(reduced, rest, handles, path, Vector::Zero(shape.dimension), solver, progress, shape);
        shapes.push_back(std::move(shape));
      });
    }
    // Energies have many local minima, and increments of the full system run into folds that cost more than the
    // smooth shape: so it starts from the last shape of each subspace, and the one of least energy is the reference.
    const std::vector<std::vector<RigidMotion>> last{path.back()};
    double solve_seconds = 0;  // from all starts
    for (std::size_t k = 1; k < shapes.size(); ++k) {
      Shape shape;
      shape.name = "full";
      shape.dimension = system->dim();
      shape.led_by = shapes[k].name;
      try {
        solve_path(*system, rest, handles, last, system->restrict(shapes[k].displacement), solver, progress, shape);
      } catch (const SolverError&) {
        if (k + 1 == shapes.size() && shapes[0].led_by.empty()) throw;
        continue;  // a shape from which nothing can be found, such as one with collapsed elements
      }
      if (shape.missed == 0) {
        shapes[k].own_energy = shape.energy();
        shapes[k].own_minimum = shape.displacement;
      }
      solve_seconds += shape.solve_seconds;
      if (shapes[0].led_by.empty() || shape.energy() < shapes[0].energy()) shapes[0] = std::move(shape);
    }
    shapes[0].solve_seconds = solve_seconds;
  });
  return shapes;
}

/// The table of a scene, and its part of the report.
std::string describe(const Body& body, const std::vector<Shape>& shapes, const std::string& scene, Json& report) {
  const Shape& full = shapes.front();
  std::string table = "| space | d | rms distance [% of the diagonal] | L² over " +
                      std::string(std::holds_alternative<Shell>(body) ? "area" : "volume") +
                      " | to its own minimum | elastic energy [J] | of handles [J] | built [s] | solved [s] |\n"
                      "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n";
  for (const Shape& shape : shapes) {
    const Distance off = distance(body, shape.displacement, full.displacement);
    Json own_json = nullptr;  // where the shape of a subspace leads to no minimum
    std::string own = "–";
    if (shape.own_minimum.size() > 0) {
      const Distance from_own = distance(body, shape.displacement, shape.own_minimum);
      own = shown(from_own.l2, 3);
      own_json = {{"energy", shape.own_energy}, {"rms_over_diagonal", from_own.rms}, {"l2_over_measure", from_own.l2}};
    }
    report.push_back({{"scene", scene},
                      {"space", shape.name},
                      {"dimension", shape.dimension},
                      {"rms_over_diagonal", off.rms},
                      {"l2_over_measure", off.l2},
                      {"elastic_energy", shape.elastic},
                      {"control_energy", shape.control},
                      {"missed_solves", shape.missed},
                      {"led_by", shape.led_by},
                      {"own_minimum", std::move(own_json)},
                      {"construction_seconds", shape.construction_seconds},
                      {"solve_seconds", shape.solve_seconds}});
    table += "| " + shape.name + " | " + std::to_string(shape.dimension) + " | " + shown(100 * off.rms, 3) + " | " +
             shown(off.l2, 3) + " | " + own + " | " + shown(shape.elastic, 4) + " | " + shown(shape.control, 3) +
             " | " + shown(shape.construction_seconds, 3) + " | " + shown(shape.solve_seconds, 3) + " |\n";
    if (shape.missed > 0)
      warn(shape.name + ": " + std::to_string(shape.missed) + " of " + std::to_string(shape.solves) +
           " solves missed the tolerance; try more increments");
  }
  return table;
}

}  // namespace

void FidelityCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  const Stopwatch total;
  const NamedMesh named = load_mesh(mesh, mesh_unit);
  const Body body = load_body(*this, named);
  if (const auto note = locking_note(*this, body)) warn(*note);
  std::vector<EditScene> edits;
  for (const std::filesystem::path& scene : scenes) {
    edits.push_back(read_edit_scene(scene, body));
    const Loads& loads = edits.back().loads;
    if (!loads.gravity.isZero(0) || !loads.forces.empty() || !loads.springs.empty() || !loads.others.empty())
      throw InputError(scene.string() +
                       ": has loads beside its handles, which are not compared here; supple edit takes them");
  }
  ProblemOptions problem = *this;
  // snapshots are read if some subspace is made of them
  problem.subspace = std::ranges::any_of(subspaces, names_pca) ? "pca" : "extended";
  const ReduceOptions options = reduce_options(problem, named, body);
  if (const Index unknowns = 3 * num_nodes(body); options.dimension > unknowns)
    throw InputError("--dimension is " + std::to_string(options.dimension) + ", expected at most the " +
                     std::to_string(unknowns) + " unknowns of the mesh");
  const OutputFolder folder(output);

  Json report{{"command", "fidelity"}, {"version", SUPPLE_VERSION}, {"mesh", mesh}};
  report["diagonal"] = bounding_box(node_positions(body)).diagonal();
  report["measure"] = measure(body);
  report["options"] = problem_json(problem, options, body);
  report["shapes"] = Json::array();
  std::string text;
  for (std::size_t k = 0; k < scenes.size(); ++k) {
    std::vector<Shape> shapes = shapes_of(body, edits[k], options, subspaces, progress_bar());
    if (std::ranges::find(subspaces, "extended") == subspaces.end()) shapes.erase(shapes.begin() + 1);
    const std::string number = scenes.size() == 1 ? "" : "-" + std::to_string(k + 1);
    if (!output.empty()) draw_shapes(output / ("shapes" + number + ".png"), body, shapes);
    clear_progress();
    text += (k == 0 ? "" : "\n") + ("Shapes of " + mesh) + " under " + edits[k].description + "\n\n" +
            describe(body, shapes, scenes[k].string(), report["shapes"]);
    report["peak_memory"] = peak_resident_memory();
    report["seconds"] = {{"total", total.seconds()}};
    if (output.empty()) continue;
    const ExitGuard guard;  // each scene is kept, whatever becomes of the next
    write_file(output / "table.md", text);
    write_json(output / "report.json", report);
  }
  if (!is_stdout(json)) std::fputs(text.c_str(), stdout);
  write_json(json, report);
}

void FidelityCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("fidelity", "Compare subspaces by the shapes that they let an object take");
  declare_problem(command, *this);
  command.add_option("--scene", scenes, "Handles and their motions, see docs/edit-scene.md; may be repeated")
      ->required()
      ->type_name("FILE.json")
      ->expected(1)
      ->take_all();
  command
      .add_option("--subspaces", subspaces,
                  "Names, separated by commas; of the extended one's dimension, or of the next below that they can "
                  "have (skinning: at least 12); sums as 'modal+skinning' of what their parts have")
      ->delimiter(',')
      ->capture_default_str()
      ->check(subspace_name());
  command.add_option("-o,--output", output, "Folder for table.md, pictures of the shapes and the report")
      ->type_name("DIR");
  declare_json(command, json);
  declare_threads(command, threads);
  command.footer([] {
    return material_help() + "\n" + subspace_help() + "\n" + builtin_help() +
           "\nExample:\nsupple fidelity cactus.off --scene bend.json -o fidelity";
  });
  command.callback([this] { run(); });
}

}  // namespace supple
