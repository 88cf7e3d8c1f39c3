#include <app/commands/problem_options.hpp>
#include <app/report/exit_guard.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <app/scene/pose_file.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/text/json_fields.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/locking.hpp>
#include <physics/body/material_law.hpp>
#include <reduction/basis/subspace_library.hpp>

#include <algorithm>
#include <concepts>
#include <map>
#include <optional>
#include <set>

namespace supple {

namespace {

/// What an option says, and along which axes it holds that: "x=0:yz"; without axes, along all.
struct Held {
  std::string what;
  std::uint8_t axes = HeldAxes::all;
};
Held with_axes(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) return {text};
  Held held{text.substr(0, colon), 0};
  for (const char c : text.substr(colon + 1)) {
    const std::uint8_t axis = c < 'x' || c > 'z' ? 0 : static_cast<std::uint8_t>(1 << (c - 'x'));
    if (axis == 0 || (held.axes & axis) != 0) return {text};
    held.axes |= axis;
  }
  return held.axes == 0 ? Held{text} : held;
}

struct Supports {
  std::vector<Index> fixed;
  std::vector<HeldAxes> sliding;
};

Supports read_supports(const ProblemOptions& problem, const NamedMesh& named) {
  const Points& nodes = named.nodes();
  std::map<Index, std::uint8_t> axes_of;
  const auto hold = [&](const std::vector<Index>& some, std::uint8_t axes) {
    for (const Index v : some) axes_of[v] |= axes;
  };
  for (const std::string& text : problem.fix) {
    const Held rule = with_axes(text);
    hold(select_nodes(nodes, rule.what), rule.axes);
  }
  for (const std::string& text : problem.fix_box) {
    const Held box = with_axes(text);
    hold(nodes_in_box(nodes, box.what), box.axes);
  }
  for (const std::string& text : problem.fix_region) {
    std::visit(
        [&]<typename Mesh>(const Mesh& mesh) {
          if constexpr (std::same_as<Mesh, TriangleMesh>) {
            throw InputError("--fix-region '" + text + "': a surface has no regions");
          } else {
            const auto is_name = [&](const auto& region) { return region.second == text; };
            const bool is_whole = std::ranges::any_of(mesh.region_names, is_name) || mesh.node_groups.contains(text);
            const Held region = is_whole ? Held{text} : with_axes(text);
            hold(nodes_of_region(mesh, region.what), region.axes);
          }
        },
        named.mesh);
  }
  for (const std::filesystem::path& path : problem.fix_file) {
    const Held file = std::filesystem::exists(path) ? Held{path.string()} : with_axes(path.string());
    hold(read_node_set(nodes, file.what, named.places()), file.axes);
  }
  if (const std::vector<HeldAxes>& of_file = named.notes.held; !of_file.empty()) {
    if (axes_of.empty())
      for (const auto& [node, axes] : of_file) axes_of[node] = axes;
    else
      warn("the supports of " + problem.mesh + " are not used: options name others");
  }
  Supports supports;
  for (const auto& [node, axes] : axes_of)
    if (axes == HeldAxes::all)
      supports.fixed.push_back(node);
    else
      supports.sliding.push_back({node, axes});
  return supports;
}

RayleighDamping read_damping(const ProblemOptions& problem) {
  const RayleighDamping damping{option_quantity("--damping-alpha", problem.damping_alpha, "1/s"),
                                option_quantity("--damping-beta", problem.damping_beta, "s")};
  if (damping.alpha < 0 || damping.beta < 0) throw InputError("damping is negative, expected 0 or more");
  return damping;
}

struct Material {
  IsotropicModuli moduli;
  double density = 0;
  MaterialLaw::Named parameters = {};  // instead of what the moduli give

  bool operator==(const Material& other) const {
    return moduli.young == other.moduli.young && moduli.poisson == other.moduli.poisson && density == other.density &&
           parameters == other.parameters;
  }
};

/// "mu=2e4"
std::pair<std::string, double> named_value(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at == 0)
    throw InputError("--parameter '" + text + "' is not of the form NAME=VALUE, such as mu=2e4");
  return {text.substr(0, at), option_quantity("--parameter " + text.substr(0, at), text.substr(at + 1), "1")};
}

