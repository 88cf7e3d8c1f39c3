#include <core/check.hpp>
#include <sparse/nnls/pruning.hpp>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cassert>

namespace supple {

std::vector<Index> prune(MatrixIn gram, VectorIn weights, Index size, const std::vector<char>& fixed) {
  assert(gram.rows() == weights.size() && static_cast<Index>(fixed.size()) == weights.size());
  std::vector<Index> kept, active;  // active: those with a weight, in the order of the matrices below
  for (Index i = 0; i < weights.size(); ++i) {
    if (weights[i] > 0)
      active.push_back(i);
    else if (fixed[i])
      kept.push_back(i);
  }
  size -= static_cast<Index>(kept.size());

  auto n = static_cast<Index>(active.size());
  Vector w = weights(active);
  if (n > size) {
    const Vector scale = gram.diagonal()(active).cwiseSqrt().cwiseInverse();  // to unit columns
    Matrix H = scale.asDiagonal() * gram(active, active) * scale.asDiagonal();
    Eigen::LLT<Matrix> factor(H);
    for (double ridge = 1e-14; factor.info() != Eigen::Success; ridge *= 100) {  // dependent up to rounding
      if (ridge > 1e-6) throw SolverError("the Gram matrix of columns with a weight is indefinite");
      H.diagonal().array() += ridge;
      factor.compute(H);
    }
    H = factor.solve(Matrix::Identity(n, n));
    w = w.cwiseQuotient(scale);

    Vector diagonal = H.diagonal();
    Matrix V(n, 32);  // downdates of H that wait for their turn: H − V diag(v)⁻¹ Vᵀ is meant
    Vector v(V.cols());
    Index waiting = 0;
    for (; n > size; --n) {
      Index k = -1;
      double least = 0;
      for (Index i = 0; i < n; ++i) {
        if (fixed[active[i]]) continue;
        const double loss = w[i] > 0 ? w[i] * w[i] / diagonal[i] : w[i];
        if (k < 0 || loss < least) k = i, least = loss;
      }
      if (k < 0) break;  // all that is left is fixed
      // The last one takes the place of column k, and the leading blocks are downdated.
      Vector h = H.col(k).head(n);
      h.noalias() -= V.topLeftCorner(n, waiting) * V.row(k).head(waiting).transpose().cwiseQuotient(v.head(waiting));
      w.head(n) -= h * (w[k] / h[k]);
      diagonal.head(n) -= h.cwiseAbs2() / h[k];
      V.col(waiting).head(n) = h;
      v[waiting++] = h[k];
      H.col(k).head(n) = H.col(n - 1).head(n);
      H.row(k).head(n) = H.row(n - 1).head(n);
      V.row(k) = V.row(n - 1);
      diagonal[k] = diagonal[n - 1];
      w[k] = w[n - 1];
      active[k] = active[n - 1];
      if (waiting == V.cols()) {
        H.topLeftCorner(n - 1, n - 1).noalias() -=
            V.topRows(n - 1) * v.cwiseInverse().asDiagonal() * V.topRows(n - 1).transpose();
        waiting = 0;
      }
    }
    active.resize(n);
  }
  kept.insert(kept.end(), active.begin(), active.end());
  std::sort(kept.begin(), kept.end());
  return kept;
}

}  // namespace supple
