#include <app/commands/option_checks.hpp>
#include <app/commands/shared_options.hpp>
#include <app/commands/static_command.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/coloured_picture.hpp>
#include <app/scene/result_fields.hpp>
#include <app/scene/scene.hpp>
#include <app/scene/statics.hpp>
#include <core/parallel.hpp>
#include <core/version.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/table/csv.hpp>
#include <numerics/optimize/solver_names.hpp>
#include <physics/body/cut.hpp>
#include <physics/body/reactions.hpp>
#include <physics/body/surface.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

Json json_point(const Point& x) {
  return {x[0], x[1], x[2]};
}
std::string shown_point(const Point& x) {
  return "(" + shown(x[0], 5) + ", " + shown(x[1], 5) + ", " + shown(x[2], 5) + ")";
}

void write_reactions(const std::filesystem::path& path, const Reactions& reactions, const Points& forces,
                     const Body& body) {
  CsvTable table{{"node"}, {"x", "m"}, {"y", "m"}, {"z", "m"}, {"rx", "N"}, {"ry", "N"}, {"rz", "N"}};
  const Points& rest = node_positions(body);
  for (Index k = 0; k < forces.rows(); ++k) {
    const Index v = reactions.nodes()[static_cast<std::size_t>(k)];
    table.add_row(node_places(body).place(v), rest(v, 0), rest(v, 1), rest(v, 2), forces(k, 0), forces(k, 1),
                  forces(k, 2));
  }
  const ExitGuard guard;
  write_csv(path, table);
}

void write_state(const std::filesystem::path& path, const Body& body, const Vector& u, const RowMatrix& reaction,
                 const std::optional<CellStress>& stress) {
  VtuFields fields{.point_data = {vector_field("displacement [m]", u), {"reaction [N]", reaction}}};
  if (stress) add_stress(fields, *stress);
  write_body(path, body, node_positions(body) + as_points(u), std::move(fields));
}

/// Deformed, beside the object at rest, in the colours of the stress, or of the displacement where there is none.
void draw_state(const std::filesystem::path& path, const Body& body, const Vector& u,
                const std::optional<CellStress>& stress) {
  const Surface surface(body);
  const Points rest = surface.rows(node_positions(body));
  PictureObject deformed{.positions = rest + surface.rows(as_points(u)), .triangles = surface.triangles};
  if (stress)
    deformed.scalar = at_nodes(body, stress->von_mises, stress->rest_volume)(surface.nodes);
  else
    deformed.scalar = surface.rows(as_points(u)).rowwise().norm();
  deformed.caption = "under load";
  PictureObject before{.positions = rest, .triangles = surface.triangles, .caption = "at rest"};
  write_coloured_picture(path, {before, deformed}, stress ? "von Mises stress [Pa]" : "displacement [m]", 1600, 800);
}

}  // namespace

