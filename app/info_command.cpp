#include <app/exit_guard.hpp>
#include <app/info_command.hpp>
#include <app/json_report.hpp>
#include <app/mesh_source.hpp>
#include <app/terminal.hpp>
#include <core/version.hpp>
#include <core/check.hpp>
#include <io/builtin_meshes.hpp>
#include <io/builtin_surfaces.hpp>
#include <io/vtu_writer.hpp>
#include <reduction/reduced_model.hpp>

#include <algorithm>
#include <fstream>
#include <numbers>
#include <set>

namespace supple {

namespace {

/// Whether a file begins as a tensor file does: the length of a header, and the header's brace.
bool is_tensor_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  char head[9] = {};
  return file.read(head, sizeof head) && head[8] == '{' && head[4] == 0 && head[5] == 0 && head[6] == 0 &&
         head[7] == 0;
}

std::string shown_point(const Point& p) {
  return shown(p[0]) + " x " + shown(p[1]) + " x " + shown(p[2]) + " m";
}

std::string joined(const Vector& values, Index most) {
  std::string text;
  for (Index k = 0; k < std::min(most, values.size()); ++k) text += (k > 0 ? ", " : "") + shown(values[k], 3);
  return text + (values.size() > most ? ", ..." : "");
}

/// Sum of sizes (volumes, areas) of the elements, worst and mean radius ratio.
struct Shapes {
  double size = 0, worst = 1, mean = 0;
};
template <typename Mesh>
Shapes element_shapes(const Mesh& mesh, Index count, double (*size)(const Mesh&, Index)) {
  Shapes shapes;
  for (Index e = 0; e < count; ++e) {
    const double quality = radius_ratio(mesh, e);
    shapes.size += size(mesh, e);
    shapes.worst = std::min(shapes.worst, quality);
    shapes.mean += quality / static_cast<double>(count);
  }
  return shapes;
}

Json mesh_json(const TetMesh& mesh, Rows& rows) {
  const BoundingBox box = bounding_box(mesh.nodes);
  const auto [volume, worst, mean] = element_shapes(mesh, mesh.num_tets(), tet_volume);
  const Index components = connected_components(mesh).count,
              faces = static_cast<Index>(boundary_faces(mesh).size());
  const Hinges hinges = boundary_hinges(mesh);
  rows.insert(rows.end(), {{"nodes", shown_count(mesh.num_nodes())},
                           {"tets", shown_count(mesh.num_tets())},
                           {"boundary faces", shown_count(faces)},
                           {"size", shown_point(box.extent()) + ", from (" + joined(box.lower, 3) + ")"},
                           {"volume", shown(volume) + " m^3"},
                           {"radius ratio", "worst " + shown(worst, 2) + ", mean " + shown(mean, 2)},
                           {"components", std::to_string(components)}});
  if (hinges.edges + hinges.nodes > 0)
    rows.emplace_back("hinges",
                      std::to_string(hinges.edges) + " edges, " + std::to_string(hinges.nodes) + " nodes");
  Json json{{"nodes", mesh.num_nodes()},
            {"tets", mesh.num_tets()},
            {"boundary_faces", faces},
            {"lower", json_numbers(box.lower)},
            {"upper", json_numbers(box.upper)},
            {"volume", volume},
            {"radius_ratio", {{"worst", worst}, {"mean", mean}}},
            {"components", components},
            {"hinges", {{"edges", hinges.edges}, {"nodes", hinges.nodes}}},
            {"regions", Json::array()}};
  for (const int tag : std::set<int>(mesh.region.begin(), mesh.region.end())) {
    const auto count = std::count(mesh.region.begin(), mesh.region.end(), tag);
    const auto name = mesh.region_names.find(tag);
    const std::string text = name == mesh.region_names.end() ? "" : name->second;
    json["regions"].push_back({{"tag", tag}, {"name", text}, {"tets", count}});
    rows.emplace_back("region " + std::to_string(tag),
                      (text.empty() ? "" : text + ", ") + shown_count(count) + " tets");
  }
  return json;
}

Json mesh_json(const TriangleMesh& mesh, Rows& rows) {
  const BoundingBox box = bounding_box(mesh.nodes);
  const auto [area, worst, mean] = element_shapes(mesh, mesh.num_triangles(), triangle_area);
  const Index components = connected_components(mesh).count,
              flaps = static_cast<Index>(interior_edges(mesh).size()),
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
  if (const Solid* solid = std::get_if<Solid>(&body)) return solid->parameters;
  const std::vector<ShellMaterial>& materials = std::get<Shell>(body).materials;
  RowMatrix rows(static_cast<Index>(materials.size()), 3);
  for (Index k = 0; k < rows.rows(); ++k) rows.row(k) << materials[k].bending, materials[k].stretch, materials[k].area;
  return rows;
}

Json model_json(const ReducedModel& model, Rows& rows) {
  const double mass = nodal_mass(model.body).sum();
  const RowMatrix materials = material_parameters(model.body);
  const RayleighDamping& damping = supple::damping(model.body);
  const std::size_t fixed = fixed_nodes(model.body).size();
  const Vector hertz = model.omega() / (2 * std::numbers::pi);
  std::string parameters;
  for (Index k = 0; k < std::min<Index>(materials.rows(), 4); ++k)
    parameters += (k > 0 ? "; " : " ") + joined(materials.row(k), 3);
  const bool shell = std::holds_alternative<Shell>(model.body);
  rows.insert(
      rows.end(),
      {{"law", std::string(law(model.body)) + "," + parameters + (shell ? " J, N/m, N/m" : " Pa") +
                   (materials.rows() > 4 ? "; ..." : "")},
       {"mass", shown(mass) + " kg"},
       {"fixed nodes", shown_count(static_cast<long long>(fixed))},
       {"damping", "alpha " + shown(damping.alpha) + " 1/s, beta " + shown(damping.beta) + " s"},
       {"subspace", "dimension " + std::to_string(model.dim()) + ", " + model.subspace_name},
       {"modes", joined(hertz, 8) + " Hz"},
       {"points", std::to_string(model.indices.size())}});
  Json json{{"dimension", model.dim()},
            {"points", model.indices.size()},
            {"subspace", model.subspace_name},
            {"law", law(model.body)},
            {"materials", Json::array()},
            {"mass", mass},
            {"fixed_nodes", fixed},
            {"damping", {{"alpha", damping.alpha}, {"beta", damping.beta}}},
            {"omega", json_numbers(model.omega())},
            {"indices", model.indices},
            {"weights", json_numbers(model.weights)},
            {"provenance", Json::object()}};
  for (Index k = 0; k < materials.rows(); ++k) json["materials"].push_back(json_numbers(materials.row(k)));
  for (const auto& [key, text] : model.provenance) {
    const Json parsed =
        key == "options" || key.ends_with("_error") ? Json::parse(text, nullptr, false) : Json(text);
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
  if (!is_builtin(source) && !is_builtin_surface(source) && is_tensor_file(source)) {
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

void MeshCommand::run() const {
  require_writable(output);
  const NamedMesh named = load_mesh(source);
  const ExitGuard guard;
  if (const auto* surface = std::get_if<TriangleMesh>(&named.mesh)) {
    write_vtu(output, surface->nodes, surface->triangles, {});
    return;
  }
  const TetMesh& mesh = std::get<TetMesh>(named.mesh);
  VtuFields fields;
  if (!mesh.region.empty()) {
    RowMatrix region(mesh.num_tets(), 1);
    for (Index e = 0; e < mesh.num_tets(); ++e) region(e, 0) = mesh.region[e];
    fields.cell_data.push_back({"region", region});
  }
  write_vtu(output, mesh.nodes, mesh.tets, fields);
}

}  // namespace supple
