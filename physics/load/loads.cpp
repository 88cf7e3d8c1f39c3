#include <core/check.hpp>
#include <physics/load/loads.hpp>

#include <algorithm>
#include <cmath>

namespace supple {

void check_loads(const Loads& loads, Index num_nodes) {
  const auto check_node = [&](const char* what, std::size_t k, Index node) {
    require(node >= 0 && node < num_nodes, std::string(what) + " " + std::to_string(k) + " is at node " +
                                               std::to_string(node) + ", expected 0 to " +
                                               std::to_string(num_nodes - 1));
  };
  require(loads.gravity.allFinite(), "gravity is not finite");
  for (std::size_t k = 0; k < loads.forces.size(); ++k) {
    check_node("force", k, loads.forces[k].node);
    require(loads.forces[k].force.allFinite(), "force " + std::to_string(k) + " is not finite");
  }
  for (std::size_t k = 0; k < loads.springs.size(); ++k) {
    const PointSpring& spring = loads.springs[k];
    check_node("spring", k, spring.node);
    require(
        std::isfinite(spring.stiffness) && spring.stiffness > 0,
        "spring " + std::to_string(k) + " has stiffness " + std::to_string(spring.stiffness) + " N/m, expected > 0");
    require(spring.displacement.allFinite(), "spring " + std::to_string(k) + " has a target that is not finite");
  }
  for (std::size_t k = 0; k < loads.others.size(); ++k) {
    const std::span<const Index> nodes = loads.others[k].nodes();
    std::vector<Index> sorted(nodes.begin(), nodes.end());
    std::ranges::sort(sorted);
    for (const Index node : sorted) check_node("outside force", k, node);
    const auto twice = std::ranges::adjacent_find(sorted);
    require(twice == sorted.end(), "outside force " + std::to_string(k) + " touches a node twice");
  }
}

}  // namespace supple
