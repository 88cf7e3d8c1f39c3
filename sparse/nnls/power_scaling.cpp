#include <sparse/nnls/power_scaling.hpp>

#include <cmath>

namespace supple {

namespace {

int exponent(double norm) {
  return norm > 0 ? std::ilogb(norm) : 0;
}

}  // namespace

PowerScaling::PowerScaling(MatrixIn A_in, VectorIn b_in, const Vector& norms, double b_norm)
    : A(A_in), b(b_in), rhs_exponent(exponent(b_norm)) {
  const auto scale = [](auto&& column, int e) {  // in two halves: 2^-e itself may be beyond all numbers
    column *= std::ldexp(1.0, -(e / 2));
    column *= std::ldexp(1.0, -(e - e / 2));
  };
  scale(b, rhs_exponent);
  for (Index j = 0; j < A.cols(); ++j) {
    column_exponents.push_back(exponent(norms[j]));
    scale(A.col(j), column_exponents.back());
  }
}

NnlsFit PowerScaling::undo(NnlsFit fit) const {
  for (Index j = 0; j < fit.w.size(); ++j) {
    const double w = std::ldexp(fit.w[j], rhs_exponent - column_exponents[j]);
    if (!std::isfinite(w) || (w == 0) != (fit.w[j] == 0)) {
      fit.report.status = Status::NotFinite;
      fit.passive.clear();
      fit.w.setZero();
      fit.residual_norm = b.norm();
      break;
    }
    fit.w[j] = w;
  }
  fit.residual_norm = std::ldexp(fit.residual_norm, rhs_exponent);
  return fit;
}

}  // namespace supple
