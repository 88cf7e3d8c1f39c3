#include <app/commands/info_command.hpp>
#include <app/commands/mesh_source.hpp>
#include <app/commands/shared_options.hpp>
#include <app/report/json_report.hpp>
#include <app/report/terminal.hpp>
#include <core/check.hpp>
#include <core/version.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <reduction/model/reduced_model.hpp>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <concepts>
#include <map>
#include <numbers>
#include <set>

namespace supple {

namespace {

std::string shown_point(const Point& p) {
  return shown(p[0]) + " x " + shown(p[1]) + " x " + shown(p[2]) + " m";
}

std::string joined(const Vector& values, Index most) {
  std::string text;
  for (Index k = 0; k < std::min(most, values.size()); ++k) text += (k > 0 ? ", " : "") + shown(values[k], 3);
  return text + (values.size() > most ? ", ..." : "");
}

/// Sum of sizes (volumes, areas) of the elements, worst and mean of their shapes.
struct Shapes {
  double size = 0, worst = 1, mean = 0;
};
template <typename Size, typename Quality>
Shapes element_shapes(Index count, const Size& size, const Quality& quality_of) {
  Shapes shapes;
  for (Index e = 0; e < count; ++e) {
    const double quality = quality_of(e);
    shapes.size += size(e);
    shapes.worst = std::min(shapes.worst, quality);
    shapes.mean += quality / static_cast<double>(count);
  }
  return shapes;
}

template <typename Mesh>
Json mesh_json(const Mesh& mesh, Rows& rows) {
  constexpr bool is_hex = std::same_as<Mesh, HexMesh>;
  const std::string kind(cell_name(SolidOf<Mesh>{})), shape = is_hex ? "scaled Jacobian" : "radius ratio";
  const BoundingBox box = bounding_box(mesh.nodes);
  const auto [volume, worst, mean] = element_shapes(
      mesh.num_cells(), [&](Index e) { return cell_volume(mesh, e); },
      [&](Index e) {
        if constexpr (is_hex)
          return scaled_jacobian(mesh, e);
        else
          return radius_ratio(mesh, e);
      });
  const Index components = connected_components(mesh).count,
              faces = static_cast<Index>(boundary_faces(mesh).size()) / triangles_per_face<Mesh>;
  const Hinges hinges = boundary_hinges(mesh);
  rows.insert(rows.end(), {{"nodes", shown_count(mesh.num_nodes())},
                           {kind, shown_count(mesh.num_cells())},
                           {"boundary faces", shown_count(faces)},
                           {"size", shown_point(box.extent()) + ", from (" + joined(box.lower, 3) + ")"},
                           {"volume", shown(volume) + " m^3"},
                           {shape, "worst " + shown(worst, 2) + ", mean " + shown(mean, 2)},
                           {"components", std::to_string(components)}});
  if (hinges.edges + hinges.nodes > 0)
    rows.emplace_back("hinges", std::to_string(hinges.edges) + " edges, " + std::to_string(hinges.nodes) + " nodes");
  Json json{{"nodes", mesh.num_nodes()},
            {json_key(kind), mesh.num_cells()},
            {"boundary_faces", faces},
            {"lower", json_numbers(box.lower)},
            {"upper", json_numbers(box.upper)},
            {"volume", volume},
            {json_key(shape), {{"worst", worst}, {"mean", mean}}},
            {"components", components},
            {"hinges", {{"edges", hinges.edges}, {"nodes", hinges.nodes}}},
            {"regions", Json::array()}};
  std::map<int, Index> cells_of_region;
  for (const int tag : mesh.region)
    for (const int region : regions_of_tag(mesh, tag)) ++cells_of_region[region];
  for (const auto& [tag, count] : cells_of_region) {
    const auto name = mesh.region_names.find(tag);
    const std::string text = name == mesh.region_names.end() ? "" : name->second;
    json["regions"].push_back({{"tag", tag}, {"name", text}, {json_key(kind), count}});
    rows.emplace_back("region " + std::to_string(tag),
                      (text.empty() ? "" : text + ", ") + shown_count(count) + " " + kind);
  }
  return json;
}

Json mesh_json(const TriangleMesh& mesh, Rows& rows) {
  const BoundingBox box = bounding_box(mesh.nodes);
  const auto [area, worst, mean] = element_shapes(
      mesh.num_triangles(), [&](Index t) { return triangle_area(mesh, t); },
      [&](Index t) { return radius_ratio(mesh, t); });
  const Index components = connected_components(mesh).count, flaps = static_cast<Index>(interior_edges(mesh).size()),
              boundary = static_cast<Index>(boundary_edges(mesh).size());
  rows.insert(rows.end(), {{"nodes", shown_count(mesh.num_nodes())},
                           {"triangles", shown_count(mesh.num_triangles())},
                           {"flaps", shown_count(flaps)},
                           {"boundary edges", shown_count(boundary)},
                           {"size", shown_point(box.extent()) + ", from (" + joined(box.lower, 3) + ")"},
                           {"area", shown(area) + " m^2"},
                           {"radius ratio", "worst " + shown(worst, 2) + ", mean " + shown(mean, 2)},
                           {"components", std::to_string(components)}});
  return {{"nodes", mesh.num_nodes()},
          {"triangles", mesh.num_triangles()},
          {"flaps", flaps},
          {"boundary_edges", boundary},
          {"lower", json_numbers(box.lower)},
          {"upper", json_numbers(box.upper)},
          {"area", area},
          {"radius_ratio", {{"worst", worst}, {"mean", mean}}},
          {"components", components}};
}

/// One row a material: the parameters of the law, of a shell k_B [J], k_L and k_A [N/m].
RowMatrix material_parameters(const Body& body) {
  if (!std::holds_alternative<Shell>(body))
    return visit_solid(body, [](const auto& solid) { return solid.parameters; });
  const std::vector<ShellMaterial>& materials = std::get<Shell>(body).materials;
  RowMatrix rows(static_cast<Index>(materials.size()), 3);
  for (Index k = 0; k < rows.rows(); ++k) rows.row(k) << materials[k].bending, materials[k].stretch, materials[k].area;
  return rows;
}

Json model_json(const ReducedModel& model, Rows& rows) {
  const double mass = nodal_mass(model.body).sum();
  const RowMatrix materials = material_parameters(model.body);
  const RayleighDamping& damping = supple::damping(model.body);
  const std::size_t fixed = fixed_nodes(model.body).size(), sliding = held_axes(model.body).size();
  const Vector hertz = model.omega() / (2 * std::numbers::pi);
  std::string parameters;
  for (Index k = 0; k < std::min<Index>(materials.rows(), 4); ++k)
    parameters += (k > 0 ? "; " : " ") + joined(materials.row(k), 3);
  const bool shell = std::holds_alternative<Shell>(model.body);
  rows.insert(rows.end(),
              {{"law", std::string(law(model.body)) + "," + parameters + (shell ? " J, N/m, N/m" : " Pa") +
                           (materials.rows() > 4 ? "; ..." : "")},
               {"mass", shown(mass) + " kg"},
               {"fixed nodes", shown_count(static_cast<long long>(fixed)) +
                                   (sliding > 0 ? ", " + shown_count(static_cast<long long>(sliding)) + " slide" : "")},
               {"damping", "alpha " + shown(damping.alpha) + " 1/s, beta " + shown(damping.beta) + " s"},
               {"subspace", "dimension " + std::to_string(model.dim()) + ", " + model.subspace_name},
               {"modes", joined(hertz, 8) + " Hz"},
               {"points", std::to_string(model.indices.size()) + " " + std::string(component_name(model.body))}});
  Json json{{"dimension", model.dim()},
            {"points", model.indices.size()},
            {"component", component_name(model.body)},
            {"subspace", model.subspace_name},
            {"law", law(model.body)},
            {"materials", Json::array()},
            {"mass", mass},
            {"fixed_nodes", fixed},
            {"sliding_nodes", sliding},
            {"damping", {{"alpha", damping.alpha}, {"beta", damping.beta}}},
            {"omega", json_numbers(model.omega())},
            {"indices", model.indices},
            {"weights", json_numbers(model.weights)},
            {"provenance", Json::object()}};
  for (Index k = 0; k < materials.rows(); ++k) json["materials"].push_back(json_numbers(materials.row(k)));
  for (const auto& [key, text] : model.provenance) {
    const Json parsed = key == "options" || key.ends_with("_error") ? Json::parse(text, nullptr, false) : Json(text);
    json["provenance"][key] = parsed.is_discarded() ? Json(text) : parsed;
    rows.emplace_back(key, text);
  }
  return json;
}

}  // namespace

void InfoCommand::run() const {
  require_writable(json);
  Rows rows;
  Json report{{"command", "info"}, {"version", SUPPLE_VERSION}, {"source", source}};
  std::string kind = "mesh";
  if (is_model(source)) {
    kind = "reduced model";
    const ReducedModel model = load_model(source);
    report["kind"] = "model";
    report["mesh"] = std::visit([&](const auto& some) { return mesh_json(some.mesh, rows); }, model.body);
    report.update(model_json(model, rows));
  } else {
    const NamedMesh named = load_mesh(source);
    report["kind"] = "mesh";
    rows.emplace_back("format", named.notes.format);
    report["format"] = named.notes.format;
    report.update(std::visit([&](const auto& mesh) { return mesh_json(mesh, rows); }, named.mesh));
    report["warnings"] = named.notes.warnings;
  }
  if (!is_stdout(json)) print_rows(stdout, source + ": " + kind, rows);
  write_json(json, report);
}

void InfoCommand::declare(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("info", "Say what a model or a mesh holds");
  command.add_option("SOURCE", source, "Model, mesh file or built-in mesh")->required();
  declare_json(command, json);
  declare_plugins(command);
  command.callback([this] { run(); });
}

}  // namespace supple
