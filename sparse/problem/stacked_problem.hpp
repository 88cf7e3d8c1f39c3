#pragma once
/// \file Two fitting problems for the same weights, one's rows above the other's.

#include <sparse/problem/fitting_problem.hpp>

#include <memory>

namespace supple {

/// min ‖A w − b‖² + ‖A' w − b'‖² of problems with the same columns. Every operation is that of both parts, so each keeps
/// its own representation of columns; groups of rows are those of the first, then those of the second.
template <typename P, typename Q>
class StackedProblem {
  using AboveColumns = ColumnsOf<P>;
  using BelowColumns = ColumnsOf<Q>;

 public:
  class Columns;

  /// Refers to the problems, which must outlive it. \throws std::invalid_argument if they have other columns.
  StackedProblem(const P& above, const Q& below)
      : StackedProblem(std::shared_ptr<const P>(std::shared_ptr<void>(), &above),
                       std::shared_ptr<const Q>(std::shared_ptr<void>(), &below)) {}
  StackedProblem(std::shared_ptr<const P> above, std::shared_ptr<const Q> below)
      : above_(std::move(above)), below_(std::move(below)), b_(above_->rows() + below_->rows()) {
    require_size("below.cols()", below_->cols(), above_->cols());
    b_ << above_->rhs(), below_->rhs();
  }

  Index rows() const { return b_.size(); }
  Index cols() const { return above_->cols(); }
  const Vector& rhs() const { return b_; }
  void column(Index j, VectorOut out) const {
    require_size("out", out.size(), rows());
    above_->column(j, out.head(above_->rows()));
    below_->column(j, out.tail(below_->rows()));
  }
  Columns columns(std::span<const Index> js) const {
    return {columns_of(*above_, js), columns_of(*below_, js), above_->rows()};
  }
  Index numbers_per_column() const { return supple::numbers_per_column(*above_) + supple::numbers_per_column(*below_); }

  Vector transpose_times(VectorIn r) const requires FullGradientProblem<P> && FullGradientProblem<Q> {
    require_size("r", r.size(), rows());
    return above_->transpose_times(r.head(above_->rows())) + below_->transpose_times(r.tail(below_->rows()));
  }
  Vector squared_norms() const requires FullGradientProblem<P> && FullGradientProblem<Q> {
    return above_->squared_norms() + below_->squared_norms();
  }

  Index num_groups() const requires GroupedFittingProblem<P> && GroupedFittingProblem<Q> {
    return above_->num_groups() + below_->num_groups();
  }
  /// The rows of these groups; where one problem would have none, its first group.
  auto restricted_to(std::span<const Index> groups) const requires GroupedFittingProblem<P> &&
      GroupedFittingProblem<Q> {
    std::vector<Index> from_above, from_below;
    for (const Index g : groups) {
      const Index below = g - above_->num_groups();
      below < 0 ? from_above.push_back(g) : from_below.push_back(below);
    }
    if (from_above.empty() && above_->num_groups() > 0) from_above.push_back(0);
    if (from_below.empty() && below_->num_groups() > 0) from_below.push_back(0);
    using Above = decltype(above_->restricted_to(from_above));
    using Below = decltype(below_->restricted_to(from_below));
    return StackedProblem<Above, Below>(std::make_shared<const Above>(above_->restricted_to(from_above)),
                                        std::make_shared<const Below>(below_->restricted_to(from_below)));
  }

  /// Evaluated columns of both; a ColumnBlock.
  class Columns {
   public:
    Columns(AboveColumns above, BelowColumns below, Index rows_above)
        : above_(std::move(above)), below_(std::move(below)), rows_above_(rows_above) {}

    Index size() const { return above_.size(); }
    Index index(Index k) const { return above_.index(k); }
    Vector times(VectorIn w) const {
      const Vector above = above_.times(w), below = below_.times(w);
      Vector result(above.size() + below.size());
      result << above, below;
      return result;
    }
    Vector transpose_times(VectorIn r) const {
      return above_.transpose_times(r.head(rows_above_)) + below_.transpose_times(r.tail(r.size() - rows_above_));
    }
    Matrix gram(const Columns& other) const { return above_.gram(other.above_) + below_.gram(other.below_); }
    Vector squared_norms() const { return above_.squared_norms() + below_.squared_norms(); }
    Columns subset(std::span<const Index> positions) const {
      return {above_.subset(positions), below_.subset(positions), rows_above_};
    }
    void append(const Columns& other) {
      above_.append(other.above_);
      below_.append(other.below_);
    }

   private:
    AboveColumns above_;
    BelowColumns below_;
    Index rows_above_;
  };

 private:
  std::shared_ptr<const P> above_;
  std::shared_ptr<const Q> below_;
  Vector b_;
};

static_assert(BlockFittingProblem<StackedProblem<DenseProblem, DenseProblem>> &&
              FullGradientProblem<StackedProblem<DenseRows, DenseRows>> &&
              GroupedFittingProblem<StackedProblem<DenseRows, DenseRows>>);

}  // namespace supple
