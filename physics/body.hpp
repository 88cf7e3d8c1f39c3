#pragma once
/// \file Any deformable object as plain data: a solid or a shell.

#include <physics/shell.hpp>
#include <physics/solid.hpp>

#include <memory>
#include <string_view>
#include <variant>

namespace supple {

using Body = std::variant<Solid, Shell>;

inline const Points& node_positions(const Body& body) {  ///< at rest, n × 3 [m]
  return std::visit([](const auto& b) -> const Points& { return b.mesh.nodes; }, body);
}
inline Index num_nodes(const Body& body) {
  return node_positions(body).rows();
}
inline const std::vector<Index>& fixed_nodes(const Body& body) {
  return std::visit([](const auto& b) -> const std::vector<Index>& { return b.fixed_nodes; }, body);
}
inline const RayleighDamping& damping(const Body& body) {
  return std::visit([](const auto& b) -> const RayleighDamping& { return b.damping; }, body);
}
inline Vector nodal_mass(const Body& body) {  ///< n [kg]
  return std::visit([](const auto& b) { return b.nodal_mass(); }, body);
}

/// Whether an object has exactly these nodes at rest.
inline bool has_nodes(const Body& body, const Points& nodes) {
  const Points& own = node_positions(body);
  return own.rows() == nodes.rows() && own == nodes;
}

/// What the terms of its force model are called: "tets" or "flaps".
inline std::string_view component_name(const Body& body) {
  return std::holds_alternative<Solid>(body) ? "tets" : "flaps";
}

inline constexpr std::string_view shell_law = "discrete-shell";
/// The law of its material: one of material_laws(), or shell_law.
inline std::string_view law(const Body& body) {
  const Solid* solid = std::get_if<Solid>(&body);
  return solid ? std::string_view(solid->law) : shell_law;
}

/// Calls visit(model) with a shared pointer to its force model.
/// \throws std::invalid_argument for data that make no model, such as tets without volume or an unknown law.
template <typename Visitor>
decltype(auto) with_force_model(const Body& body, Visitor&& visit) {
  if (const Shell* shell = std::get_if<Shell>(&body))
    return visit(std::make_shared<const AnyModel<4>>(std::make_shared<const DiscreteShell>(shell->mesh, shell->materials)));
  const Solid& solid = std::get<Solid>(body);
  return visit(material_law(solid.law).tets(solid.mesh, solid.parameters, solid.material_of_tet));
}

}  // namespace supple
