#include <reduction/editing/edit_scene.hpp>

#include <algorithm>

namespace supple {

std::vector<Handle> make_handles(const EditScene& scene, double softest_eigenvalue, double mass) {
  std::vector<Handle> handles;
  for (const HandleRegion& region : scene.handles) {
    const Index count = std::min<Index>(region.samples.value_or(100), static_cast<Index>(region.nodes.size()));
    const double weight =
        region.weight.value_or(default_handle_stiffness(softest_eigenvalue, mass) / (2 * static_cast<double>(count)));
    handles.emplace_back(region.nodes, count, weight, scene.seed + handles.size());
  }
  return handles;
}

std::vector<std::vector<RigidMotion>> handle_paths(const EditScene& scene, const std::vector<Handle>& handles,
                                                   const Points& rest_positions) {
  std::vector<std::vector<RigidMotion>> path;
  std::vector<RigidMotion> last(handles.size());
  for (const Edit& edit : scene.edits) {
    const std::vector<RigidMotion> start = last;
    for (Index k = 1; k <= edit.increments; ++k) {
      for (const auto& [handle, motion] : edit.moves) {
        const RigidMotion way = motion.after(start[handle].inverse());
        const Point centre = start[handle](handles[handle].centre(rest_positions));
        const double share = static_cast<double>(k) / static_cast<double>(edit.increments);
        last[handle] = k == edit.increments ? motion : way.part(share, centre).after(start[handle]);
      }
      path.push_back(last);
    }
  }
  return path;
}

}  // namespace supple
