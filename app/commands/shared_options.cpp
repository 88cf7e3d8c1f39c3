#include <app/commands/option_checks.hpp>
#include <app/commands/problem_options.hpp>
#include <app/commands/shared_options.hpp>
#include <physics/body/material_law.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/plugin/plugin.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace supple {

namespace {

void declare_material(CLI::App& command, ProblemOptions& problem) {
  command.add_option("--mesh-unit", problem.mesh_unit, "Of the lengths in the mesh's file, such as mm")
      ->capture_default_str()
      ->type_name("UNIT")
      ->group(object_group);
  command.add_option("--material", problem.law, "Law, see below")
      ->capture_default_str()
      ->type_name("LAW")
      ->group(object_group);
  command
      .add_option("--parameter", problem.parameters,
                  "Of the law, instead of what modulus and ratio give; may be repeated")
      ->type_name("NAME=VALUE")
      ->expected(1)
      ->take_all()
      ->group(object_group);
  command.add_option("--young", problem.young, "Young's modulus [Pa], or with a unit: '2 MPa'")
      ->capture_default_str()
      ->group(object_group);
  command.add_option("--poisson", problem.poisson, "Poisson's ratio")->capture_default_str()->group(object_group);
  command
      .add_option("--thickness", problem.thickness,
                  "Of a surface, a discrete shell [m]; or a share of its diagonal [1%]")
      ->type_name("H")
      ->group(object_group);
  command.add_option("--density", problem.density, "Density [kg/m^3]")->capture_default_str()->group(object_group);
  command
      .add_option("--materials", problem.materials,
                  "Law, parameters, and other values for regions: {\"law\": \"ogden\", \"regions\": {\"bone\": "
                  "{\"young\": \"1 MPa\"}}}")
      ->type_name("FILE.json")
      ->group(object_group);
  command
      .add_option("--components", problem.components,
                  "What may be selected of hexahedra and quadratic tets: whole cells, or single gauss-points")
      ->capture_default_str()
      ->check(CLI::IsMember({"cells", "gauss-points"}))
      ->group(object_group);
  command.add_option("--damping-alpha", problem.damping_alpha, "Rayleigh damping, share of the mass [1/s]")
      ->capture_default_str()
      ->group(object_group);
  command.add_option("--damping-beta", problem.damping_beta, "Rayleigh damping, share of the stiffness [s]")
      ->capture_default_str()
      ->group(object_group);
}

void declare_held_nodes(CLI::App& command, ProblemOptions& problem) {
  const auto each = [&](auto& values, const char* name, const char* type, const char* help) {
    command.add_option(name, values, help)->type_name(type)->expected(1)->take_all()->group(object_group);
  };
  each(problem.fix, "--fix", "RULE",
       "Hold nodes, e.g. 'y<4%' (of the bounding box) or 'x=0 and z>10 mm'; 'x=0:x' holds them along x alone, as a "
       "plane of symmetry does; may be repeated");
  each(problem.fix_box, "--fix-box", "BOX",
       "Hold the nodes in a box x,y,z:x,y,z [m], or x,y,z:x,y,z:xy along these axes; may be repeated");
  each(problem.fix_file, "--fix-file", "FILE", "Hold the nodes that a file lists, one index a line, from 0");
  each(problem.fix_region, "--fix-region", "TAG", "Hold the nodes of a region, by name or number");
}

}  // namespace

CLI::Option& declare_json(CLI::App& command, std::filesystem::path& json) {
  return *command.add_option("--json", json, "Report for machines; '-': to stdout, instead of the text")
              ->type_name("FILE");
}

void declare_threads(CLI::App& command, int& threads) {
  command.add_option("--threads", threads, "Threads; 0: one for each processor. Results do not depend on it")
      ->type_name("N")
      ->check(CLI::Range(0, 4096));
}

void declare_seed(CLI::App& command, std::uint64_t& seed) {
  command.add_option("--seed", seed, "Of all random choices")
      ->capture_default_str()
      ->check(whole_number(0))
      ->group(method_group);
}

void declare_plugins(CLI::App& command) {
  command
      .add_option_function<std::vector<std::string>>(
          "--plugin", [](const std::vector<std::string>& files) { std::ranges::for_each(files, load_plugin); },
          "Shared library with materials, elements, selectors, subspaces, integrators or outside forces of your own; "
          "may be repeated")
      ->type_name("FILE.so")
      ->expected(1)
      ->take_all();
}

void declare_object(CLI::App& command, ProblemOptions& problem) {
  command
      .add_option("MESH", problem.mesh,
                  "Tets or hexahedra (.msh .mesh .node .ele .veg .vtk .vtu), a surface (.obj .off .ply .stl), or a "
                  "built-in, see below")
      ->required();
  declare_plugins(command);
  declare_material(command, problem);
  declare_held_nodes(command, problem);
}

void declare_snapshots(CLI::App& command, ProblemOptions& problem) {
  command
      .add_option("--snapshots", problem.snapshots,
                  "Displacements for the subspace pca: .npy, tensor file or trajectory")
      ->type_name("FILE")
      ->group(method_group);
}

