#pragma once
/// \file Slow, plain answers to non-negative least squares, in extended precision.

#include <core/types.hpp>

#include <Eigen/QR>

#include <limits>
#include <vector>

namespace supple::test {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

/// The smallest ‖A w − b‖, w ≥ 0, over all 2ⁿ supports.
inline long double brute_force_residual(const Matrix& A, const Vector& b) {
  const LongMatrix A_long = A.cast<long double>();
  const LongVector b_long = b.cast<long double>();
  long double least = b_long.norm();
  for (unsigned set = 1; set < 1u << A.cols(); ++set) {
    std::vector<Index> P;
    for (Index j = 0; j < A.cols(); ++j)
      if (set >> j & 1) P.push_back(j);
    const LongMatrix A_P = A_long(Eigen::all, P);
    const Eigen::ColPivHouseholderQR<LongMatrix> qr(A_P);
    if (qr.rank() < A_P.cols()) continue;  // a smaller support does as well
    const LongVector w = qr.solve(b_long);
    if (w.minCoeff() >= 0) least = std::min<long double>(least, (b_long - A_P * w).norm());
  }
  return least;
}

/// Lawson and Hanson's method, with a new Householder factorisation of the unit columns for every passive
/// set.
inline LongVector lawson_hanson(const Matrix& A_double, const Vector& b_double) {
  LongMatrix A = A_double.cast<long double>();
  const LongVector b = b_double.cast<long double>();
  const Index n = A.cols();
  LongVector scale = LongVector::Zero(n);
  for (Index j = 0; j < n; ++j)
    if (A.col(j).norm() > 0) A.col(j) *= scale[j] = 1 / A.col(j).norm();
  LongVector x = LongVector::Zero(n);
  std::vector<char> passive(n, 0), barred(n, 0);
  const auto minimiser = [&] {
    std::vector<Index> P;
    for (Index j = 0; j < n; ++j)
      if (passive[j]) P.push_back(j);
    LongVector z = LongVector::Zero(n);
    if (!P.empty()) z(P) = Eigen::ColPivHouseholderQR<LongMatrix>(A(Eigen::all, P)).solve(b);
    return z;
  };
  const long double noise = 1e-17L * b.norm();
  for (int steps = 0; steps < 10 * n + 100; ++steps) {
    const LongVector g = A.transpose() * (b - A * x);
    Index best = -1;
    for (Index j = 0; j < n; ++j)
      if (!passive[j] && !barred[j] && scale[j] > 0 && g[j] > noise && (best < 0 || g[j] > g[best])) best = j;
    if (best < 0) break;
    passive[best] = 1;
    LongVector z = minimiser();
    if (z[best] <= 0) {
      passive[best] = 0;
      barred[best] = 1;
      continue;
    }
    std::fill(barred.begin(), barred.end(), 0);
    for (;;) {
      long double alpha = 1;
      Index first = -1;
      for (Index j = 0; j < n; ++j)
        if (passive[j] && z[j] <= 0 && x[j] / (x[j] - z[j]) <= alpha) alpha = x[j] / (x[j] - z[j]), first = j;
      x += alpha * (z - x);
      if (first < 0) break;
      for (Index j = 0; j < n; ++j)
        if (passive[j] && (j == first || (z[j] <= 0 && x[j] <= 0))) passive[j] = 0, x[j] = 0;
      z = minimiser();
    }
    x = z;
  }
  return x.cwiseProduct(scale);
}

/// The largest violation of gᵢ ≤ 0, and of gᵢ = 0 where wᵢ > 0, by gᵢ = aᵢᵀ(b − A w) / (‖aᵢ‖ ‖b‖), on A
/// itself.
inline double kkt_residual(const Matrix& A, const Vector& b, const Vector& w) {
  const LongVector r = b.cast<long double>() - A.cast<long double>() * w.cast<long double>();
  double worst = 0;
  for (Index j = 0; j < A.cols(); ++j) {
    const double norm = A.col(j).stableNorm();
    if (norm == 0) continue;
    const auto g = static_cast<double>(A.col(j).cast<long double>().dot(r) / norm);
    worst = std::max(worst, w[j] > 0 ? std::abs(g) : g);
  }
  return b.norm() > 0 ? worst / b.norm() : worst;
}

}  // namespace supple::test
