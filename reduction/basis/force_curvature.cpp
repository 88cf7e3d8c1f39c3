#include <core/check.hpp>
#include <core/parallel.hpp>
#include <reduction/basis/force_curvature.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace supple {

ForceCurvature::ForceCurvature(const RestState& object) : object_(object) {
  const Points& X = object.positions;
  require_size("rest positions", X.rows(), object.numbering.num_nodes());
  const double diameter = (X.colwise().maxCoeff() - X.colwise().minCoeff()).norm();
  if (diameter > 0) inverse_diameter_ = 1 / diameter;

  std::vector<std::pair<Index, Index>> nodes;
  const Index size = object.stencil_size, count = static_cast<Index>(object.stencils.size()) / size;
  for (Index i = 0; i < count; ++i)
    for (Index a = 0; a < size; ++a)
      for (Index b = a + 1; b < size; ++b)
        nodes.push_back(std::minmax({object.stencils[i * size + a], object.stencils[i * size + b]}));
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  for (const auto& [v, w] : nodes) {
    const double distance = (X.row(v) - X.row(w)).norm();
    const Index a = object.numbering.free_index(v), b = object.numbering.free_index(w);
    if (distance > 0 && (a >= 0 || b >= 0)) pairs_.push_back({a, b, 1 / distance});
  }
}

double ForceCurvature::size(VectorIn x) const {
  require_size("x", x.size(), object_.mass.size());
  const auto at = [&](Index v) -> Point {
    if (v < 0) return Point::Zero();
    return x.segment<3>(3 * v);
  };
  double largest = 0;
  for (Index v = 0; v < x.size() / 3; ++v) largest = std::max(largest, at(v).norm() * inverse_diameter_);
  for (const Pair& pair : pairs_) largest = std::max(largest, (at(pair.a) - at(pair.b)).norm() * pair.inverse_distance);
  return largest;
}

Vector ForceCurvature::operator()(VectorIn x) const {
  Vector H(x.size());
  few_squares(x, H);
  return H;
}

Matrix ForceCurvature::squares(MatrixIn X) const {
  Matrix H(X.rows(), X.cols());
  constexpr Index at_once = 2;
  parallel_ranges(X.cols(), at_once, [&](Index begin, Index end) {
    few_squares(X.middleCols(begin, end - begin), H.middleCols(begin, end - begin));
  });
  return H;
}

void ForceCurvature::few_squares(MatrixIn X, MatrixOut H) const {
  require(X.allFinite(), "the second derivative of the force: x is not finite");
  // forces that cancel leave rounding, which must not be taken for a step that is too long
  const auto rounding = [&](VectorIn x, double step) {
    double largest = 0;
    for (Index j = 0; j < object_.K.cols(); ++j)
      for (SparseMatrix::InnerIterator it(object_.K, j); it; ++it)
        largest = std::max(largest, std::abs(it.value() * x[j]));
    return 8 * std::numeric_limits<double>::epsilon() * largest / (step * step * size(x)) *
           std::sqrt(static_cast<double>(x.size()));
  };
  std::vector<Index> open;
  for (Index k = 0; k < X.cols(); ++k) open.push_back(k);
  Vector unit(X.cols());  // step of size 1
  for (const Index k : open) unit[k] = 1 / size(X.col(k));
  H.setZero();
  std::erase_if(open, [&](Index k) { return !std::isfinite(unit[k]); });
  for (double scale = 1.0 / 128; !open.empty() && scale > 1e-6; scale /= 4) {
    const auto count = static_cast<Index>(open.size());
    Matrix states(X.rows(), 4 * count), f(X.rows(), 4 * count);
    for (Index o = 0; o < count; ++o) {
      const auto x = scale * unit[open[o]] * X.col(open[o]);
      states.middleCols(4 * o, 4) << x, -x, 0.5 * x, -0.5 * x;
    }
    object_.forces(states, f);
    std::vector<Index> left;
    for (Index o = 0; o < count; ++o) {
      const Index k = open[o];
      const double step = scale * unit[k];
      const Vector coarse = (f.col(4 * o) + f.col(4 * o + 1)) / (step * step);
      const Vector fine = 4 * (f.col(4 * o + 2) + f.col(4 * o + 3)) / (step * step);
      const double change = (fine - coarse).norm();  // may be NaN
      if (change <= 1e-2 * fine.norm() || change <= rounding(X.col(k), step))
        H.col(k) = fine + (fine - coarse) / 3;
      else
        left.push_back(k);
    }
    open = std::move(left);
  }
  if (!open.empty())
    throw SolverError("the second derivative of the force at rest: differences of forces do not converge");
}

Vector ForceCurvature::operator()(VectorIn a, VectorIn b) const {
  return 0.5 * ((*this)(a + b) - ((*this)(a) + (*this)(b)));  // the same bits for (b, a)
}

}  // namespace supple
