#include <physics/time/integrator_library.hpp>
#include <viewer/server/messages.hpp>
#include <viewer/server/resource.hpp>
#include <viewer/session/simulation_session.hpp>

#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>
#include <cstdlib>

namespace supple {

namespace {

static_assert(std::endian::native == std::endian::little, "arrays are sent as they are in memory");

constexpr Index most_modes = 30;

/// An array of these numbers, as Number.
template <typename Number, typename Values>
Resource array(const Values& values) {
  Resource resource{"application/octet-stream", {}};
  resource.bytes.reserve(std::size(values) * sizeof(Number));
  for (const auto value : values) {
    const auto number = static_cast<Number>(value);
    resource.bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
  }
  return resource;
}

/// Written with the model; null where it was not measured.
double full_error(const ReducedModel& model) {
  const auto found = model.provenance.find("full_error");
  return found == model.provenance.end() ? NAN : std::strtod(found->second.c_str(), nullptr);
}

std::string described(const ViewModel& model, Index num_modes) {
  const ViewGeometry& geometry = model.geometry;
  const auto list = [](const auto& values) { return std::vector<double>(values.begin(), values.end()); };
  nlohmann::ordered_json json{{"protocol", protocol_version},
                              {"name", model.name},
                              {"nodes", geometry.num_nodes()},
                              {"surface_nodes", geometry.num_surface_nodes},
                              {"triangles", geometry.triangles.size()},
                              {"block", geometry.block},
                              {"fields", geometry.basis.cols()},
                              {"dimension", model.dim()},
                              {"components", geometry.weights.size()},
                              {"component_nodes", geometry.component_nodes},
                              {"solid", !std::holds_alternative<Shell>(model.model.body)},
                              {"low", list(model.box.lower)},
                              {"high", list(model.box.upper)},
                              {"diagonal", model.diagonal},
                              {"mass", model.mass},
                              {"fixed", geometry.fixed},
                              {"indicator", model.estimator.has_value()},
                              {"step", model.default_step()},
                              {"pull_stiffness", default_pull_stiffness(model)},
                              {"handle_stiffness", default_handle_stiffness(model.softest_eigenvalue(), model.mass)},
                              {"integrators", integrators().names()},
                              {"full_error", full_error(model.model)},
                              {"notes", model.notes}};
  json["recording"] = nullptr;
  if (!model.recordings.empty()) {
    const auto [begin, end] = common_time(model.recordings);
    json["recording"] = {
        {"begin", begin}, {"duration", end - begin}, {"frames", model.recordings.front().num_frames()}};
    for (const ViewRecording& recording : model.recordings) json["recording"]["names"].push_back(recording.name);
  }
  for (Index k = 0; k < num_modes; ++k) json["frequencies"].push_back(model.frequency(k));
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

Resources model_resources(const ViewModel& model) {
  const ViewGeometry& geometry = model.geometry;
  const Index num_modes = std::min(model.num_flexible_modes(), most_modes);
  RowMatrix modes(num_modes, model.dim());
  for (Index k = 0; k < num_modes; ++k) modes.row(k) = model.mode(k).transpose();
  std::vector<Index> places;
  for (const Index v : geometry.nodes) places.push_back(node_places(model.model.body).place(v));
  std::vector<Index> corners;
  for (const Triangle& triangle : geometry.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
  return {{"/model.json", {"application/json", described(model, num_modes)}},
          {"/model/positions.bin", array<float>(geometry.rest.reshaped<Eigen::RowMajor>())},
          {"/model/triangles.bin", array<std::uint32_t>(corners)},
          {"/model/basis.bin", array<float>(geometry.basis.reshaped<Eigen::RowMajor>())},
          {"/model/nodes.bin", array<std::uint32_t>(places)},
          {"/model/components.bin", array<std::uint32_t>(geometry.corners)},
          {"/model/weights.bin", array<float>(geometry.weights)},
          {"/model/modes.bin", array<float>(modes.reshaped<Eigen::RowMajor>())}};
}

}  // namespace supple
