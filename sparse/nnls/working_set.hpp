#pragma once
/// \file Columns that a selector currently works with, and what their least-squares fit needs.

#include <core/stable_norm.hpp>
#include <sparse/nnls/nnls.hpp>
#include <sparse/nnls/signs.hpp>
#include <sparse/problem/fitting_problem.hpp>

#include <algorithm>
#include <numeric>
#include <vector>

namespace supple {

inline std::vector<Index> all_positions(Index count) {
  std::vector<Index> positions(count);
  std::iota(positions.begin(), positions.end(), Index{0});
  return positions;
}

/// Numbers in A of the columns at these positions of a block.
template <ColumnBlock C>
std::vector<Index> indices_at(const C& block, const std::vector<Index>& positions) {
  std::vector<Index> indices;
  for (Index k : positions) indices.push_back(block.index(k));
  return indices;
}

/// Evaluated columns A_S with their Gram matrix and A_Sᵀb; only columns that come in cost anything.
template <FittingProblem P>
class WorkingSet {
 public:
  using Block = ColumnsOf<P>;

  explicit WorkingSet(const P& problem) : problem_(&problem), block_(columns_of(problem, std::span<const Index>())) {}

  Index size() const { return block_.size(); }
  const Block& block() const { return block_; }
  const Matrix& gram() const { return gram_; }
  const Vector& atb() const { return atb_; }
  std::vector<Index> indices() const { return indices_at(block_, all_positions(size())); }

  /// Adds columns that are not yet present.
  /// \note O(rows · |more| · size).
  void append(const Block& more) {
    const Index old_size = size(), added = more.size();
    if (added == 0) return;
    const Matrix cross = block_.gram(more), corner = more.gram(more);
    gram_.conservativeResize(old_size + added, old_size + added);
    gram_.topRightCorner(old_size, added) = cross;
    gram_.bottomLeftCorner(added, old_size) = cross.transpose();
    gram_.bottomRightCorner(added, added) = corner;
    atb_.conservativeResize(old_size + added);
    atb_.tail(added) = more.transpose_times(problem_->rhs());
    block_.append(more);
  }

  /// Keeps only the columns at these positions, in this order.
  void keep(std::span<const Index> positions) {
    const std::vector<Index> kept(positions.begin(), positions.end());
    block_ = block_.subset(kept);
    gram_ = Matrix(gram_(kept, kept));
    atb_ = Vector(atb_(kept));
  }

  Vector residual(VectorIn w) const { return problem_->rhs() - block_.times(w); }  ///< b − A_S w

  /// Weights of the least-squares fit, with or without a sign; if with, started from the positions `passive`.
  NnlsSolution fit(Signs signs, std::span<const Index> passive) const {
    return signs == Signs::NonNegative ? Fnnls{}(gram_, atb_, passive) : least_squares(gram_, atb_);
  }
  /// Non-negative weights, started from all columns.
  Vector fit() const { return fit(Signs::NonNegative, all_positions(size())).w; }
  /// The same with only the columns at these positions, started from all of them; 0 elsewhere.
  Vector fit_on(const std::vector<Index>& positions) const {
    Vector w = Vector::Zero(size());
    w(positions) =
        Fnnls{}(gram_(positions, positions), atb_(positions), all_positions(static_cast<Index>(positions.size()))).w;
    return w;
  }

  /// Wins back digits that the normal equations have lost, by refinement with the residual of A itself
  /// (Björck 1987).
  void polish(NnlsSolution& solution, Signs signs) const {
    for (int step = 0; step < 3; ++step) {
      const Vector correction = solution.passive.solve(block_.transpose_times(residual(solution.w)));
      if (stable_norm(correction) <= 1e-14 * stable_norm(solution.w)) return;
      const Vector w = solution.w + correction;
      if ((signs == Signs::NonNegative && !(w.minCoeff() >= 0)) || residual(w).norm() >= residual(solution.w).norm())
        return;
      solution.w = w;
    }
  }

 private:
  const P* problem_;
  Block block_;
  Matrix gram_;
  Vector atb_;
};

}  // namespace supple