void declare_problem(CLI::App& command, ProblemOptions& problem) {
  declare_object(command, problem);
  command.add_option("--dimension", problem.dimension, "Of the subspace, where the modes leave a choice")
      ->type_name("D")
      ->check(whole_number())
      ->group(method_group);
  declare_snapshots(command, problem);
  command
      .add_option("--modes", problem.modes,
                  "Vibration modes, rigid ones included [15]; those that derivatives are taken of: flexible ones [15; "
                  "solids, relaxed: 20]")
      ->type_name("R")
      ->check(whole_number())
      ->group(method_group);
  declare_seed(command, problem.seed);
}

void declare_fitting(CLI::App& command, ProblemOptions& problem) {
  command
      .add_option("--recipe", problem.recipe,
                  std::string("Where unset options come from: relaxed (fitted to the full object), subspace (to all "
                              "components in the subspace), or paper ") +
                      (problem.relaxes ? "[relaxed; poses or snapshots of one's own: subspace]" : "[subspace]"))
      ->check(CLI::IsMember({"default", "relaxed", "subspace", "paper"}))
      ->group(method_group);
  command.add_option("--poses", problem.poses, "Training poses [300; relaxed: 100; paper: 1000]")
      ->type_name("T")
      ->group(method_group);
  command
      .add_option("--amplitude", problem.amplitudes,
                  "Rms displacement of a pose as a share of the diagonal; repeat for a mix [0.05, 0.017, "
                  "0.005; paper: 0.07]; relaxed: that of the equilibria [0.12, 0.06, 0.03]")
      ->type_name("SHARE")
      ->expected(1)
      ->take_all()
      ->group(method_group);
  command
      .add_option("--omega-exponent", problem.omega_exponent,
                  "Poses have deviations ~ 1/omega^E in each mode [2; paper: 1]")
      ->type_name("E")
      ->check(number_between(0, 20))
      ->group(method_group);
  command.add_option("--norm", problem.norm, "Measure of the fitted forces [stiffness; paper: mass]")
      ->check(CLI::IsMember(all_names_of<ForceNorm>()))
      ->group(method_group);
  command
      .add_option("--inverted", problem.inverted,
                  "Poses with inverted cells [keep; shrink for laws that are undefined there]")
      ->check(CLI::IsMember(all_names_of<InvertedPoses>()))
      ->group(method_group);
  command
      .add_option("--poses-file", problem.poses_file, "Poses instead of random ones: .npy, tensor file or trajectory")
      ->type_name("FILE")
      ->group(method_group);
  command
      .add_option("--equilibria", problem.equilibria,
                  "Further poses, in equilibrium, where errors count as displacements [a third of the poses; free "
                  "shells, paper: 0; relaxed: 32]")
      ->check(whole_number(0))
      ->type_name("N")
      ->group(method_group);
  command
      .add_option("--held-out", problem.held_out,
                  "Fresh poses to measure the error on, at each of three amplitudes; 0: none [100; relaxed: 50]")
      ->type_name("N")
      ->group(method_group);
}

void declare_training(CLI::App& command, ProblemOptions& problem) {
  command
      .add_option(
          "--subspace", problem.subspace,
          "extended (modes under all linear maps), modal (modes alone), derivatives (modal derivatives), skinning "
          "(skinning eigenmodes), pca (of --snapshots), or several, as in extended+pca: what they span together "
          "[extended; solids, relaxed: derivatives]")
      ->type_name("NAME[:OPTION=VALUE...]")
      ->check(subspace_name())
      ->group(method_group);
  declare_fitting(command, problem);
}

void declare_checkpoint(CLI::App& command, ProblemOptions& problem) {
  command
      .add_option("--checkpoint", problem.checkpoint,
                  "Folder that keeps modes, derivatives, forces and selections: the same command goes on from there")
      ->type_name("DIR");
}

void declare_full_loads(CLI::App& command, ProblemOptions& problem, Index least) {
  command
      .add_option("--full-loads", problem.full_loads,
                  "Fresh loads under which equilibria are compared with those of the full object" +
                      std::string(least == 0 ? "; 0: none [8]" : " [8]"))
      ->type_name("N")
      ->check(whole_number(least))
      ->group(method_group);
}

std::string material_help() {
  std::string text = "Material laws and their parameters:\n";
  for (const std::string& name : material_laws()) {
    text += "  " + name + ":";
    for (const std::string& parameter : material_law(name).parameters) text += " " + parameter;
    if (const std::string& description = material_law(name).description; !description.empty())
      text += " (" + description + ")";
    text += "\n";
  }
  return text;
}

std::string subspace_help() {
  return "Subspaces and their options:\n" + described(subspaces());
}

std::string selector_help() {
  return "Selectors and their options:\n" + described(selectors());
}

void refuse_options_of_meshes(const CLI::App& command) {
  for (const CLI::Option* option : command.get_options())
    if (option->count() > 0 && (option->get_group() == object_group || option->get_group() == method_group))
      throw InputError("--" + option->get_lnames().front() + " is for meshes, and this is a model");
}

}  // namespace supple