Material base_material(const ProblemOptions& problem) {
  Material result{{option_quantity("--young", problem.young, "Pa"), option_quantity("--poisson", problem.poisson, "1")},
                  option_quantity("--density", problem.density, "kg/m^3")};
  for (const std::string& text : problem.parameters) {
    const auto [name, value] = named_value(text);
    if (!result.parameters.emplace(name, value).second) throw InputError("--parameter " + name + " is given twice");
  }
  return result;
}

/// What the fields of a file change of a material.
Material read_material(const JsonFields& fields, const MaterialLaw& law, Material material) {
  material.moduli.young = fields.number_or("young", material.moduli.young, positive, "Pa");
  material.moduli.poisson = fields.number_or("poisson", material.moduli.poisson, between(-1, 0.5));
  material.density = fields.number_or("density", material.density, positive, "kg/m^3");
  if (const auto parameters = fields.object_if("parameters"))
    for (const std::string& name : law.parameters)
      if (parameters->contains(name)) material.parameters[name] = parameters->number(name);
  return material;
}

/// A law that an option or a file names. \throws InputError that says where.
const MaterialLaw& named_law(const std::string& name, const std::string& where) {
  try {
    return material_law(name);
  } catch (const std::invalid_argument& error) {
    throw InputError(where + ": " + error.what());
  }
}

/// Hands materials over to a solid. \param materials  the first is that of cells without one of their own.
/// \param source  for messages, if they come from a file.
template <typename Mesh>
void take_materials(const MaterialLaw& law, const std::vector<Material>& materials, const std::string& source,
                    SolidOf<Mesh>& solid) {
  solid.density = Vector::Constant(1, materials[0].density);
  if (!solid.material_of_cell.empty()) {
    solid.density.resize(solid.mesh.num_cells());
    for (Index e = 0; e < solid.mesh.num_cells(); ++e) solid.density[e] = materials[solid.material_of_cell[e]].density;
  }
  for (std::size_t k = 0; k < materials.size(); ++k) {
    std::vector<double> row;
    try {
      row = law.values(materials[k].moduli, materials[k].parameters);
    } catch (const std::invalid_argument& error) {
      throw InputError((source.empty() ? "" : source + ": ") + error.what());
    }
    solid.parameters.conservativeResize(static_cast<Index>(materials.size()), static_cast<Index>(row.size()));
    for (std::size_t j = 0; j < row.size(); ++j) solid.parameters(k, j) = row[j];
  }
}

bool names_a_material(const ProblemOptions& problem) {
  const ProblemOptions plain;
  return problem.materials || !problem.parameters.empty() || problem.young != plain.young ||
         problem.poisson != plain.poisson || problem.density != plain.density;
}

/// The materials that the mesh's own file gives to its regions.
template <typename Mesh>
void set_materials_of_file(const ProblemOptions& problem, const std::map<int, FileMaterial>& of_region,
                           SolidOf<Mesh>& solid) {
  solid.law = problem.law;
  for (const auto& [tag, material] : of_region) {
    if (material.law.empty()) continue;
    if (problem.law != ProblemOptions().law && problem.law != material.law)
      throw InputError("--material " + problem.law + ": material " + material.name + " of " + problem.mesh + " is of " +
                       material.law);
    solid.law = material.law;
  }
  std::vector<Material> materials{base_material(problem)};
  std::map<int, std::int32_t> index;
  for (const auto& [tag, material] : of_region) {
    index[tag] = static_cast<std::int32_t>(materials.size());
    Material own{materials[0].moduli, material.density, material.parameters};
    if (material.law.empty()) own.moduli = {material.young, material.poisson};
    materials.push_back(own);
  }
  for (const int tag : solid.mesh.region) {
    const auto found = index.find(tag);
    solid.material_of_cell.push_back(found == index.end() ? 0 : found->second);
  }
  take_materials(named_law(solid.law, "--material"), materials, problem.mesh, solid);
}

