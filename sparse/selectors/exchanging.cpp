#include <sparse/selectors/exchanging.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace supple {

namespace {

/// The normal equations of unit columns, swept on the support P; Q are the others:
///   T_PP = −G_PP⁻¹, T_PQ = G_PP⁻¹ G_PQ, T_QQ = G_QQ − G_QP G_PP⁻¹ G_PQ;  t_P = w, t_Q = A_Qᵀ(b − A w).
struct SweptGram {
  Matrix T;
  Vector t;
  std::vector<char> in;  // P

  std::vector<Index> positions(bool inside) const {
    std::vector<Index> result;
    for (Index k = 0; k < t.size(); ++k)
      if ((in[k] != 0) == inside) result.push_back(k);
    return result;
  }

  /// From G and Aᵀb themselves: P = support. False, and nothing done, if it depends on itself, to rounding.
  bool sweep(const std::vector<Index>& support) {
    const Eigen::LLT<Matrix> factor(T(support, support));
    if (factor.info() != Eigen::Success) return false;
    for (Index k : support) in[k] = 1;
    const std::vector<Index> Q = positions(false);
    const Matrix G_PQ = T(support, Q), G_PP_inverse_G_PQ = factor.solve(G_PQ);
    const Vector w = factor.solve(t(support));
    T(Q, Q) -= G_PQ.transpose() * G_PP_inverse_G_PQ;
    t(Q) -= G_PQ.transpose() * w;
    T(support, Q) = G_PP_inverse_G_PQ;
    T(Q, support) = G_PP_inverse_G_PQ.transpose();
    T(support, support) = -factor.solve(Matrix::Identity(w.size(), w.size()));
    t(support) = w;
    return true;
  }

  /// Moves column k into the support, or out of it.
  void pivot(Index k) {
    const Vector column = T.col(k);
    const double d = column[k], sign = in[k] ? -1 : 1, step = t[k] / d;
    T.noalias() -= column * (column / d).transpose();
    T.col(k) = sign / d * column;
    T.row(k) = T.col(k).transpose();
    T(k, k) = -1 / d;
    t -= step * column;
    t[k] = sign * step;
    in[k] = !in[k];
  }
};

struct Pair {
  Index leaving, entering;
  double gain;  ///< by which the squared error falls
};

/// For each column outside the support the best to take the place of, if that gains more than rounding; the
/// best pair first. Without i, column j has the squared norm T_jj + T_ij² / h_i off the others, h_i =
/// [G_PP⁻¹]_ii, and the correlation t_j + T_ij w_i / h_i.
std::vector<Pair> gainful_pairs(const SweptGram& swept, const std::vector<char>& fixed, double rounding) {
  const std::vector<Index> P = swept.positions(true);
  const Eigen::ArrayXd h = -swept.T.diagonal()(P).array(), w = swept.t(P).array();
  std::vector<Pair> pairs;
  for (Index j : swept.positions(false)) {
    if (fixed[j]) continue;
    const Eigen::ArrayXd y = swept.T.col(j)(P).array();
    const Eigen::ArrayXd norm = swept.T(j, j) + y.square() / h, correlation = swept.t[j] + y * w / h;
    Pair best{-1, j, rounding};
    for (Index i = 0; i < h.size(); ++i) {
      if (fixed[P[i]] || correlation[i] <= 0 || norm[i] < 1e-8) continue;
      const double gain = correlation[i] * correlation[i] / norm[i] - w[i] * w[i] / h[i];
      if (gain > best.gain) best = {P[i], j, gain};
    }
    if (best.leaving >= 0) pairs.push_back(best);
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.gain > b.gain; });
  return pairs;
}

/// Are all weights positive after it?
bool keeps_signs(const SweptGram& swept, const Pair& pair) {
  const auto& [T, t, in] = swept;
  const Index i = pair.leaving, j = pair.entering;
  const double h_i = -T(i, i), y = T(i, j), w_j = (t[j] + y * t[i] / h_i) / (T(j, j) + y * y / h_i);
  for (Index k = 0; k < t.size(); ++k)
    if (in[k] && k != i && t[k] + T(k, i) * t[i] / h_i - w_j * (T(k, j) + T(k, i) * y / h_i) <= 0) return false;
  return true;
}

}  // namespace

std::vector<Index> exchange(MatrixIn gram, VectorIn atb, VectorIn w, const std::vector<char>& fixed) {
  assert(gram.rows() == atb.size() && static_cast<Index>(fixed.size()) == atb.size());
  const Index n = atb.size();
  const Vector scale = gram.diagonal().unaryExpr([](double g) { return g > 0 ? 1 / std::sqrt(g) : 0; });
  SweptGram swept{scale.asDiagonal() * gram * scale.asDiagonal(), atb.cwiseProduct(scale), std::vector<char>(n, 0)};
  const double rounding = 1e-14 * swept.t.squaredNorm();

  std::vector<Index> support;
  for (Index k = 0; k < n; ++k)
    if (w[k] > 0) support.push_back(k);
  if (swept.sweep(support)) {
    for (std::size_t count = 0; count < support.size(); ++count) {
      const std::vector<Pair> pairs = gainful_pairs(swept, fixed, rounding);
      const auto pair =
          std::find_if(pairs.begin(), pairs.end(), [&](const Pair& some) { return keeps_signs(swept, some); });
      if (pair == pairs.end()) break;
      swept.pivot(pair->leaving);
      swept.pivot(pair->entering);
    }
    support = swept.positions(true);
  }
  for (Index k = 0; k < n; ++k)
    if (fixed[k] && !(w[k] > 0)) support.push_back(k);
  std::sort(support.begin(), support.end());
  return support;
}

}  // namespace supple
