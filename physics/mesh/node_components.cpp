#include <physics/mesh/node_components.hpp>

#include <algorithm>
#include <numeric>

namespace supple {

NodeComponents connected_components(std::span<const Index> stencils, Index stencil_size, Index num_nodes) {
  std::vector<Index> parent(num_nodes);
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t k = 0; k < stencils.size(); ++k) {
    const Index r = root(stencils[k]), s = root(stencils[k - k % stencil_size]);
    parent[std::max(r, s)] = std::min(r, s);
  }
  NodeComponents components;
  components.of_node.assign(num_nodes, -1);
  for (Index v = 0; v < num_nodes; ++v) {
    const Index r = root(v);  // the smallest node of its component, so numbered before v
    components.of_node[v] = r == v ? components.count++ : components.of_node[r];
  }
  return components;
}

}  // namespace supple
