#pragma once
/// \file Least-squares problems A w ≈ b as selectors see them: columns on demand, never all of A.

#include <core/check.hpp>
#include <core/types.hpp>

#include <concepts>
#include <span>
#include <utility>
#include <vector>

namespace supple {

/// Least-squares problem min ‖A w − b‖ with A ∈ ℝ^{rows × cols}.
/// A problem also promises: column(j, out) writes A e_j into out (size rows), always the same numbers for the
/// same j; const calls are safe from several threads.
template <typename P>
concept FittingProblem = requires(const P& p, Index j, VectorOut out) {
  { p.rows() } -> std::convertible_to<Index>;
  { p.cols() } -> std::convertible_to<Index>;
  { p.rhs() } -> std::convertible_to<const Vector&>;  // b
  p.column(j, out);                                   // out = A e_j
};

/// Evaluated columns A_C of a problem, in whatever representation is cheap: all that a selector does with
/// them. A block also promises: results agree with those of the columns themselves to rounding, and do not
/// depend on the number of threads; the columns keep the order in which they were asked for. It may refer to
/// its problem, which must outlive it.
template <typename C>
concept ColumnBlock = std::movable<C> &&
    requires(const C& c, C& grown, VectorIn v, Index k, std::span<const Index> positions) {
  { c.size() } -> std::convertible_to<Index>;               // |C|
  { c.index(k) } -> std::convertible_to<Index>;             // number in A of column k of the block
  { c.times(v) } -> std::convertible_to<Vector>;            // A_C v    (rows)
  { c.transpose_times(v) } -> std::convertible_to<Vector>;  // A_Cᵀ v  (|C|)
  { c.gram(c) } -> std::convertible_to<Matrix>;  // A_Cᵀ A_D for a block D of the same problem; c.gram(c) is symmetric
  { c.squared_norms() } -> std::convertible_to<Vector>;  // ‖A_C e_k‖²  (|C|)
  { c.subset(positions) } -> std::same_as<C>;            // copy of the columns at these places of the block
  grown.append(c);                                       // union of disjoint blocks, c behind
};

/// A problem with a cheap representation of its own of evaluated columns (a force fitting keeps 9 numbers a
/// pose and component instead of d).
template <typename P>
concept BlockFittingProblem = FittingProblem<P> && requires(const P& p, std::span<const Index> js) {
  { p.columns(js) } -> ColumnBlock;
};

/// A problem that can correlate a residual with all its columns without evaluating them into blocks.
template <typename P>
concept FullGradientProblem = FittingProblem<P> && requires(const P& p, VectorIn r) {
  { p.transpose_times(r) } -> std::convertible_to<Vector>;  // Aᵀ r       (cols)
  { p.squared_norms() } -> std::convertible_to<Vector>;     // ‖A e_j‖²   (cols)
};

/// A problem whose rows come in groups (training poses) of which some may stand for all.
template <typename P>
concept GroupedFittingProblem = FittingProblem<P> && requires(const P& p, std::span<const Index> groups) {
  { p.num_groups() } -> std::convertible_to<Index>;
  { p.restricted_to(groups) } -> FittingProblem;  // the rows of these groups; may refer to p
};

/// Evaluated columns stored as they are: the block of every problem that has none of its own.
class DenseColumns {
 public:
  DenseColumns() = default;
  /// \param indices  numbers of the columns in A; as many as `columns` has columns.
  DenseColumns(std::vector<Index> indices, Matrix columns);

  Index size() const { return static_cast<Index>(indices_.size()); }
  Index index(Index k) const { return indices_[k]; }
  Vector times(VectorIn w) const;
  Vector transpose_times(VectorIn r) const;
  Matrix gram(const DenseColumns& other) const;
  Vector squared_norms() const;
  DenseColumns subset(std::span<const Index> positions) const;
  void append(const DenseColumns& other);

  auto values() const { return storage_.leftCols(size()); }  ///< rows × |C|

