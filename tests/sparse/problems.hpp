#pragma once
/// \file Problems whose answers are known or hard to get right.

#include <core/random.hpp>
#include <sparse/problem/fitting_problem.hpp>
#include <testing/random_problems.hpp>

#include <atomic>
#include <cmath>
#include <numbers>
#include <vector>

namespace supple::test {

/// A force fitting in the small, with d = 3 p reduced unknowns and a column for each of m points of a cube:
/// column i is the reduced force V P(F) gᵀ of a St. Venant–Kirchhoff element at a random point, F = I + Qᵀ g,
/// g the gradients there of p smooth scalar functions; rows come in T groups, one for a random Q, each
/// divided by the norm of the force. b is the sum of all columns.
inline DenseProblem force_fitting_on_a_cube(Index p, Index T, Index m, std::uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3i> waves;  // the smoothest products of cosines, without the constant
  for (int k = 1; static_cast<Index>(waves.size()) < p; ++k)
    for (int x = 0; x <= k; ++x)
      for (int y = 0; x + y <= k; ++y) waves.emplace_back(x, y, k - x - y);
  std::vector<Matrix> poses;
  for (Index t = 0; t < T; ++t)
    poses.push_back(Matrix::NullaryExpr(p, 3, [&](Index k, Index) {
      return 0.3 * random.normal() / (static_cast<double>(p) * waves[k].squaredNorm());
    }));

  Matrix A(3 * p * T, m);
  for (Index i = 0; i < m; ++i) {
    const Point x(random.uniform(), random.uniform(), random.uniform());
    const double volume = (0.5 + random.uniform()) / static_cast<double>(m);
    Matrix g(p, 3);
    for (Index k = 0; k < p; ++k)
      for (int a = 0; a < 3; ++a) {
        double value = 1;
        for (int c = 0; c < 3; ++c) {
          const double phase = std::numbers::pi * waves[k][c];
          value *= c == a ? -phase * std::sin(phase * x[c]) : std::cos(phase * x[c]);
        }
        g(k, a) = value;
      }
    for (Index t = 0; t < T; ++t) {
      const Matrix3<double> F = Matrix3<double>::Identity() + poses[t].transpose() * g;
      const Matrix3<double> E = 0.5 * (F.transpose() * F - Matrix3<double>::Identity());
      const Matrix3<double> P = F * (2 * E + 3 * E.trace() * Matrix3<double>::Identity());
      Eigen::Map<Matrix>(&A(3 * p * t, i), p, 3) = volume * g * P.transpose();
    }
  }
  Vector b = A.rowwise().sum();
  for (Index t = 0; t < T; ++t) {
    const double norm = b.segment(3 * p * t, 3 * p).norm();
    A.middleRows(3 * p * t, 3 * p) /= norm;
    b.segment(3 * p * t, 3 * p) /= norm;
  }
  return {std::move(A), std::move(b), 3 * p};
}

/// Where w is positive.
inline std::vector<Index> positive(const Vector& w) {
  std::vector<Index> result;
  for (Index k = 0; k < w.size(); ++k)
    if (w[k] > 0) result.push_back(k);
  return result;
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

/// The same, which counts the columns that it is asked for.
class CountingProblem : public ColumnsOnly {
 public:
  using ColumnsOnly::ColumnsOnly;
  void column(Index j, VectorOut out) const {
    ++evaluated_;
    ColumnsOnly::column(j, out);
  }
  Index evaluated() const { return evaluated_; }

 private:
  mutable std::atomic<Index> evaluated_ = 0;
};

}  // namespace supple::test