void StaticCommand::run() const {
  set_num_threads(threads);
  require_writable(json);
  StageTimes times;
  const bool has_model = is_model(mesh);
  if (has_model) refuse_options_of_meshes(*declared_);
  std::optional<ReducedModel> model;
  if (has_model) model = load_model(mesh);
  const Body body = model ? model->body : load_body(*this, load_mesh(mesh, mesh_unit));
  if (!model)
    if (const auto note = locking_note(*this, body)) warn(*note);
  const bool reduced = model && !full;
  const Scene what = read_scene(scene, body);
  const double at = time ? option_quantity("--time", *time, "s") : time_of_full_load(what);
  const Loads loads = loads_at(what, at);
  if (const Index idle = num_idle(what, at); idle > 0)
    warn(scene.string() + ": " + std::to_string(idle) + " of its loads and springs do not act at t = " + shown(at) +
         " s, when they are taken; --time takes them at another");
  std::vector<Index> tracked = what.track;
  if (!track.empty()) tracked = nodes_at_places(track, num_nodes(body), node_places(body), "--track");
  StaticsOptions options{.tolerance = tolerance, .steps = steps};
  if (solver) options.solver = solver_named(static_solvers, *solver);
  if (!reduced && std::holds_alternative<Nlopt>(options.solver))
    throw InputError("--solver nlopt is for reduced systems");
  std::vector<AxisPlane> planes;
  for (const std::string& text : cut) {
    planes.push_back(parse_plane(node_positions(body), text));
    (void)cut_force(body, Vector::Zero(3 * num_nodes(body)), {planes.back().axis, planes.back().coordinate});
  }
  const OutputFolder folder(output);
  times.finish("read object");

  const Progress progress = progress_bar();
  const Statics found = reduced ? reduced_equilibrium(*model, loads, options, progress)
                                : full_equilibrium(body, loads, options, progress);
  times.finish("equilibrium");
  const Reactions reactions(body);
  const Points forces = reactions(found.u, loads);
  const Points positions = node_positions(body) + as_points(found.u);
  const auto [reaction, moment] = reactions.resultant(forces, positions);
  const Point load = total_force(loads, body, found.u);
  std::optional<CellStress> stress;
  if (has_cell_stress(body)) stress = cell_stress(body, found.u);
  RowMatrix reaction_of_node = RowMatrix::Zero(num_nodes(body), 3);
  for (Index k = 0; k < forces.rows(); ++k)
    reaction_of_node.row(reactions.nodes()[static_cast<std::size_t>(k)]) = forces.row(k);
  if (!output.empty()) {
    write_state(output / "state.vtu", body, found.u, reaction_of_node, stress);
    write_reactions(output / "reactions.csv", reactions, forces, body);
    draw_state(output / "picture.png", body, found.u, stress);
  }
  times.finish("results");
  clear_progress();

  Index farthest = 0;
  const double reach = as_points(found.u).rowwise().norm().maxCoeff(&farthest);
  const NodePlaces& places = node_places(body);
  const auto displacement = [&](Index node) -> Point { return found.u.segment<3>(3 * node); };
  // what is held and what holds it need not be the only forces: their scale tells whether they balance
  const double scale = std::max({load.norm(), forces.rowwise().norm().sum() / 2, 1e-300});
  const double imbalance = (load + reaction).norm() / scale;
  Json report;
  report["command"] = "static";
  report["version"] = SUPPLE_VERSION;
  report["object"] = mesh;
  report["scene"] = scene.string();
  report["description"] = what.description;
  report["system"] = reduced ? "reduced" : "full";
  report["unknowns"] = found.unknowns;
  report["solver"] = name_of_solver(static_solvers, options.solver);
  report["tolerance"] = tolerance;
  report["load_steps"] = found.steps;
  report["halved_steps"] = found.halved_steps;
  report["iterations"] = found.iterations;
  report["residual"] = found.residual;
  report["elastic_energy"] = found.elastic;
  report["largest_displacement"] = {
      {"node", places.place(farthest)}, {"size", reach}, {"displacement", json_point(displacement(farthest))}};
  report["tracked"] = Json::array();
  for (const Index node : tracked)
    report["tracked"].push_back({{"node", places.place(node)}, {"displacement", json_point(displacement(node))}});
  report["load"] = json_point(load);
  report["reaction"] = {
      {"nodes", forces.rows()}, {"force", json_point(reaction)}, {"moment_about_origin", json_point(moment)}};
  report["imbalance"] = imbalance;
  report["cuts"] = Json::array();
  Rows rows{{"scene", what.description},
            {"system", (reduced ? "reduced, " : "full, ") + shown_count(found.unknowns) + " unknowns"},
            {"load steps", std::to_string(found.steps) + ", " + shown_iterations(found.iterations) + ", residual " +
                               shown(found.residual, 2)},
            {"displacement", "at most " + shown(reach, 5) + " m, node " + std::to_string(places.place(farthest)) +
                                 ": " + shown_point(displacement(farthest)) + " m"}};
  for (const Index node : tracked)
    rows.emplace_back("node " + std::to_string(places.place(node)), shown_point(displacement(node)) + " m");
  rows.emplace_back("elastic energy", shown(found.elastic, 5) + " J");
  rows.emplace_back("loads", shown_point(load) + " N");
  rows.emplace_back("reactions", shown_point(reaction) + " N, moment about the origin " + shown_point(moment) + " N m");
  for (std::size_t k = 0; k < cut.size(); ++k) {
    const CutForce through = cut_force(body, found.u, {planes[k].axis, planes[k].coordinate});
    report["cuts"].push_back(
        {{"plane", cut[k]}, {"force", json_point(through.force)}, {"moment_about_origin", json_point(through.moment)}});
    rows.emplace_back("cut " + cut[k], shown_point(through.force) + " N, moment about the origin " +
                                           shown_point(through.moment) + " N m, on what lies before it");
  }
  rows.emplace_back("imbalance", shown_percent(imbalance, 2) + " of the loads");
  if (stress) {
    Index worst = 0;
    const double most = stress->von_mises.maxCoeff(&worst);
    const auto centre = visit_solid(body, [&](const auto& solid) -> Point {
      Point sum = Point::Zero();
      for (const Index v : solid.mesh.cells[static_cast<std::size_t>(worst)]) sum += positions.row(v).transpose();
      return sum / static_cast<double>(solid.mesh.nodes_per_cell);
    });
    report["largest_von_mises"] = {{"cell", worst}, {"stress", most}, {"at", json_point(centre)}};
    rows.emplace_back("von Mises stress", "at most " + shown(most, 5) + " Pa, near " + shown_point(centre) + " m");
  }
  report["threads"] = num_threads();
  report["seconds"] = json_seconds(times.seconds(), times.total());
  if (!output.empty()) {
    rows.emplace_back("results", output.string());
    write_json(output / "report.json", report);
  }
  if (!is_stdout(json)) {
    print_rows(stdout, "equilibrium of " + mesh, rows);
    print_stages(stdout, times.seconds(), times.total());
  }
  write_json(json, report);
  if (!stress)
    warn(std::holds_alternative<Shell>(body)
             ? "there is no stress: a discrete shell has energies of edges and flaps"
             : "there is no stress: the law " + std::string(supple::law(body)) + " tells none");
}

