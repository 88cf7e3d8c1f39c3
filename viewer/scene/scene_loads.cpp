#include <core/text.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/body/surface.hpp>
#include <physics/body/surface_shares.hpp>
#include <viewer/scene/scene_loads.hpp>

#include <algorithm>
#include <cmath>
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

/// What the rule "nodes", or the group "region" of the mesh's file, selects.
NodeGroup read_group(const JsonFields& fields, const Body& body) {
  const bool is_region = fields.contains("region");
  const std::string text = fields.text(is_region ? "region" : "nodes");
  try {
    if (!is_region) return {select_nodes(node_positions(body), text), {}};
    if (std::holds_alternative<Shell>(body)) throw InputError("a surface has no regions");
    return visit_solid(body, [&](const auto& solid) -> NodeGroup {
      NodeGroup group{nodes_of_region(solid.mesh, text), {}};
      const auto own = node_groups(body).find(text);  // unless cells have the name
      return own != node_groups(body).end() && own->second.nodes == group.nodes ? own->second : group;
    });
  } catch (const InputError& error) {
    fields.fail(is_region ? "region" : "nodes", std::string("selects nothing: ") + error.what());
  }
}

}  // namespace

NodeShares read_nodes(const JsonFields& fields, const Body& body) {
  if (fields.contains("node") + fields.contains("at") + fields.contains("nodes") + fields.contains("region") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'node', 'at', 'nodes' and 'region'");
  if (fields.contains("node")) return {{read_node(fields, body), 1.0}};
  if (fields.contains("at")) return {{node_at(fields, node_positions(body)), 1.0}};
  const std::vector<Index> nodes = read_group(fields, body).nodes;
  const Vector mass = nodal_mass(body);
  NodeShares shares;
  double sum = 0;
  for (const Index v : nodes) sum += mass[v];
  for (const Index v : nodes) shares.emplace_back(v, mass[v] / sum);
  return shares;
}

std::vector<NodalForce> read_surface_load(const JsonFields& fields, const Body& body) {
  if (fields.contains("traction") + fields.contains("pressure") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'traction' and 'pressure'");
  if (fields.contains("nodes") + fields.contains("region") != 1)
    throw InputError(fields.source() + ": " + fields.place() + " needs one of 'nodes' and 'region'");
  const std::vector<SurfaceShare> shares = surface_shares(body, read_group(fields, body));
  if (shares.empty())
    fields.fail(fields.contains("region") ? "region" : "nodes",
                "selects no face: none of the surface has all of its nodes there");
  std::vector<NodalForce> forces;
  if (fields.contains("traction")) {
    const Point traction = fields.point("traction", "Pa");
    for (const SurfaceShare& share : shares) forces.push_back({share.node, share.area * traction});
  } else {
    const double pressure = fields.number("pressure", any_number, "Pa");
    for (const SurfaceShare& share : shares) forces.push_back({share.node, -pressure * share.normal});
  }
  return forces;
}

std::optional<std::string> held_nodes_note(const JsonFields& fields, const std::vector<NodalForce>& forces,
                                           const Body& body, const std::string& what) {
  double held = 0, all = 0;
  const std::vector<HeldAxes>& sliding = held_axes(body);
  for (const auto& [node, force] : forces) {
    int axes = std::ranges::binary_search(fixed_nodes(body), node) ? HeldAxes::all : 0;
    const auto slides = std::ranges::lower_bound(sliding, node, {}, &HeldAxes::node);
    if (slides != sliding.end() && slides->node == node) axes = slides->axes;
    for (int c = 0; c < 3; ++c) {
      all += std::abs(force[c]);
      if (axes >> c & 1) held += std::abs(force[c]);
    }
  }
  if (!(held > 0.01 * all)) return {};
  return fields.source() + ": " + fields.place() + ": " + shown(100 * held / all, 3) + " % of this " + what +
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
  NodeGroup part;
  if (fields.contains("nodes") || fields.contains("region")) {
    if (fields.contains("nodes") + fields.contains("region") != 1)
      throw InputError(fields.source() + ": " + fields.place() + " needs one of 'nodes' and 'region'");
    part = read_group(fields, body);
  } else {
    part.nodes = all_nodes(num_nodes(body));
  }
  where.nodes = part.nodes;
  const Vector mass = nodal_mass(body);
  where.shares = mass(where.nodes) / mass(where.nodes).sum();
  for (const Triangle& triangle : surface_triangles(body, part)) where.triangles.push_back(triangle);
  try {
    return outside_forces().at(choice.name).make(where, choice.options);
  } catch (const std::invalid_argument& error) {
    fields.fail("force", "is refused: " + std::string(error.what()));
  }
}

}  // namespace supple
