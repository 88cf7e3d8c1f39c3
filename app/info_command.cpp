#include <app/exit_guard.hpp>
#include <app/info_command.hpp>
#include <app/json_report.hpp>
#include <app/mesh_source.hpp>
#include <app/terminal.hpp>
#include <core/check.hpp>
#include <io/builtin_meshes.hpp>
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

Json mesh_json(const TetMesh& mesh, Rows& rows) {
  const BoundingBox box = bounding_box(mesh.nodes);
  double volume = 0, worst = 1, sum = 0;
  for (Index e = 0; e < mesh.num_tets(); ++e) {
    const double quality = radius_ratio(mesh, e);
    volume += tet_volume(mesh, e);
    worst = std::min(worst, quality);
    sum += quality;
  }
  const double mean = sum / static_cast<double>(mesh.num_tets());
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

Json model_json(const ReducedModel& model, Rows& rows) {
  const Solid& solid = model.solid;
  const double mass = solid.nodal_mass().sum();
  const Vector hertz = model.omega() / (2 * std::numbers::pi);
  const bool nodal = model.subspace.index() == 0;
  std::string parameters;
  for (Index k = 0; k < std::min<Index>(solid.parameters.rows(), 4); ++k)
    parameters += (k > 0 ? "; " : " ") + joined(solid.parameters.row(k), 3);
  rows.insert(
      rows.end(),
      {{"law", solid.law + "," + parameters + " Pa" + (solid.parameters.rows() > 4 ? "; ..." : "")},
       {"mass", shown(mass) + " kg"},
       {"fixed nodes", shown_count(static_cast<long long>(solid.fixed_nodes.size()))},
       {"damping", "alpha " + shown(solid.damping.alpha) + " 1/s, beta " + shown(solid.damping.beta) + " s"},
       {"subspace", "dimension " + std::to_string(model.dim()) + (nodal ? ", extended modal" : ", modal")},
       {"modes", joined(hertz, 8) + " Hz"},
       {"points", std::to_string(model.indices.size())}});
  Json json{{"dimension", model.dim()},
            {"points", model.indices.size()},
            {"subspace", nodal ? "extended" : "modal"},
            {"law", solid.law},
            {"materials", Json::array()},
            {"mass", mass},
            {"fixed_nodes", solid.fixed_nodes.size()},
            {"damping", {{"alpha", solid.damping.alpha}, {"beta", solid.damping.beta}}},
            {"omega", json_numbers(model.omega())},
            {"indices", model.indices},
            {"weights", json_numbers(model.weights)},
            {"provenance", Json::object()}};
  for (Index k = 0; k < solid.parameters.rows(); ++k)
    json["materials"].push_back(json_numbers(solid.parameters.row(k)));
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
  if (!is_builtin(source) && is_tensor_file(source)) {
    kind = "reduced model";
    const ReducedModel model = load_model(source);
    report["kind"] = "model";
    report["mesh"] = mesh_json(model.solid.mesh, rows);
    report.update(model_json(model, rows));
  } else {
    const NamedMesh named = load_mesh(source);
    report["kind"] = "mesh";
    rows.emplace_back("format", named.notes.format);
    report["format"] = named.notes.format;
    report.update(mesh_json(named.mesh, rows));
    report["warnings"] = named.notes.warnings;
    for (const std::string& warning : named.notes.warnings) warn(source + ": " + warning);
  }
  if (!is_stdout(json)) print_rows(stdout, source + ": " + kind, rows);
  write_json(json, report);
}

void MeshCommand::run() const {
  require_writable(output);
  const NamedMesh named = load_mesh(source);
  for (const std::string& warning : named.notes.warnings) warn(source + ": " + warning);
  VtuFields fields;
  if (!named.mesh.region.empty()) {
    RowMatrix region(named.mesh.num_tets(), 1);
    for (Index e = 0; e < named.mesh.num_tets(); ++e) region(e, 0) = named.mesh.region[e];
    fields.cell_data.push_back({"region", region});
  }
  const ExitGuard guard;
  write_vtu(output, named.mesh.nodes, named.mesh.tets, fields);
}

}  // namespace supple