void StaticCommand::declare(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("static", "Find the equilibrium under loads: displacements, reactions and stresses");
  declared_ = &command;
  declare_object(command, *this);
  command.get_option("MESH")->description(
      "A model that 'supple reduce' made, or a mesh as there, which is solved in full");
  command.add_option("--scene", scene, "Loads, see docs/scene.md")->required()->type_name("FILE.json");
  command.add_flag("--full", full, "Of a model, solve the unreduced system");
  command.add_option("--time", time, "When the scene's loads are taken [when all have grown to their full size]")
      ->type_name("T");
  command.add_option("--steps", steps, "In which the loads grow; steps that fail are halved")
      ->capture_default_str()
      ->type_name("N")
      ->check(whole_number());
  command.add_option("--solver", solver, "Of the equilibrium [newton]")
      ->check(CLI::IsMember(solver_names(static_solvers)));
  command.add_option("--tolerance", tolerance, "Residual against the forces of the object")
      ->capture_default_str()
      ->type_name("SHARE")
      ->check(positive_number());
  command.add_option("--track", track, "Node whose displacement is reported; may be repeated")
      ->type_name("NODE")
      ->expected(1)
      ->take_all();
  command.add_option("--cut", cut, "Plane through which force and moment are reported, e.g. 'x=50%'; may be repeated")
      ->type_name("PLANE")
      ->expected(1)
      ->take_all();
  command.add_option("-o,--output", output, "Folder for state.vtu, reactions.csv, picture.png and the report")
      ->type_name("DIR");
  declare_json(command, json);
  declare_threads(command, threads);
  command.footer([] {
    return material_help() +
           "\nExamples:\n"
           "supple static bracket.msh --young '210 GPa' --poisson 0.3 --fix 'z=0' --fix 'x=0:x' --scene loads.json -o "
           "bracket\n"
           "supple static dragon.supple --scene loads.json\n"
           "supple static dragon.supple --full --scene loads.json";
  });
  command.callback([this] { run(); });
}

}  // namespace supple
