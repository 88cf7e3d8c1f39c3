#include <app/report/exit_guard.hpp>
#include <app/scene/result_fields.hpp>

#include <numeric>

namespace supple {

void add_places(VtuFields& fields, const NodePlaces& places, const std::vector<Index>& nodes) {
  if (places.of_node.empty()) return;
  RowMatrix place(static_cast<Index>(nodes.size()), 1);
  for (Index k = 0; k < place.rows(); ++k)
    place(k, 0) = static_cast<double>(places.place(nodes[static_cast<std::size_t>(k)]));
  fields.point_data.push_back({"node", std::move(place)});
}

std::vector<Index> all_nodes(Index count) {
  std::vector<Index> nodes(static_cast<std::size_t>(count));
  std::iota(nodes.begin(), nodes.end(), Index{0});
  return nodes;
}

void write_body(const std::filesystem::path& path, const Body& body, const Points& positions, VtuFields fields) {
  add_places(fields, node_places(body), all_nodes(num_nodes(body)));
  const ExitGuard guard(path);
  if (const Shell* shell = std::get_if<Shell>(&body))
    write_vtu(path, positions, shell->mesh.triangles, fields);
  else
    visit_solid(body, [&](const auto& solid) { write_vtu(path, positions, solid.mesh.cells, fields); });
}

void add_stress(VtuFields& fields, const CellStress& stress) {
  fields.cell_data.push_back({"von Mises stress [Pa]", stress.von_mises});
  fields.cell_data.push_back({"Cauchy stress [Pa]", stress.cauchy});
  fields.cell_data.push_back({"Green strain", stress.strain});
  fields.cell_data.push_back({"energy density [J/m^3]", stress.energy});
}

}  // namespace supple
