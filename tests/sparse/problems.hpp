#pragma once
/// \file Problems whose answers are known or hard to get right.

#include <core/random.hpp>
#include <sparse/fitting_problem.hpp>

#include <algorithm>
#include <vector>

namespace supple::testing {

inline Matrix gaussian(Index rows, Index cols, std::uint64_t seed) {
  Random random(seed);
  return Matrix::NullaryExpr(rows, cols, [&] { return random.normal(); });
}

inline Matrix uniform(Index rows, Index cols, std::uint64_t seed) {
  Random random(seed);
  return Matrix::NullaryExpr(rows, cols, [&] { return random.uniform(); });
}

/// `count` of 0 … n − 1, ascending.
inline std::vector<Index> random_subset(Index n, Index count, std::uint64_t seed) {
  std::vector<Index> all(n);
  for (Index i = 0; i < n; ++i) all[i] = i;
  all = Random(seed).sample(all, count);
  std::sort(all.begin(), all.end());
  return all;
}

/// w with the given support and weights in [1, 2].
inline Vector planted_weights(Index n, const std::vector<Index>& support, std::uint64_t seed) {
  Random random(seed);
  Vector w = Vector::Zero(n);
  for (Index i : support) w[i] = 1 + random.uniform();
  return w;
}

/// The least that is a FittingProblem, over a matrix.
class ColumnsOnly {
 public:
  ColumnsOnly(Matrix A, Vector b) : A_(std::move(A)), b_(std::move(b)) {}
  Index rows() const { return A_.rows(); }
  Index cols() const { return A_.cols(); }
  const Vector& rhs() const { return b_; }
  void column(Index j, VectorOut out) const { out = A_.col(j); }

 private:
  Matrix A_;
  Vector b_;
};

}  // namespace supple::testing
