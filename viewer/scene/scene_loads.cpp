#include <core/text.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/body/surface.hpp>
#include <viewer/scene/scene_loads.hpp>

#include <algorithm>
#include <numeric>

namespace supple {

Index nearest_node(const Points& nodes, const Point& point) {
  Index nearest = 0;
  (nodes.rowwise() - point.transpose()).rowwise().squaredNorm().minCoeff(&nearest);
  return nearest;
}

Interval node_range(const Body& body) {
  return between(0, static_cast<double>(node_places(body).num_places(num_nodes(body)) - 1));
}

namespace {

Index read_node(const JsonFields& fields, const Body& body) {
  const Index place = fields.integer("node", node_range(body)), node = node_places(body).node(place);
  if (node < 0) fields.fail("node", "is " + std::to_string(place) + ", a node that no cell has");
  return node;
}

/// The node nearest to the point "at". \throws InputError for a point farther off than half the object's diagonal.
Index node_at(const JsonFields& fields, const Points& nodes) {
  const Point at = fields.point("at");
  const Index node = nearest_node(nodes, at);
  const double distance = (nodes.row(node).transpose() - at).norm(), diagonal = bounding_box(nodes).diagonal();
  if (distance > 0.5 * diagonal)
    fields.fail("at", "is " + shown(distance, 3) + " m from the nearest node of an object of " + shown(diagonal, 3) +
                          " m; lengths are in metres");
  return node;
}

std::vector<Index> all_nodes(Index n) {
  std::vector<Index> nodes(static_cast<std::size_t>(n));
  std::iota(nodes.begin(), nodes.end(), Index{0});
  return nodes;
}

}  // namespace

NodeShares read_nodes(const JsonFields& fields, const Body& body) {
  if (fields.contains("node") + fields.contains("at") + fields.contains("nodes") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'node', 'at' and 'nodes'");
  if (fields.contains("node")) return {{read_node(fields, body), 1.0}};
  if (fields.contains("at")) return {{node_at(fields, node_positions(body)), 1.0}};
  const std::string rule = fields.text("nodes");
  std::vector<Index> nodes;
  try {
    nodes = select_nodes(node_positions(body), rule);
  } catch (const InputError& error) {
    fields.fail("nodes", std::string("selects nothing: ") + error.what());
  }
  const Vector mass = nodal_mass(body);
  NodeShares shares;
  double sum = 0;
  for (const Index v : nodes) sum += mass[v];
  for (const Index v : nodes) shares.emplace_back(v, mass[v] / sum);
  return shares;
}

std::optional<std::string> held_nodes_note(const JsonFields& fields, const NodeShares& nodes, const Body& body,
                                           const std::string& what) {
  double held = 0;
  for (const auto& [node, share] : nodes)
    if (std::ranges::binary_search(fixed_nodes(body), node)) held += share;
  if (held <= 0.01) return {};
  return fields.source() + ": " + fields.place() + ": " + shown(100 * held, 3) + " % of this " + what +
         " acts on nodes that the model holds, and moves nothing";
}

std::string read_option(const JsonFields& fields, const OptionInfo& option) {
  switch (option.type) {
    case OptionType::WholeNumber:
      return std::to_string(fields.integer(option.name));
    case OptionType::Number:
      return exact(fields.number(option.name));
    case OptionType::Flag:
      return fields.flag(option.name) ? "yes" : "no";
    case OptionType::Word:
      return fields.text(option.name);
  }
  return "";
}

AnyOutsideForce read_outside_force(const JsonFields& fields, const Body& body) {
  const Choice choice = read_choice(fields, "force", outside_forces());
  TouchedNodes where{node_positions(body), {}, {}, {}};
  if (fields.contains("nodes")) {
    for (const auto& [node, share] : read_nodes(fields, body)) where.nodes.push_back(node);
  } else {
    where.nodes = all_nodes(num_nodes(body));
  }
  const Vector mass = nodal_mass(body);
  where.shares.resize(static_cast<Index>(where.nodes.size()));
  std::vector<char> touched(static_cast<std::size_t>(mass.size()), false);
  for (std::size_t k = 0; k < where.nodes.size(); ++k) {
    where.shares[static_cast<Index>(k)] = mass[where.nodes[k]];
    touched[static_cast<std::size_t>(where.nodes[k])] = true;
  }
  where.shares /= where.shares.sum();
  const Surface surface(body);
  for (const Triangle& triangle : surface.triangles) {
    const std::array<Index, 3> corners{surface.nodes[triangle[0]], surface.nodes[triangle[1]],
                                       surface.nodes[triangle[2]]};
    if (touched[corners[0]] && touched[corners[1]] && touched[corners[2]]) where.triangles.push_back(corners);
  }
  try {
    return outside_forces().at(choice.name).make(where, choice.options);
  } catch (const std::invalid_argument& error) {
    fields.fail("force", "is refused: " + std::string(error.what()));
  }
}

}  // namespace supple