 private:
  std::vector<Index> indices_;
  Matrix storage_;  // rows × capacity, the first |C| columns in use
};
static_assert(ColumnBlock<DenseColumns>);

/// Columns of a matrix that is in memory anyway: their numbers and a reference to it. Products gather them.
class GatheredColumns {
 public:
  GatheredColumns(std::vector<Index> indices, const Matrix& A) : indices_(std::move(indices)), A_(&A) {}

  Index size() const { return static_cast<Index>(indices_.size()); }
  Index index(Index k) const { return indices_[k]; }
  Vector times(VectorIn w) const;
  Vector transpose_times(VectorIn r) const;
  Matrix gram(const GatheredColumns& other) const;
  Vector squared_norms() const;
  GatheredColumns subset(std::span<const Index> positions) const;
  void append(const GatheredColumns& other);

 private:
  Matrix gathered(Index begin, Index end) const;

  std::vector<Index> indices_;
  const Matrix* A_;
};
static_assert(ColumnBlock<GatheredColumns>);

/// Some groups of the rows of a matrix in memory, gathered when columns are asked for.
class DenseRows {
 public:
  /// A must outlive it.
  /// \param groups  of group_size consecutive rows each, in this order.
  DenseRows(const Matrix& A, VectorIn b, std::span<const Index> groups, Index group_size);

  Index rows() const { return b_.size(); }
  Index cols() const { return A_->cols(); }
  const Vector& rhs() const { return b_; }
  void column(Index j, VectorOut out) const { out = A_->col(j)(rows_); }
  Vector transpose_times(VectorIn r) const;
  Vector squared_norms() const;
  Index num_groups() const { return rows() / group_size_; }
  DenseRows restricted_to(std::span<const Index> groups) const;

 private:
  const Matrix* A_;
  std::vector<Index> rows_;
  Vector b_;
  Index group_size_;
};
static_assert(FullGradientProblem<DenseRows> && GroupedFittingProblem<DenseRows>);

/// A and b in memory. Rows may be grouped: group_size consecutive rows stand or fall together.
class DenseProblem {
 public:
  /// \throws std::invalid_argument if b does not fit A, or A's rows do not come in groups of group_size.
  DenseProblem(Matrix A, Vector b, Index group_size = 1);

  Index rows() const { return A_.rows(); }
  Index cols() const { return A_.cols(); }
  const Matrix& matrix() const { return A_; }
  const Vector& rhs() const { return b_; }
  void column(Index j, VectorOut out) const { out = A_.col(j); }
  Index numbers_per_column() const { return 0; }  ///< none beside A
  GatheredColumns columns(std::span<const Index> js) const { return {{js.begin(), js.end()}, A_}; }
  Vector transpose_times(VectorIn r) const;
  Vector squared_norms() const;
  Index num_groups() const { return rows() / group_size_; }
  DenseRows restricted_to(std::span<const Index> groups) const;

 private:
  Matrix A_;
  Vector b_;
  Index group_size_;
};
static_assert(BlockFittingProblem<DenseProblem> && FullGradientProblem<DenseProblem> &&
              GroupedFittingProblem<DenseProblem>);

/// Columns js of A, in the problem's own representation if it has one.
template <FittingProblem P>
auto columns_of(const P& problem, std::span<const Index> js) {
  if constexpr (BlockFittingProblem<P>) {
    return problem.columns(js);
  } else {
    Matrix columns(problem.rows(), static_cast<Index>(js.size()));
    for (Index k = 0; k < columns.cols(); ++k) problem.column(js[k], columns.col(k));
    return DenseColumns({js.begin(), js.end()}, std::move(columns));
  }
}

/// How many numbers an evaluated column keeps: as many as the problem has rows, if it does not say so itself.
template <FittingProblem P>
Index numbers_per_column(const P& problem) {
  if constexpr (requires {
                  { problem.numbers_per_column() } -> std::convertible_to<Index>;
                })
    return problem.numbers_per_column();
  else
    return problem.rows();
}

/// The block that columns_of(problem, …) returns.
template <FittingProblem P>
using ColumnsOf = decltype(columns_of(std::declval<const P&>(), std::span<const Index>()));

}  // namespace supple
