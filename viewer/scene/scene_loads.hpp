#pragma once
/// \file What scenes of all kinds say of loads: where they act, and which they are.

#include <core/registry.hpp>
#include <io/text/json_fields.hpp>
#include <physics/body/body.hpp>
#include <physics/load/loads.hpp>
#include <physics/load/outside_force_library.hpp>

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supple {

/// The node closest to a point.
Index nearest_node(const Points& nodes, const Point& point);

/// Where a user's index of a node may lie.
Interval node_range(const Body& body);

/// Nodes with their shares of a whole.
using NodeShares = std::vector<std::pair<Index, double>>;
/// The nodes that "node", "at", "nodes" or "region" names, exactly one of them, with their shares of the whole: by
/// mass, so that a finer mesh is not pulled harder.
NodeShares read_nodes(const JsonFields& fields, const Body& body);

/// The forces on nodes of a "traction" [Pa] of fixed direction, or of a "pressure" [Pa] that pushes inward on the surface at
/// rest: on all faces whose nodes are among those that "nodes" or "region" selects.
/// \throws InputError if there are none, or not exactly one of the two.
std::vector<NodalForce> read_surface_load(const JsonFields& fields, const Body& body);

/// Says what share of a load acts on nodes that the model holds, where it moves nothing; nothing if none to speak of.
std::optional<std::string> held_nodes_note(const JsonFields& fields, const std::vector<NodalForce>& forces,
                                           const Body& body, const std::string& what);

/// An option of a registry's entry, as text.
std::string read_option(const JsonFields& fields, const OptionInfo& option);

/// An entry of a registry and its options, from an object that names it by `key`.
template <typename Entry>
Choice read_choice(const JsonFields& fields, std::string_view key, const Registry<Entry>& registry) {
  Choice choice{fields.text(key)};
  if (!registry.contains(choice.name))
    fields.fail(key, "is '" + choice.name + "', expected one of " + listed(registry.names()));
  for (const OptionInfo& option : registry.at(choice.name).options)
    if (fields.contains(option.name)) choice.options.emplace_back(option.name, read_option(fields, option));
  return choice;
}

/// The nodes that a force from outside may touch: all, or those of a rule; with the surface between them.
AnyOutsideForce read_outside_force(const JsonFields& fields, const Body& body);

}  // namespace supple
