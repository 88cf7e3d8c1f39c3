#include <reduction/subspace/rigid_modes.hpp>

namespace supple {

FreeComponents find_free_components(std::span<const Index> stencils, Index stencil_size,
                                    const NodeNumbering& numbering) {
  FreeComponents result{connected_components(stencils, stencil_size, numbering.num_nodes()), {}};
  std::vector<bool> held(result.components.count, false);
  for (const Index v : numbering.fixed_nodes()) held[result.components.of_node[v]] = true;
  std::vector<bool> slides(result.components.count, false);
  for (const Index i : numbering.held_unknowns()) {
    const Index c = result.components.of_node[numbering.free_nodes()[i / 3]];
    if (!held[c]) slides[c] = held[c] = true;
  }
  for (Index c = 0; c < result.components.count; ++c) {
    if (!held[c]) result.free.push_back(c);
    if (held[c] && slides[c]) result.sliding.push_back(c);
  }
  return result;
}

RowMatrix affine_fields(const Points& rest_positions, const FreeComponents& components) {
  const Index n = rest_positions.rows();
  RowMatrix fields = RowMatrix::Zero(n, 4 * static_cast<Index>(components.free.size()));
  for (std::size_t k = 0; k < components.free.size(); ++k) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    Index count = 0;
    for (Index v = 0; v < n; ++v)
      if (components.components.of_node[v] == components.free[k]) centre += rest_positions.row(v), ++count;
    centre /= static_cast<double>(count);
    double size = 0;
    for (Index v = 0; v < n; ++v)
      if (components.components.of_node[v] == components.free[k])
        size = std::max(size, (rest_positions.row(v) - centre).norm());
    for (Index v = 0; v < n; ++v)
      if (components.components.of_node[v] == components.free[k]) {
        fields(v, 4 * k) = 1;
        fields.row(v).segment<3>(4 * k + 1) = (rest_positions.row(v) - centre) / size;
      }
  }
  return fields;
}

Matrix rigid_modes(const Points& rest_positions, const FreeComponents& components) {
  const RowMatrix affine = affine_fields(rest_positions, components);
  const Index n = rest_positions.rows(), count = affine.cols() / 4;
  Matrix modes = Matrix::Zero(3 * n, 6 * count);
  for (Index k = 0; k < count; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const int y = (axis + 1) % 3, z = (axis + 2) % 3;
      for (Index v = 0; v < n; ++v) {
        modes(3 * v + axis, 6 * k + axis) = affine(v, 4 * k);
        modes(3 * v + y, 6 * k + 3 + axis) = -affine(v, 4 * k + 1 + z);
        modes(3 * v + z, 6 * k + 3 + axis) = affine(v, 4 * k + 1 + y);
      }
    }
  return modes;
}

}  // namespace supple
