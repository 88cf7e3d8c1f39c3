#include <core/parallel.hpp>
#include <sparse/fitting_problem.hpp>

#include <algorithm>

namespace supple {

namespace {

constexpr Index tile = 128;  // columns of a piece of work; fixed, so that sums do not depend on the threads

Vector transpose_times(const Eigen::Ref<const Matrix>& A, VectorIn r) {
  Vector result(A.cols());
  parallel_ranges(A.cols(), tile, [&](Index begin, Index end) {
    result.segment(begin, end - begin).noalias() = A.middleCols(begin, end - begin).transpose() * r;
  });
  return result;
}

Vector squared_norms(const Eigen::Ref<const Matrix>& A) {
  Vector result(A.cols());
  parallel_ranges(A.cols(), tile, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) result[j] = A.col(j).squaredNorm();
  });
  return result;
}

// Both triangles from one: tile pairs on and above the diagonal.
Matrix symmetric_gram(const Eigen::Ref<const Matrix>& A) {
  const Index n = A.cols(), tiles = (n + tile - 1) / tile;
  std::vector<std::pair<Index, Index>> pairs;
  for (Index q = 0; q < tiles; ++q)
    for (Index p = 0; p <= q; ++p) pairs.emplace_back(p * tile, q * tile);
  Matrix G(n, n);
  parallel_for(static_cast<Index>(pairs.size()), [&](Index k) {
    const auto [i, j] = pairs[k];
    const Index height = std::min(tile, n - i), width = std::min(tile, n - j);
    G.block(i, j, height, width).noalias() = A.middleCols(i, height).transpose() * A.middleCols(j, width);
  });
  G.triangularView<Eigen::StrictlyLower>() = G.transpose();
  return G;
}

Matrix gram(const Eigen::Ref<const Matrix>& A, const Eigen::Ref<const Matrix>& B) {
  Matrix G(A.cols(), B.cols());
  parallel_ranges(A.cols(), tile, [&](Index begin, Index end) {
    G.middleRows(begin, end - begin).noalias() = A.middleCols(begin, end - begin).transpose() * B;
  });
  return G;
}

}  // namespace

DenseColumns::DenseColumns(std::vector<Index> indices, Matrix columns)
    : indices_(std::move(indices)), storage_(std::move(columns)) {
  require_size("indices", static_cast<Index>(indices_.size()), storage_.cols());
}

Vector DenseColumns::times(VectorIn w) const {
  return values() * w;
}

Vector DenseColumns::transpose_times(VectorIn r) const {
  return supple::transpose_times(values(), r);
}

Matrix DenseColumns::gram(const DenseColumns& other) const {
  return this == &other ? symmetric_gram(values()) : supple::gram(values(), other.values());
}

Vector DenseColumns::squared_norms() const {
  return supple::squared_norms(values());
}

DenseColumns DenseColumns::subset(std::span<const Index> positions) const {
  std::vector<Index> indices;
  for (Index k : positions) indices.push_back(indices_[k]);
  Matrix columns(storage_.rows(), static_cast<Index>(positions.size()));
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) = storage_.col(positions[k]);
  return {std::move(indices), std::move(columns)};
}

void DenseColumns::append(const DenseColumns& other) {
  const Index old_size = size(), new_size = old_size + other.size();
  if (new_size > storage_.cols())
    storage_.conservativeResize(other.storage_.rows(), std::max(new_size, 2 * storage_.cols()));
  storage_.middleCols(old_size, other.size()) = other.values();
  indices_.insert(indices_.end(), other.indices_.begin(), other.indices_.end());
}

DenseProblem::DenseProblem(Matrix A, Vector b, Index group_size)
    : A_(std::move(A)), b_(std::move(b)), group_size_(group_size) {
  require_size("b", b_.size(), A_.rows());
  require(group_size_ >= 1 && A_.rows() % group_size_ == 0,
          "A has " + std::to_string(A_.rows()) +
              " rows, expected a multiple of group_size = " + std::to_string(group_size_));
}

DenseColumns DenseProblem::columns(std::span<const Index> js) const {
  Matrix columns(rows(), static_cast<Index>(js.size()));
  for (Index k = 0; k < columns.cols(); ++k) columns.col(k) = A_.col(js[k]);
  return {{js.begin(), js.end()}, std::move(columns)};
}

Vector DenseProblem::transpose_times(VectorIn r) const {
  return supple::transpose_times(A_, r);
}

Vector DenseProblem::squared_norms() const {
  return supple::squared_norms(A_);
}

DenseProblem DenseProblem::restricted_to(std::span<const Index> groups) const {
  std::vector<Index> kept;
  for (Index group : groups)
    for (Index i = 0; i < group_size_; ++i) kept.push_back(group * group_size_ + i);
  return {A_(kept, Eigen::all), b_(kept), group_size_};
}

}  // namespace supple