/// A law and one material for the object, and others for the regions that the file of --materials names.
template <typename Mesh>
void set_materials(const ProblemOptions& problem, SolidOf<Mesh>& solid) {
  std::vector<Material> materials{base_material(problem)};
  const Mesh& mesh = solid.mesh;
  std::optional<JsonFields> file;
  if (problem.materials) file = JsonFields::read(*problem.materials);
  const bool law_in_file = file && file->contains("law");
  solid.law = law_in_file ? file->text("law") : problem.law;
  const MaterialLaw& law = named_law(solid.law, law_in_file ? problem.materials->string() : "--material");
  if (file) {
    const Material base = materials[0] = read_material(*file, law, materials[0]);
    if (const auto regions = file->object_if("regions")) {
      if (mesh.region.empty())
        throw InputError(problem.materials->string() + ": the mesh has no regions, so there is nothing to tell apart");
      std::map<int, std::pair<std::string, std::int32_t>>
          material_of_region;  // those that the file names, by which key
      for (const int tag : all_regions(mesh)) {
        const auto name = mesh.region_names.find(tag);
        for (const std::string& key : {name == mesh.region_names.end() ? "" : name->second, std::to_string(tag)})
          if (!key.empty() && regions->contains(key)) {
            material_of_region[tag] = {key, static_cast<std::int32_t>(materials.size())};
            materials.push_back(read_material(regions->object(key), law, base));
            break;
          }
      }
      std::map<int, std::int32_t> material_of_tag;
      for (const int tag : std::set<int>(mesh.region.begin(), mesh.region.end())) {
        std::string named;
        for (const int region : regions_of_tag(mesh, tag)) {
          const auto found = material_of_region.find(region);
          if (found == material_of_region.end()) continue;
          const auto& [key, material] = found->second;
          if (!named.empty() && !(materials[material] == materials[material_of_tag[tag]]))
            throw InputError(problem.materials->string() + ": some cells are in both '" + named + "' and '" + key +
                             "', whose materials differ");
          named = key;
          material_of_tag[tag] = material;
        }
      }
      for (const int tag : mesh.region) solid.material_of_cell.push_back(material_of_tag[tag]);
    }
    file->finish();
  }
  take_materials(law, materials, problem.materials ? problem.materials->string() : "", solid);
}

double shell_thickness(const ProblemOptions& problem, const TriangleMesh& mesh) {
  const std::string text = problem.thickness.value_or("1%");
  if (!text.ends_with('%')) return option_quantity("--thickness", text, "m");
  return option_quantity("--thickness", text, "1") * bounding_box(mesh.nodes).diagonal();
}

}  // namespace

