#include <core/parallel.hpp>
#include <sparse/problem/fitting_problem.hpp>

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

// Aᵀ A of columns that piece(begin, end) gives, both triangles from one: tile pairs on and above the
// diagonal.
template <typename Piece>
Matrix symmetric_gram(Index n, const Piece& piece) {
  Matrix G(n, n);
  parallel_for((n + tile - 1) / tile, [&](Index q) {
    const Index j = q * tile, width = std::min(tile, n - j);
    const auto right = piece(j, j + width);
    for (Index i = 0; i < j; i += tile) G.block(i, j, tile, width).noalias() = piece(i, i + tile).transpose() * right;
    G.block(j, j, width, width).noalias() = right.transpose() * right;
  });
  G.triangularView<Eigen::StrictlyLower>() = G.transpose();
  return G;
}

// Aᵀ B, the wider of the two in tiles.
template <typename PieceOfA, typename PieceOfB>
Matrix gram(Index m, const PieceOfA& a, Index n, const PieceOfB& b) {
  Matrix G(m, n);
  const Index tiles_a = (m + tile - 1) / tile, tiles_b = (n + tile - 1) / tile;
  parallel_for(tiles_a * tiles_b, [&](Index k) {
    const Index i = k % tiles_a * tile, j = k / tiles_a * tile;
    const Index height = std::min(tile, m - i), width = std::min(tile, n - j);
    G.block(i, j, height, width).noalias() = a(i, i + height).transpose() * b(j, j + width);
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
  const auto piece = [this](Index begin, Index end) { return storage_.middleCols(begin, end - begin); };
  if (this == &other) return symmetric_gram(size(), piece);
  return supple::gram(size(), piece, other.size(),
                      [&](Index begin, Index end) { return other.storage_.middleCols(begin, end - begin); });
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

Vector GatheredColumns::times(VectorIn w) const {
  require_size("w", w.size(), size());
  Vector sum = Vector::Zero(A_->rows());
  for (Index k = 0; k < size(); ++k) sum += w[k] * A_->col(indices_[k]);
  return sum;
}

Vector GatheredColumns::transpose_times(VectorIn r) const {
  Vector result(size());
  parallel_ranges(size(), tile, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) result[k] = A_->col(indices_[k]).dot(r);
  });
  return result;
}

Matrix GatheredColumns::gathered(Index begin, Index end) const {
  Matrix columns(A_->rows(), end - begin);
  for (Index k = begin; k < end; ++k) columns.col(k - begin) = A_->col(indices_[k]);
  return columns;
}

Matrix GatheredColumns::gram(const GatheredColumns& other) const {
  const auto piece = [this](Index begin, Index end) { return gathered(begin, end); };
  if (this == &other) return symmetric_gram(size(), piece);
  return supple::gram(size(), piece, other.size(), [&](Index begin, Index end) { return other.gathered(begin, end); });
}

Vector GatheredColumns::squared_norms() const {
  Vector result(size());
  parallel_ranges(size(), tile, [&](Index begin, Index end) {
    for (Index k = begin; k < end; ++k) result[k] = A_->col(indices_[k]).squaredNorm();
  });
  return result;
}

GatheredColumns GatheredColumns::subset(std::span<const Index> positions) const {
  std::vector<Index> indices;
  for (Index k : positions) indices.push_back(indices_[k]);
  return {std::move(indices), *A_};
}

void GatheredColumns::append(const GatheredColumns& other) {
  indices_.insert(indices_.end(), other.indices_.begin(), other.indices_.end());
}

DenseProblem::DenseProblem(Matrix A, Vector b, Index group_size)
    : A_(std::move(A)), b_(std::move(b)), group_size_(group_size) {
  require_size("b", b_.size(), A_.rows());
  require(group_size_ >= 1 && A_.rows() % group_size_ == 0,
          "A has " + std::to_string(A_.rows()) +
              " rows, expected a multiple of group_size = " + std::to_string(group_size_));
}

Vector DenseProblem::transpose_times(VectorIn r) const {
  return supple::transpose_times(A_, r);
}

Vector DenseProblem::squared_norms() const {
  return supple::squared_norms(A_);
}

DenseRows DenseProblem::restricted_to(std::span<const Index> groups) const {
  return {A_, b_, groups, group_size_};
}

DenseRows::DenseRows(const Matrix& A, VectorIn b, std::span<const Index> groups, Index group_size)
    : A_(&A), group_size_(group_size) {
  for (Index group : groups)
    for (Index i = 0; i < group_size_; ++i) rows_.push_back(group * group_size_ + i);
  b_ = b(rows_);
}

Vector DenseRows::transpose_times(VectorIn r) const {
  Vector result(cols());
  parallel_ranges(cols(), tile, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) result[j] = A_->col(j)(rows_).dot(r);
  });
  return result;
}

Vector DenseRows::squared_norms() const {
  Vector result(cols());
  parallel_ranges(cols(), tile, [&](Index begin, Index end) {
    for (Index j = begin; j < end; ++j) result[j] = A_->col(j)(rows_).squaredNorm();
  });
  return result;
}

DenseRows DenseRows::restricted_to(std::span<const Index> groups) const {
  DenseRows part = *this;
  part.rows_.clear();
  part.b_.resize(static_cast<Index>(groups.size()) * group_size_);
  for (Index group : groups)
    for (Index i = group * group_size_; i < (group + 1) * group_size_; ++i) {
      part.b_[static_cast<Index>(part.rows_.size())] = b_[i];
      part.rows_.push_back(rows_[i]);
    }
  return part;
}

}  // namespace supple
