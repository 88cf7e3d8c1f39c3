#include <reduction/subspace.hpp>

#include <cmath>

namespace supple {

Orthonormalized mass_orthonormalize(const RowMatrix& W, VectorIn mass, double tolerance) {
  require_size("mass", mass.size(), W.rows());
  Matrix Q = W;
  Index kept = 0;
  for (Index j = 0; j < W.cols(); ++j) {
    Vector w = Q.col(j);
    const double length = std::sqrt(w.dot(mass.cwiseProduct(w)));
    if (!(length > 0)) continue;
    w /= length;
    for (int pass = 0; pass < 3; ++pass) {  // each pass removes what rounding left of the one before
      const Vector overlap = Q.leftCols(kept).transpose() * mass.cwiseProduct(w);
      w.noalias() -= Q.leftCols(kept) * overlap;
      if (pass > 0 && overlap.norm() < 1e-14) break;
    }
    const double rest = std::sqrt(w.dot(mass.cwiseProduct(w)));
    if (rest <= tolerance) continue;
    Q.col(kept++) = w / rest;
  }
  // columns that kept only a small part of themselves are orthogonal to the relative rounding of that part;
  // once more
  for (Index j = 0; j < kept; ++j) {
    Vector w = Q.col(j);
    w -= Q.leftCols(j) * (Q.leftCols(j).transpose() * mass.cwiseProduct(w));
    Q.col(j) = w / std::sqrt(w.dot(mass.cwiseProduct(w)));
  }
  return {Q.leftCols(kept), W.cols() - kept};
}

}  // namespace supple
