#include <app/commands/compare_command.hpp>
#include <app/commands/compare_selectors_command.hpp>
#include <app/commands/edit_command.hpp>
#include <app/commands/fidelity_command.hpp>
#include <app/commands/info_command.hpp>
#include <app/commands/reduce_command.hpp>
#include <app/commands/select_command.hpp>
#include <app/commands/simulate_command.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/terminal.hpp>
#include <core/check.hpp>
#include <core/version.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/builtin/builtin_surfaces.hpp>
#include <io/text/json_fields.hpp>
#include <physics/body/plugin.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <new>
#include <optional>

namespace {

using namespace supple;

/// A whole number of at least `least` that fits into 63 bits, without sign, point or exponent.
CLI::Validator whole_number(Index least = 1) {
  return {[least](std::string& text) -> std::string {
            Index value = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
            const bool whole = error == std::errc() && end == text.data() + text.size();
            return whole && value >= least ? ""
                                           : "'" + text + "' is no whole number from " + std::to_string(least) + " up";
          },
          ""};
}

CLI::Validator positive_number() {
  return {[](std::string& text) -> std::string {
            double value = 0;
            return CLI::detail::lexical_cast(text, value) && value > 0 && std::isfinite(value)
                       ? ""
                       : "'" + text + "' is no number > 0";
          },
          ""};
}

CLI::Validator number_between(double low, double high) {
  return {[low, high](std::string& text) -> std::string {
            double value = 0;
            return CLI::detail::lexical_cast(text, value) && value >= low && value <= high
                       ? ""
                       : "'" + text + "' is no number from " + shown(low) + " to " + shown(high);
          },
          ""};
}

/// Names of subspaces, and sums of them.
CLI::Validator subspace_name() {
  return {[](std::string& text) -> std::string {
            try {
              (void)parts_of_subspace(text);
            } catch (const std::invalid_argument& error) {
              return error.what();
            }
            return "";
          },
          ""};
}

void add_json(CLI::App& app, std::filesystem::path& json) {
  app.add_option("--json", json, "Report for machines; '-': to stdout, instead of the text")->type_name("FILE");
}

void add_threads(CLI::App& app, int& threads) {
  app.add_option("--threads", threads, "Threads; 0: one for each processor. Results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 4096));
}

/// Plug-ins are loaded while the line is read, before anything asks for what they add.
void add_plugins(CLI::App& app) {
  app.add_option_function<std::vector<std::string>>(
         "--plugin", [](const std::vector<std::string>& files) { std::ranges::for_each(files, load_plugin); },
         "Shared library with materials of your own, see docs/materials.md; may be repeated")
      ->type_name("FILE.so")
      ->expected(1)
      ->take_all();
}

/// Of every law the names of its parameters.
std::string material_help() {
  std::string text = "Material laws and their parameters:\n";
  for (const std::string& name : material_laws()) {
    text += "  " + name + ":";
    for (const std::string& parameter : material_law(name).parameters) text += " " + parameter;
    text += "\n";
  }
  return text;
}

/// The object and the size of its subspace, for all commands that begin with a mesh.
void add_problem(CLI::App& command, ProblemOptions& c) {
  command
      .add_option("MESH", c.mesh,
                  "Tets or hexahedra (.msh .mesh .node .ele .veg .vtk .vtu), a surface (.obj .off .ply .stl), or a "
                  "built-in, see below")
      ->required();
  add_plugins(command);
  const auto object = "Object";
  command.add_option("--material", c.law, "Law, see below")->capture_default_str()->type_name("LAW")->group(object);
  command
      .add_option("--parameter", c.parameters, "Of the law, instead of what modulus and ratio give; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all()
      ->group(object);
  command.add_option("--young", c.young, "Young's modulus [Pa], or with a unit: '2 MPa'")
      ->capture_default_str()
      ->group(object);
  command.add_option("--poisson", c.poisson, "Poisson's ratio")->capture_default_str()->group(object);
  command.add_option("--thickness", c.thickness, "Of a surface, a discrete shell [m]; or a share of its diagonal [1%]")
      ->type_name("H")
      ->group(object);
  command.add_option("--density", c.density, "Density [kg/m^3]")->capture_default_str()->group(object);
  command
      .add_option("--materials", c.materials,
                  "Law, parameters, and other values for regions: {\"law\": \"ogden\", \"regions\": {\"bone\": "
                  "{\"young\": \"1 MPa\"}}}")
      ->type_name("FILE.json")
      ->group(object);
  command
      .add_option("--components", c.components,
                  "What may be selected of hexahedra and quadratic tets: whole cells, or single gauss-points")
      ->capture_default_str()
      ->check(CLI::IsMember({"cells", "gauss-points"}))
      ->group(object);
  command.add_option("--damping-alpha", c.damping_alpha, "Rayleigh damping, share of the mass [1/s]")
      ->capture_default_str()
      ->group(object);
  command.add_option("--damping-beta", c.damping_beta, "Rayleigh damping, share of the stiffness [s]")
      ->capture_default_str()
      ->group(object);
  const auto each = [&](auto& values, const char* name, const char* type, const char* help) {
    command.add_option(name, values, help)->type_name(type)->expected(1)->take_all()->group(object);
  };
  each(c.fix, "--fix", "RULE", "Hold nodes, e.g. 'y<4%' (of the bounding box) or 'x>=0.25' [m]; may be repeated");
  each(c.fix_box, "--fix-box", "BOX", "Hold the nodes in a box x,y,z:x,y,z [m]; may be repeated");
  each(c.fix_file, "--fix-file", "FILE", "Hold the nodes that a file lists, one index a line, from 0");
  each(c.fix_region, "--fix-region", "TAG", "Hold the nodes of a region, by name or number");

  const auto method = "Method";
  command.add_option("--dimension", c.dimension, "Of the subspace, where the modes leave a choice")
      ->type_name("D")
      ->check(whole_number())
      ->group(method);
  command.add_option("--snapshots", c.snapshots, "Displacements for --subspace pca: .npy, tensor file or trajectory")
      ->type_name("FILE")
      ->group(method);
  command
      .add_option("--modes", c.modes,
                  "Vibration modes, rigid ones included [15]; those that derivatives are taken of: flexible ones")
      ->type_name("R")
      ->check(whole_number())
      ->group(method);
  command.add_option("--seed", c.seed, "Of all random choices")
      ->capture_default_str()
      ->check(whole_number(0))
      ->group(method);
}

/// The subspace and the training, for commands that fit forces.
void add_training(CLI::App& command, ProblemOptions& c) {
  const auto method = "Method";
  command.add_option("--recipe", c.recipe, "Where unset options come from: default, or paper")
      ->capture_default_str()
      ->check(CLI::IsMember({"default", "paper"}))
      ->group(method);
  command
      .add_option(
          "--subspace", c.subspace,
          "extended (modes under all linear maps), modal (modes alone), derivatives (modal derivatives), skinning "
          "(skinning eigenmodes), pca (of --snapshots), or several, as in extended+pca: what they span together")
      ->capture_default_str()
      ->check(subspace_name())
      ->group(method);
  command.add_option("--poses", c.poses, "Training poses [300; paper: 1000]")->type_name("T")->group(method);
  command
      .add_option("--amplitude", c.amplitudes,
                  "Rms displacement of a pose as a share of the diagonal; repeat for a mix [0.05, 0.017, "
                  "0.005; paper: 0.07]")
      ->type_name("SHARE")
      ->expected(1)
      ->take_all()
      ->group(method);
  command
      .add_option("--omega-exponent", c.omega_exponent, "Poses have deviations ~ 1/omega^E in each mode [2; paper: 1]")
      ->type_name("E")
      ->check(number_between(0, 20))
      ->group(method);
  command.add_option("--norm", c.norm, "Measure of the fitted forces [stiffness; paper: mass]")
      ->check(CLI::IsMember({"mass", "stiffness"}))
      ->group(method);
  command
      .add_option("--inverted", c.inverted,
                  "Poses with inverted cells [keep; shrink for laws that are undefined there]")
      ->check(CLI::IsMember({"keep", "shrink", "redraw"}))
      ->group(method);
  command.add_option("--poses-file", c.poses_file, "Poses instead of random ones: .npy, tensor file or trajectory")
      ->type_name("FILE")
      ->group(method);
  command
      .add_option("--equilibria", c.equilibria,
                  "Further poses, in equilibrium, where errors count as displacements [a third of the poses; free "
                  "shells, paper: 0]")
      ->check(whole_number(0))
      ->type_name("N")
      ->group(method);
  command
      .add_option("--held-out", c.held_out,
                  "Fresh poses to measure the error on, at each of three amplitudes; 0: none [100]")
      ->type_name("N")
      ->group(method);
}

CLI::App& add_reduce(CLI::App& app, ReduceCommand& c) {
  CLI::App& reduce = *app.add_subcommand("reduce", "Make a reduced model of a mesh");
  const auto files = "Output";
  add_problem(reduce, c);
  add_training(reduce, c);
  reduce.add_option("-o,--output", c.model, "The model's file")->required()->type_name("MODEL")->group(files);
  add_json(reduce, c.json);
  reduce.get_option("--json")->group(files);
  reduce.add_option("--picture", c.picture, "Picture of the object and the selected cells")
      ->type_name("FILE.png")
      ->group(files);
  reduce.add_option("--plots", c.plots, "Folder for plots of the errors and of the frequencies")
      ->type_name("DIR")
      ->group(files);

  const auto method = "Method";
  reduce
      .add_option("--points", c.points,
                  "Largest number of components that stand for all [150; 1000 with --target-error]")
      ->type_name("S")
      ->check(whole_number())
      ->group(method);
  reduce.add_option("--target-error", c.target_error, "Take as few components as reach this training error")
      ->type_name("SHARE")
      ->check(positive_number())
      ->group(method);
  reduce.add_option("--selector", c.selector, "How they are chosen")
      ->check(CLI::IsMember(known_selectors()))
      ->group(method);
  reduce
      .add_option("--candidates", c.candidates,
                  "Components that may be chosen beside --must-keep, one index a line, from 0 [all]")
      ->type_name("FILE")
      ->group(method);
  reduce.add_option("--must-keep", c.must_keep, "Components that every choice has, unless their weight would be 0")
      ->type_name("FILE")
      ->group(method);
  reduce.add_option("--warm-start", c.warm_start, "Earlier model of this mesh whose selection is to be improved")
      ->type_name("MODEL")
      ->group(method);
  add_threads(reduce, c.threads);
  reduce.footer(material_help() + "\nBuilt-in meshes:\n" + std::string(builtin_mesh_help) +
                std::string(builtin_surface_help) +
                "\nExamples:\n"
                "supple reduce dragon.msh -o dragon.supple --fix 'y<4%' --points 150\n"
                "supple reduce octopus -o octopus.supple --fix 'y<4%' --picture octopus.png --json -");
  return reduce;
}

CLI::App& add_simulate(CLI::App& app, SimulateCommand& c) {
  CLI::App& simulate = *app.add_subcommand("simulate", "Run a scene with a reduced model, or with the full one");
  simulate.add_option("MODEL", c.model, "Model that 'supple reduce' made")->required();
  simulate
      .add_option("--scene", c.scene, "Loads and springs over time, see docs/scene.md; without: pulled, then released")
      ->type_name("FILE.json");
  simulate.add_flag("--full", c.full, "Run the unreduced system instead: all nodes, Newton's method");
  simulate.add_option("--time", c.time, "Duration [s], instead of the scene's")->type_name("T");
  simulate.add_option("--step", c.step, "Time step [s], instead of the scene's")->type_name("H");
  simulate.add_option("--solver", c.solver, "Nonlinear solver [bfgs; full: newton]")
      ->check(CLI::IsMember({"newton", "bfgs", "broyden"}));
  simulate.add_option("--tolerance", c.tolerance, "Relative residual of a step [1e-6]")
      ->type_name("SHARE")
      ->check(positive_number());
  simulate
      .add_option(
          "--precision", c.precision,
          "Of the basis where components are, as kept for forces; sums are double [dense bases: single, others: "
          "double]")
      ->check(CLI::IsMember({"double", "single"}));
  simulate.add_option("-o,--output", c.output, "Folder for trajectory, energies, pictures and ParaView's series.pvd")
      ->type_name("DIR");
  simulate.add_option("--every", c.every, "A frame after so many steps [at most 100 frames]")->type_name("N");
  simulate.add_option("--frames", c.frames, "What ParaView gets: surface, cells or none")
      ->capture_default_str()
      ->check(CLI::IsMember({"surface", "cells", "tets", "none"}));
  simulate.add_option("--track", c.track, "Node whose displacement is recorded in every step; may be repeated")
      ->type_name("NODE")
      ->expected(1)
      ->take_all();
  add_json(simulate, c.json);
  add_plugins(simulate);
  add_threads(simulate, c.threads);
  simulate.footer(
      "Examples:\n"
      "supple simulate octopus.supple -o run\n"
      "supple simulate octopus.supple --full --time 0.1 -o full\n"
      "supple simulate dragon.supple --scene pull.json --step '2 ms' --json -");
  return simulate;
}

CLI::App& add_compare(CLI::App& app, CompareCommand& c) {
  CLI::App& compare = *app.add_subcommand("compare", "Measure how far one trajectory is from another");
  compare.add_option("FIRST", c.first, "Folder or trajectory file of 'supple simulate'")->required();
  compare.add_option("REFERENCE", c.reference, "What it is compared with")->required();
  compare.add_option("-o,--output", c.output, "Folder for errors.csv, errors.png and comparison.png")->type_name("DIR");
  add_json(compare, c.json);
  add_threads(compare, c.threads);
  compare.footer(
      "Frames count at times that both have, up to the end of the shorter one; errors are root mean squares "
      "over\n"
      "nodes (by mass) and frames, relative to the reference.\n"
      "\nExample:\nsupple compare run full -o comparison");
  return compare;
}

CLI::App& add_compare_selectors(CLI::App& app, CompareSelectorsCommand& c) {
  CLI::App& compare =
      *app.add_subcommand("compare-selectors", "Run selectors over sizes and seeds on one fitting problem");
  add_problem(compare, c);
  add_training(compare, c);
  const auto comparison = "Comparison";
  compare.add_option("--selectors", c.selectors, "Names, separated by commas")
      ->delimiter(',')
      ->capture_default_str()
      ->check(CLI::IsMember(known_selectors()))
      ->group(comparison);
  compare
      .add_option("--sizes", c.sizes,
                  "Numbers of components, separated by commas [50,100,150,250, as far as the object has them]")
      ->delimiter(',')
      ->type_name("N")
      ->group(comparison);
  compare.add_option("--runs", c.runs, "Seeds for each selector and size")
      ->capture_default_str()
      ->type_name("N")
      ->group(comparison);
  compare
      .add_option("--train-groups", c.train_groups,
                  "Poses that 'greedy' compares components on, anew in each step [all; An et al.: 10]")
      ->type_name("N")
      ->check(whole_number())
      ->group(comparison);
  compare
      .add_flag("--trajectories", c.trajectories,
                "Compare pulled motions, too; their reference evaluates every component, which takes a minute")
      ->group(comparison);
  compare.add_option("-o,--output", c.output, "Folder for runs.csv, table.md, plots and the page index.html")
      ->type_name("DIR");
  add_json(compare, c.json);
  add_threads(compare, c.threads);
  compare.footer(
      "Example:\n"
      "supple compare-selectors dragon.msh --fix 'y<4%' --selectors nn-sp,nn-htp,greedy --sizes 50,100,150 -o "
      "comparison");
  return compare;
}

CLI::App& add_select(CLI::App& app, SelectCommand& c) {
  CLI::App& select = *app.add_subcommand("select", "Choose few columns of a matrix A, with weights w: A w ~ b");
  const auto problem = "Problem";
  select.add_option("--matrix", c.matrix, "A: NumPy .npy or Matrix Market .mtx")
      ->required()
      ->type_name("FILE")
      ->group(problem);
  select.add_option("--rhs", c.rhs, "b, likewise; without: b = A 1, the sum of all columns, as cubature fits it")
      ->type_name("FILE")
      ->group(problem);
  CLI::Option& held_out =
      *select.add_option("--validate-matrix", c.validate_matrix, "Held-out rows of A, to measure the error on")
           ->type_name("FILE")
           ->group(problem);
  select.add_option("--validate-rhs", c.validate_rhs, "Their b; without: their A 1, if there is no --rhs")
      ->needs(&held_out)
      ->type_name("FILE")
      ->group(problem);
  select
      .add_option("--group-size", c.group_size,
                  "Rows of a training pose, for --train-groups: they stand or fall together")
      ->capture_default_str()
      ->type_name("N")
      ->check(whole_number())
      ->group(problem);

  const auto method = "Method";
  select.add_option("--points", c.points, "Largest number of columns; may be left out with --target-error")
      ->type_name("S")
      ->check(whole_number())
      ->group(method);
  select.add_option("--target-error", c.target_error, "Take as few columns as reach |A w - b| / |b| <= SHARE")
      ->type_name("SHARE")
      ->check(positive_number())
      ->group(method);
  c.selector = known_selectors().front();
  select.add_option("--selector", c.selector, "How they are chosen; htp and niht give weights of any sign")
      ->capture_default_str()
      ->check(CLI::IsMember(known_selectors()))
      ->group(method);
  select
      .add_option("--candidates", c.candidates,
                  "Columns that may be chosen beside --must-keep, one index a line, from 0 [all]")
      ->type_name("FILE")
      ->group(method);
  select.add_option("--must-keep", c.must_keep, "Columns that are in the answer, if need be with weight 0")
      ->type_name("FILE")
      ->group(method);
  select.add_option("--warm-start", c.warm_start, "Earlier report to improve: its indices and positive weights")
      ->type_name("FILE.json")
      ->group(method);
  select
      .add_option("--train-groups", c.train_groups,
                  "Groups of --group-size rows that 'greedy' compares columns on, anew in each step [all]")
      ->type_name("N")
      ->check(whole_number())
      ->group(method);
  select.add_option("--seed", c.seed, "Of all random choices")
      ->capture_default_str()
      ->check(whole_number(0))
      ->group(method);
  add_json(select, c.json);
  add_threads(select, c.threads);
  select.footer(
      "The indices and weights are in the report of --json. Weights are not negative, but for htp and niht.\n"
      "\nExamples:\n"
      "supple select --matrix A.npy --rhs b.npy --points 200 --json -\n"
      "supple select --matrix A.mtx --target-error 0.01 --json selection.json");
  return select;
}

CLI::App& add_edit(CLI::App& app, EditCommand& c) {
  CLI::App& edit = *app.add_subcommand("edit", "Deform an object by moving handles on it");
  edit.add_option("MODEL", c.model, "Model that 'supple reduce' made")->required();
  edit.add_option("--scene", c.scene, "Handles and their motions, see docs/edit-scene.md")
      ->required()
      ->type_name("FILE.json");
  edit.add_flag("--full", c.full, "Solve the unreduced system, the reference");
  edit.add_option("--solver", c.solver, "Of the equilibrium [newton]")
      ->check(CLI::IsMember({"newton", "bfgs", "nlopt"}));
  edit.add_option("--tolerance", c.tolerance, "Residual of a solve against its largest force [1e-6]");
  edit.add_option("--frames", c.frames, "What ParaView gets of every solve")
      ->capture_default_str()
      ->check(CLI::IsMember({"surface", "cells", "tets", "none"}));
  edit.add_option("-o,--output", c.output, "Folder for picture.png, series.pvd, solves.csv, trajectory and report")
      ->type_name("DIR");
  add_json(edit, c.json);
  add_plugins(edit);
  add_threads(edit, c.threads);
  edit.footer("Example:\nsupple edit cactus.supple --scene bend.json -o bent");
  return edit;
}

CLI::App& add_fidelity(CLI::App& app, FidelityCommand& c) {
  CLI::App& fidelity = *app.add_subcommand("fidelity", "Compare subspaces by the shapes that they let an object take");
  add_problem(fidelity, c);
  fidelity.add_option("--scene", c.scenes, "Handles and their motions, see docs/edit-scene.md; may be repeated")
      ->required()
      ->type_name("FILE.json")
      ->expected(1)
      ->take_all();
  fidelity
      .add_option("--subspaces", c.subspaces,
                  "Names, separated by commas; of the extended one's dimension, or of the next below that they can "
                  "have (skinning: "
                  "at least 12); sums as 'modal+skinning' of what their parts have")
      ->delimiter(',')
      ->capture_default_str()
      ->check(subspace_name());
  fidelity.add_option("-o,--output", c.output, "Folder for table.md, pictures of the shapes and the report")
      ->type_name("DIR");
  add_json(fidelity, c.json);
  add_threads(fidelity, c.threads);
  fidelity.footer("Example:\nsupple fidelity cactus.off --scene bend.json -o fidelity");
  return fidelity;
}

CLI::App& add_info(CLI::App& app, InfoCommand& c) {
  CLI::App& info = *app.add_subcommand("info", "Say what a model or a mesh holds");
  info.add_option("SOURCE", c.source, "Model, mesh file or built-in mesh")->required();
  add_json(info, c.json);
  add_plugins(info);
  return info;
}

CLI::App& add_mesh(CLI::App& app, MeshCommand& c) {
  CLI::App& mesh = *app.add_subcommand("mesh", "Write a built-in or other mesh for ParaView");
  mesh.add_option("SOURCE", c.source, "Mesh file or built-in mesh")->required();
  mesh.add_option("-o,--output", c.output, "File to write")->required()->type_name("FILE.vtu");
  mesh.footer("Built-in meshes:\n" + std::string(builtin_mesh_help) + std::string(builtin_surface_help));
  return mesh;
}

/// Messages of any origin on one line.
int fail(int code, std::string message) {
  while (!message.empty() && message.back() == '\n') message.pop_back();
  for (std::size_t at; (at = message.find('\n')) != std::string::npos;) message.replace(at, 1, "; ");
  clear_progress();
  std::fflush(stdout);
  std::fprintf(stderr, "supple: %s\n", message.c_str());
  return code;
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
  ReduceCommand reduce;
  SimulateCommand simulate;
  EditCommand edit;
  FidelityCommand fidelity;
  CompareCommand compare;
  CompareSelectorsCommand compare_selectors;
  SelectCommand select;
  InfoCommand info;
  MeshCommand mesh;
  add_reduce(app, reduce).callback([&] { reduce.run(); });
  add_simulate(app, simulate).callback([&] { simulate.run(); });
  add_edit(app, edit).callback([&] { edit.run(); });
  add_fidelity(app, fidelity).callback([&] { fidelity.run(); });
  add_compare(app, compare).callback([&] { compare.run(); });
  add_compare_selectors(app, compare_selectors).callback([&] { compare_selectors.run(); });
  add_select(app, select).callback([&] { select.run(); });
  add_info(app, info).callback([&] { info.run(); });
  add_mesh(app, mesh).callback([&] { mesh.run(); });
  try {
    app.parse(argc, argv);
    return std::fflush(stdout) == 0 && !std::ferror(stdout) ? 0 : fail(1, "stdout cannot be written");
  } catch (const CLI::Success& asked) {  // --help, --version
    return app.exit(asked);
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

}  // namespace

int main(int argc, char** argv) {
  supple::watch_for_signals();
  return run(argc, argv);
}