Body load_body(const ProblemOptions& problem, const NamedMesh& named) {
  const Supports supports = read_supports(problem, named);
  const RayleighDamping damping = read_damping(problem);
  const bool by_gauss_points = problem.components == "gauss-points";
  const auto solid_body = [&]<typename Mesh>(const Mesh& mesh) -> Body {
    SolidOf<Mesh> solid{.mesh = mesh, .fixed_nodes = supports.fixed, .held_axes = supports.sliding, .damping = damping};
    if (problem.thickness)
      throw InputError("--thickness is for surfaces; the mesh has " + std::string(cell_name(Body(SolidOf<Mesh>{}))));
    if (by_gauss_points) {
      if constexpr (std::same_as<Mesh, TetMesh>)
        throw InputError(
            "--components gauss-points is for hexahedra and quadratic tets; a linear tet has one Gauss point");
      solid.component = SolidComponent::GaussPoint;
    }
    const std::map<int, FileMaterial>& of_file = named.notes.materials;
    if (!of_file.empty() && !names_a_material(problem)) {
      if (problem.mesh_unit != "m")
        warn("the materials of " + problem.mesh +
             " are taken as they are, in Pa and kg/m^3; --mesh-unit is of lengths");
      set_materials_of_file(problem, of_file, solid);
    } else {
      if (!of_file.empty()) warn("the materials of " + problem.mesh + " are not used: options name others");
      set_materials(problem, solid);
    }
    return solid;
  };
  const auto shell_body = [&](const TriangleMesh& surface) -> Body {
    if (by_gauss_points)
      throw InputError("--components gauss-points is for solids; the components of a surface are flaps");
    if (problem.law != "stvk")
      throw InputError("--material " + problem.law + " is for solids; a surface is a discrete shell");
    if (problem.materials)
      throw InputError(problem.materials->string() + ": a surface has no regions, so there is nothing to tell apart");
    if (!problem.parameters.empty())
      throw InputError("--parameter is for the laws of solids; a surface is a discrete shell");
    const std::vector<Index> neighbour = neighbour_sides(surface);
    for (Index t = 0; t < surface.num_triangles(); ++t)
      if (std::max({neighbour[3 * t], neighbour[3 * t + 1], neighbour[3 * t + 2]}) < 0)
        throw InputError(problem.mesh + ": triangle " + std::to_string(t) +
                         " shares no edge with another one: a shell cannot bend or stretch there");
    const Material base = base_material(problem);
    Shell shell =
        isotropic_shell(surface, base.moduli, shell_thickness(problem, surface), supports.fixed, base.density);
    shell.held_axes = supports.sliding;
    shell.damping = damping;
    return shell;
  };
  return std::visit(
      [&]<typename Mesh>(const Mesh& mesh) -> Body {
        if constexpr (std::same_as<Mesh, TriangleMesh>)
          return shell_body(mesh);
        else
          return solid_body(mesh);
      },
      named.mesh);
}

std::optional<std::string> locking_note(const ProblemOptions& problem, const Body& body) {
  const std::optional<double> poisson = locking_poisson(body);
  if (!poisson) return {};
  std::string cells(cell_name(body)), box = "hexbox:", same = problem.mesh;
  if (std::holds_alternative<Solid>(body)) cells = "linear " + cells;
  if (same.starts_with(box)) same = "bar:" + same.substr(box.size());
  return "Poisson's ratio is " + shown(*poisson, 5) + ": above 0.45 " + cells +
         " lock, and the object is too stiff; quadratic tets do not lock: " +
         (is_builtin(problem.mesh) ? "the mesh tet10:" + same : "a mesh of tets with 10 nodes");
}

std::string recipe_of(const ProblemOptions& problem) {
  if (problem.recipe != "default") return problem.recipe;
  const bool has_own_poses = problem.poses_file || problem.snapshots;
  return problem.relaxes && !has_own_poses && problem.equilibria != 0 ? "relaxed" : "subspace";
}

namespace {

/// Weights fitted to the full object: in modal derivatives, of shells in extended modes, unless another subspace is asked for.
ReduceOptions relaxed_options(const ProblemOptions& problem, const Body& body) {
  const bool is_shell = std::holds_alternative<Shell>(body);
  ReduceOptions options =
      is_shell ? ReduceOptions::relaxed_extended() : ReduceOptions::relaxed_derivatives(problem.modes.value_or(20));
  if (problem.subspace && !is_shell) {
    const ReduceOptions plain;
    options.modes = plain.modes;
    options.points = plain.points;
  }
  // how far the object is to move: what relaxes there are the equilibria
  if (!problem.amplitudes.empty()) options.equilibrium_amplitudes = problem.amplitudes;
  return options;
}

}  // namespace

