#pragma once
/// \file Deformable object of any kind as plain data: a solid or a shell.

#include <core/check.hpp>
#include <physics/body/shell.hpp>
#include <physics/body/solid.hpp>

#include <string_view>
#include <variant>

namespace supple {

using Body = std::variant<Solid, HexSolid, QuadraticTetSolid, Shell>;

/// Calls visit(solid) of a body that is no shell. \throws std::invalid_argument for a shell.
template <typename Visitor>
auto visit_solid(const Body& body, const Visitor& visit) {
  if (const auto* tets = std::get_if<Solid>(&body)) return visit(*tets);
  if (const auto* hexahedra = std::get_if<HexSolid>(&body)) return visit(*hexahedra);
  const auto* quadratic = std::get_if<QuadraticTetSolid>(&body);
  require(quadratic, "the object is a shell, expected a solid");
  return visit(*quadratic);
}

inline const Points& node_positions(const Body& body) {  ///< at rest, n × 3 [m]
  return std::visit([](const auto& b) -> const Points& { return b.mesh.nodes; }, body);
}
inline Index num_nodes(const Body& body) {
  return node_positions(body).rows();
}
/// Where they stand in the user's file.
inline const NodePlaces& node_places(const Body& body) {
  return std::visit([](const auto& b) -> const NodePlaces& { return b.mesh.places; }, body);
}
/// Groups of faces, edges and nodes that the user's file names; none of a shell.
inline const NodeGroups& node_groups(const Body& body) {
  static const NodeGroups none;
  if (std::holds_alternative<Shell>(body)) return none;
  return *visit_solid(body, [](const auto& solid) { return &solid.mesh.node_groups; });
}
inline const std::vector<Index>& fixed_nodes(const Body& body) {
  return std::visit([](const auto& b) -> const std::vector<Index>& { return b.fixed_nodes; }, body);
}
/// How nodes are held that slide.
inline const std::vector<HeldAxes>& held_axes(const Body& body) {
  return std::visit([](const auto& b) -> const std::vector<HeldAxes>& { return b.held_axes; }, body);
}
/// Whether no support holds it anywhere.
inline bool is_free(const Body& body) {
  return fixed_nodes(body).empty() && held_axes(body).empty();
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

/// What its cells are called: "tets", "hexahedra", "quadratic tets" or "triangles".
inline std::string_view cell_name(const Body& body) {
  constexpr std::string_view names[]{"tets", "hexahedra", "quadratic tets", "triangles"};
  return names[body.index()];
}
inline Index num_cells(const Body& body) {
  if (const Shell* shell = std::get_if<Shell>(&body)) return shell->mesh.num_triangles();
  return visit_solid(body, [](const auto& solid) { return solid.mesh.num_cells(); });
}

/// What the terms of its force model are called: as its cells, or "Gauss points", or "flaps".
inline std::string_view component_name(const Body& body) {
  if (std::holds_alternative<Shell>(body)) return "flaps";
  const bool points =
      visit_solid(body, [](const auto& solid) { return solid.component == SolidComponent::GaussPoint; });
  return points && !std::holds_alternative<Solid>(body) ? "Gauss points" : cell_name(body);
}

inline constexpr std::string_view shell_law = "discrete-shell";
/// The law of its material: one of material_laws(), or shell_law.
inline std::string_view law(const Body& body) {
  if (std::holds_alternative<Shell>(body)) return shell_law;
  return visit_solid(body, [](const auto& solid) { return std::string_view(solid.law); });
}

}  // namespace supple
