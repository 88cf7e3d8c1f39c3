#include <core/check.hpp>
#include <physics/model/discrete_shell.hpp>

#include <string>

namespace supple {

DiscreteShell::DiscreteShell(const TriangleMesh& mesh, const std::vector<ShellMaterial>& materials)
    : rest_positions_(mesh.nodes) {
  check_mesh(mesh);
  require(materials.size() == 1 || static_cast<Index>(materials.size()) == mesh.num_triangles(),
          std::to_string(materials.size()) + " materials for " + std::to_string(mesh.num_triangles()) +
              " triangles, expected one for all or one each");
  for (const ShellMaterial& material : materials) material.check();
  const auto material = [&](Index t) -> const ShellMaterial& { return materials[materials.size() == 1 ? 0 : t]; };

  const std::vector<Flap> flaps = interior_edges(mesh);
  std::vector<int> num_flaps(mesh.triangles.size(), 0);
  for (const Flap& flap : flaps)
    for (const Index t : flap.triangles) ++num_flaps[t];
  for (Index t = 0; t < mesh.num_triangles(); ++t)
    require(num_flaps[t] > 0,
            "triangle " + std::to_string(t) + " shares no edge with another one: a shell cannot bend or stretch there");
  const std::vector<Index> neighbour = neighbour_sides(mesh);
  const auto is_boundary = [&](Index t, Index from) {
    const auto corner = std::find(mesh.triangles[t].begin(), mesh.triangles[t].end(), from);
    return neighbour[3 * t + (corner - mesh.triangles[t].begin())] < 0;
  };

  stencils_.reserve(flaps.size());
  terms_.reserve(flaps.size());
  for (const Flap& flap : flaps) {
    const auto [a, b, c, d] = flap.nodes;
    const auto [abc, bad] = flap.triangles;
    const auto from_to = [&](Index from, Index to) -> Point {
      return (mesh.nodes.row(to) - mesh.nodes.row(from)).transpose();
    };
    const Point e = from_to(a, b), to_c = from_to(a, c), to_d = from_to(a, d);
    const Point n_c = detail::cross(e, to_c), n_d = detail::cross(e, to_d);
    const double area_c = n_c.norm() / 2, area_d = n_d.norm() / 2;

    Term<double> term{};
    for (int i = 0; i < 3; ++i) term.rest[i] = e[i], term.rest[3 + i] = to_c[i], term.rest[6 + i] = to_d[i];
    const double sin = -e.norm() * detail::dot(n_c, to_d), cos = -detail::dot(n_c, n_d);
    term.rest_cos = cos / std::hypot(sin, cos);
    term.rest_sin = sin / std::hypot(sin, cos);

    const double k_c = material(abc).bending, k_d = material(bad).bending;
    const double k_B = k_c > 0 && k_d > 0 ? (area_c + area_d) / (area_c / k_c + area_d / k_d) : 0;
    term.bending = 6 * k_B * e.squaredNorm() / (area_c + area_d);

    term.rest_length = {e.norm(), to_c.norm(), (to_c - e).norm(), to_d.norm(), (to_d - e).norm()};
    const double share_c = 1.0 / num_flaps[abc], share_d = 1.0 / num_flaps[bad];
    const double stretch_c = material(abc).stretch * area_c / 3, stretch_d = material(bad).stretch * area_d / 3;
    // the sides of abc run bc, ca, those of bad ad, db
    const std::array<double, 5> weight{stretch_c + stretch_d,                            //
                                       is_boundary(abc, c) ? share_c * stretch_c : 0.0,  //
                                       is_boundary(abc, b) ? share_c * stretch_c : 0.0,  //
                                       is_boundary(bad, a) ? share_d * stretch_d : 0.0,  //
                                       is_boundary(bad, d) ? share_d * stretch_d : 0.0};
    for (int k = 0; k < 5; ++k) term.spring[k] = weight[k] / (term.rest_length[k] * term.rest_length[k]);
    term.rest_normal = {2 * area_c, 2 * area_d};
    term.area_spring = {material(abc).area * share_c / (4 * area_c), material(bad).area * share_d / (4 * area_d)};

    stencils_.push_back(flap.nodes);
    terms_.push_back(term);
  }
}

}  // namespace supple
