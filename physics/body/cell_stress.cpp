#include <core/parallel.hpp>
#include <physics/body/cell_stress.hpp>
#include <physics/body/material_law.hpp>

#include <array>
#include <cmath>
#include <utility>

namespace supple {

namespace {

/// row += share · (xx, yy, zz, xy, yz, xz) of a symmetric A.
void add_six(double share, const Matrix3<double>& A, RowMatrix::RowXpr row) {
  constexpr std::array<std::pair<int, int>, 6> entries{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}}};
  for (int k = 0; k < 6; ++k) row[k] += share * A(entries[k].first, entries[k].second);
}

double von_mises_of(const RowMatrix::ConstRowXpr& s) {
  const double x = s[0] - s[1], y = s[1] - s[2], z = s[2] - s[0];
  return std::sqrt(0.5 * (x * x + y * y + z * z) + 3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

template <typename Mesh>
CellStress stress_of(const SolidOf<Mesh>& solid, VectorIn u) {
  using Element = ElementOf<Mesh>;
  constexpr int n = Element::num_nodes;
  const Index count = solid.mesh.num_cells();
  const MaterialLaw& law = material_law(solid.law);
  std::vector<std::vector<double>> materials;
  for (Index k = 0; k < solid.parameters.rows(); ++k)
    materials.emplace_back(solid.parameters.row(k).begin(), solid.parameters.row(k).end());
  CellStress result{RowMatrix::Zero(count, 6), Vector(count), RowMatrix::Zero(count, 6), Vector::Zero(count),
                    Vector::Zero(count)};
  parallel_ranges(count, 512, [&](Index begin, Index end) {
    for (Index e = begin; e < end; ++e) {
      const auto& material =
          materials[solid.material_of_cell.empty()
                        ? 0
                        : static_cast<std::size_t>(solid.material_of_cell[static_cast<std::size_t>(e)])];
      Eigen::Matrix<double, 3, n> d;
      for (int a = 0; a < n; ++a) d.col(a) = u.segment<3>(3 * solid.mesh.cells[static_cast<std::size_t>(e)][a]);
      const auto points = cell_points<Element>(cell_positions<Element>(solid.mesh.nodes, solid.mesh.cells, e), e,
                                               Element::gauss_points);
      for (std::size_t g = 0; g < points.size(); ++g) {
        const double volume = Element::gauss_points[g].weight * points[g].det_J;
        const Matrix3<double> F = Matrix3<double>::Identity() + d * points[g].gradients;
        Matrix3<double> P;
        result.energy[e] += volume * law.response(material, F, P);
        add_six(volume, P * F.transpose() / F.determinant(), result.cauchy.row(e));
        add_six(volume, 0.5 * (F.transpose() * F - Matrix3<double>::Identity()), result.strain.row(e));
        result.rest_volume[e] += volume;
      }
      result.cauchy.row(e) /= result.rest_volume[e];
      result.strain.row(e) /= result.rest_volume[e];
      result.energy[e] /= result.rest_volume[e];
      result.von_mises[e] = von_mises_of(std::as_const(result.cauchy).row(e));
      if (!std::isfinite(result.energy[e])) {
        result.cauchy.row(e).setConstant(std::nan(""));
        result.von_mises[e] = std::nan("");
      }
    }
  });
  return result;
}

}  // namespace

bool has_cell_stress(const Body& body) {
  return !std::holds_alternative<Shell>(body) && material_law(law(body)).response;
}

CellStress cell_stress(const Body& body, VectorIn u) {
  require_size("u", u.size(), 3 * num_nodes(body));
  return visit_solid(body, [&](const auto& solid) {
    require(static_cast<bool>(material_law(solid.law).response), "the law " + solid.law + " tells no stress");
    return stress_of(solid, u);
  });
}

Vector at_nodes(const Body& body, VectorIn of_cells, VectorIn rest_volume) {
  return visit_solid(body, [&](const auto& solid) {
    require_size("of_cells", of_cells.size(), solid.mesh.num_cells());
    Vector sum = Vector::Zero(solid.mesh.num_nodes()), weight = sum;
    for (Index e = 0; e < of_cells.size(); ++e)
      for (const Index v : solid.mesh.cells[static_cast<std::size_t>(e)]) {
        sum[v] += rest_volume[e] * of_cells[e];
        weight[v] += rest_volume[e];
      }
    return Vector(sum.cwiseQuotient(weight));
  });
}

}  // namespace supple
