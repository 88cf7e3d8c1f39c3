#include <core/pack.hpp>
#include <core/parallel.hpp>
#include <physics/material/rotation.hpp>
#include <physics/system/nodal_frames.hpp>

#include <algorithm>

namespace supple {

namespace {

/// Of the edges at a node, in eight states.
Matrix3<Pack> map_of_edges(const Points& X, const RowMatrix& U, Index node, std::span<const Index> stencils,
                           Index stencil_size, const NodeIncidence& incidence) {
  const auto at = [&](Index v, int c) { return Pack::load_unaligned(U.row(3 * v + c).data()); };
  Matrix3<Pack> F;
  F.setConstant(Pack(0.0));
  for (const Index slot : incidence.of(node)) {
    for (const Index other : stencils.subspan(slot / stencil_size * stencil_size, stencil_size)) {
      if (other == node) continue;
      const Point edge = (X.row(other) - X.row(node)).transpose();
      const double length2 = edge.squaredNorm();
      if (length2 == 0) continue;
      for (int r = 0; r < 3; ++r) {
        const Pack moved = Pack(edge[r]) + (at(other, r) - at(node, r));
        for (int c = 0; c < 3; ++c) F(r, c) += moved * Pack(edge[c] / length2);
      }
    }
  }
  return F;
}

}  // namespace

std::vector<BlockRotations> nodal_frames(const Points& X, const RowMatrix& U, std::span<const Index> stencils,
                                         Index stencil_size, const NodeIncidence& incidence,
                                         const NodeNumbering& numbering) {
  std::vector<BlockRotations> frames;
  for (Index first = 0; first < U.cols(); first += Pack::size) {
    const Index count = std::min<Index>(Pack::size, U.cols() - first);
    RowMatrix eight = RowMatrix::Zero(U.rows(), Pack::size);
    eight.leftCols(count) = U.middleCols(first, count);
    std::vector<std::vector<Matrix3<double>>> R(count, std::vector<Matrix3<double>>(numbering.num_free()));
    parallel_ranges(numbering.num_free(), 512, [&](Index begin, Index end) {
      for (Index v = begin; v < end; ++v) {
        const Matrix3<Pack> rotation =
            polar(map_of_edges(X, eight, numbering.free_nodes()[v], stencils, stencil_size, incidence)).R;
        for (Index k = 0; k < count; ++k)
          for (int c = 0; c < 9; ++c) R[k][v](c) = rotation(c)[static_cast<int>(k)];
      }
    });
    for (const Index i : numbering.held_unknowns())
      for (std::vector<Matrix3<double>>& of_state : R) of_state[i / 3].setIdentity();
    for (std::vector<Matrix3<double>>& of_state : R) frames.emplace_back(std::move(of_state));
  }
  return frames;
}

}  // namespace supple
