#include <core/check.hpp>
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

Vector ForceCurvature::difference(VectorIn x, double step) const {
  Vector there(x.size()), back(x.size());
  object_.force(step * x, there);
  object_.force(-step * x, back);
  return (there + back) / (step * step);
}

Vector ForceCurvature::operator()(VectorIn x) const {
  require(x.allFinite(), "the second derivative of the force: x is not finite");
  const double size_of_x = size(x);
  if (size_of_x == 0) return Vector::Zero(x.size());
  // forces that cancel leave rounding, which must not be taken for a step that is too long
  const auto rounding = [&](double step) {
    double largest = 0;
    for (Index j = 0; j < object_.K.cols(); ++j)
      for (SparseMatrix::InnerIterator it(object_.K, j); it; ++it)
        largest = std::max(largest, std::abs(it.value() * x[j]));
    return 8 * std::numeric_limits<double>::epsilon() * largest / (step * step * size_of_x) *
           std::sqrt(static_cast<double>(x.size()));
  };
  for (double step = 1.0 / 128 / size_of_x; step * size_of_x > 1e-6; step /= 4) {
    const Vector coarse = difference(x, step), fine = difference(x, step / 2);
    const double change = (fine - coarse).norm();  // may be NaN
    if (change <= 1e-2 * fine.norm() || change <= rounding(step)) return fine + (fine - coarse) / 3;
  }
  throw SolverError("the second derivative of the force at rest: differences of forces do not converge");
}

Vector ForceCurvature::operator()(VectorIn a, VectorIn b) const {
  return 0.5 * ((*this)(a + b) - ((*this)(a) + (*this)(b)));  // the same bits for (b, a)
}

}  // namespace supple