ReduceOptions reduce_options(const ProblemOptions& problem, const NamedMesh& named, const Body& body) {
  const std::string recipe = recipe_of(problem);
  const bool relaxed = recipe == "relaxed";
  ReduceOptions options = relaxed             ? relaxed_options(problem, body)
                          : recipe == "paper" ? ReduceOptions::paper()
                                              : ReduceOptions{};
  if (problem.subspace) options.subspace = *problem.subspace;
  if (problem.dimension) options.dimension = *problem.dimension;
  if (problem.snapshots) options.snapshots = read_snapshots(*problem.snapshots, named.nodes(), named.places());
  const std::vector<std::string> parts = parts_of_subspace(options.subspace);
  const bool pca = std::ranges::find(parts, "pca") != parts.end();
  if (pca && !problem.snapshots) throw InputError("--subspace pca needs --snapshots");
  if (!pca && problem.snapshots) throw InputError("--snapshots are for --subspace pca");
  options.seed = problem.seed;
  options.checkpoint = Checkpoint(problem.checkpoint);
  if (problem.modes) options.modes = *problem.modes;
  if (problem.poses) options.poses.count = *problem.poses;
  if (problem.held_out) options.held_out_poses = *problem.held_out;
  if (problem.equilibria) options.equilibria = *problem.equilibria;
  if (problem.omega_exponent) options.poses.omega_exponent = *problem.omega_exponent;
  if (!problem.amplitudes.empty() && !relaxed) options.poses.amplitudes = problem.amplitudes;
  if (problem.full_loads) options.full_loads = *problem.full_loads;
  if (problem.norm) options.norm = value_named<ForceNorm>(*problem.norm, "norm");
  options.poses.inverted = inverted_rule(
      law(body),
      problem.inverted ? std::optional(value_named<InvertedPoses>(*problem.inverted, "inverted")) : std::nullopt);
  if (problem.poses_file) options.given_poses = read_poses(*problem.poses_file, named.nodes(), named.places());
  return options;
}

void keep_stages(const Checkpoint& checkpoint) {
  if (!checkpoint.keeps()) return;
  checkpoint.make_folder();
  on_signal_say("interrupted; the same command goes on from the stages that " + checkpoint.folder().string() +
                " keeps");
}

Index num_components_to_weight(const Body& body, const ReduceOptions& options) {
  constexpr Index most = 5000;
  Index count = with_force_model(body, [](const auto& model) { return model->num_components(); });
  if (!options.candidates.empty()) {
    std::vector<Index> eligible;
    std::ranges::set_union(options.candidates, options.must_keep, std::back_inserter(eligible));
    count = static_cast<Index>(eligible.size());
  }
  if (count > most)
    throw InputError("the selector all weights every one of " + std::to_string(count) + " " +
                     std::string(component_name(body)) + ", which is for at most " + std::to_string(most));
  return count;
}

Json problem_json(const ProblemOptions& problem, const ReduceOptions& options, const Body& body) {
  Json json{{"recipe", recipe_of(problem)},
            {"subspace", options.subspace},
            {"modes", options.modes},
            {"dimension", options.dimension},
            {"poses", options.poses.count},
            {"norm", name_of(options.norm)},
            {"omega_exponent", options.poses.omega_exponent},
            {"amplitudes", options.poses.amplitudes},
            {"inverted", name_of(*options.poses.inverted)},
            {"held_out", options.held_out_poses},
            {"equilibria", num_equilibria(body, options)},
            {"relaxed", options.relaxed},
            {"full_loads", options.full_loads},
            {"seed", options.seed},
            {"mesh_unit", problem.mesh_unit},
            {"material", law(body)},
            {"components", problem.components},
            {"young", problem.young},
            {"poisson", problem.poisson},
            {"density", problem.density},
            {"damping_alpha", problem.damping_alpha},
            {"damping_beta", problem.damping_beta},
            {"fix", problem.fix},
            {"fix_box", problem.fix_box},
            {"fix_region", problem.fix_region}};
  const auto add_files = [&](const char* key, const std::vector<std::filesystem::path>& files) {
    for (const std::filesystem::path& file : files) json[key].push_back(file.string());
  };
  add_files("fix_file", problem.fix_file);
  if (!options.equilibrium_amplitudes.empty()) json["equilibrium_amplitudes"] = options.equilibrium_amplitudes;
  if (!problem.parameters.empty()) json["parameters"] = problem.parameters;
  if (problem.thickness) json["thickness"] = *problem.thickness;
  if (problem.materials) json["materials"] = problem.materials->string();
  if (problem.snapshots) json["snapshots"] = problem.snapshots->string();
  if (problem.poses_file) json["poses_file"] = problem.poses_file->string();
  return json;
}

}  // namespace supple
