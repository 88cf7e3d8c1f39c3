#include <core/check.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/surface.hpp>
#include <viewer/session/view_model.hpp>

#include <algorithm>
#include <functional>
#include <numbers>

namespace supple {

ViewGeometry::ViewGeometry(const ReducedModel& model) {
  Surface surface(model.body);
  nodes = std::move(surface.nodes);
  triangles = std::move(surface.triangles);
  num_surface_nodes = num_nodes();
  number.assign(supple::num_nodes(model.body), -1);
  for (Index k = 0; k < num_nodes(); ++k) number[nodes[k]] = k;
  with_force_model(model.body, [&](const auto& force) {
    for (const Index i : model.indices) {
      const auto stencil = force->stencil(i);
      component_nodes = static_cast<int>(stencil.size());
      for (const Index v : stencil) {
        if (number[v] < 0) {
          number[v] = num_nodes();
          nodes.push_back(v);
        }
        corners.push_back(number[v]);
      }
    }
  });
  weights = model.weights;
  rest = node_positions(model.body)(nodes, Eigen::all);
  for (const Index v : fixed_nodes(model.body))
    if (number[v] >= 0) fixed.push_back(number[v]);
  std::ranges::sort(fixed);
  std::visit(
      [&]<typename S>(const std::shared_ptr<const S>& subspace) {
        block = S::block;
        constexpr Index rows = 3 / S::block;
        basis.resize(rows * num_nodes(), subspace->W.cols());
        for (Index k = 0; k < num_nodes(); ++k)
          basis.middleRows(rows * k, rows) = subspace->W.middleRows(rows * nodes[k], rows).template cast<float>();
      },
      model.subspace);
}

std::vector<Index> ViewGeometry::in_mesh(const std::vector<Index>& some) const {
  std::vector<Index> result;
  for (const Index k : some) {
    require(k >= 0 && k < num_nodes(),
            "node " + std::to_string(k) + " does not exist, expected 0 to " + std::to_string(num_nodes() - 1));
    result.push_back(nodes[k]);
  }
  return result;
}

ViewGeometry::Floats ViewGeometry::surface_displacements(VectorIn q) const {
  require_size("q", q.size(), basis.cols() * block);
  const Eigen::VectorXf coordinates = q.cast<float>();
  const Eigen::Map<const Floats> fields(coordinates.data(), basis.cols(), block);
  Floats u(num_surface_nodes, 3);
  Eigen::Map<Floats>(u.data(), 3 * num_surface_nodes / block, block).noalias() =
      basis.topRows(3 * num_surface_nodes / block) * fields;
  return u;
}

namespace {

void check_recordings(const std::vector<ViewRecording>& recordings, const ViewGeometry& geometry) {
  require(recordings.size() <= 2, "there are " + std::to_string(recordings.size()) + " recordings, expected at most 2");
  for (const ViewRecording& recording : recordings) {
    require(recording.num_frames() > 0, "recording '" + recording.name + "' has no frames");
    require(
        recording.frames.rows() == recording.num_frames() && recording.frames.cols() == 3 * geometry.num_surface_nodes,
        "recording '" + recording.name + "' has " + std::to_string(recording.frames.rows()) + " frames of " +
            std::to_string(recording.frames.cols()) + " numbers, expected " + std::to_string(recording.num_frames()) +
            " of " + std::to_string(3 * geometry.num_surface_nodes));
    require(std::ranges::is_sorted(recording.time, std::less_equal()) && recording.time.allFinite() &&
                recording.frames.allFinite(),
            "recording '" + recording.name + "' has times that do not ascend or numbers that are not finite");
  }
  if (recordings.empty()) return;
  const auto [begin, end] = common_time(recordings);
  require(begin <= end, "the recordings '" + recordings.front().name + "' and '" + recordings.back().name +
                            "' have no time in common");
}

}  // namespace

std::pair<double, double> common_time(const std::vector<ViewRecording>& recordings) {
  std::pair span{recordings.front().time[0], recordings.front().time.tail<1>()[0]};
  for (const ViewRecording& recording : recordings) {
    span.first = std::max(span.first, recording.time[0]);
    span.second = std::min(span.second, recording.time.tail<1>()[0]);
  }
  return span;
}

ViewModel::ViewModel(ReducedModel reduced, std::string title, std::vector<std::string> what_to_know,
                     std::vector<ViewRecording> to_play)
    : model(std::move(reduced)),
      name(std::move(title)),
      notes(std::move(what_to_know)),
      recordings(std::move(to_play)),
      geometry(model),
      system(model.system(default_precision(model))),
      estimator(error_estimator(model)),
      modes(reduced_modes(model)),
      mass(nodal_mass(model.body).sum()),
      box(bounding_box(rest())),
      diagonal(box.diagonal()) {
  if (modes.num_zero == modes.omega.size()) throw SolverError("the model has no flexible mode");
  check_recordings(recordings, geometry);
}

double ViewModel::frequency(Index k) const {
  return modes.omega[modes.num_zero + k] / (2 * std::numbers::pi);
}

double ViewModel::default_step() const {
  return std::min(1 / (60 * frequency(0)), 1.0 / 60);
}

}  // namespace supple
