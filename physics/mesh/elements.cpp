#include <physics/mesh/elements.hpp>

namespace supple {

Local<4> LinearTet::shape(const Point& xi) {
  return {1 - xi.sum(), xi[0], xi[1], xi[2]};
}

ShapeGradients<LinearTet> LinearTet::shape_gradients(const Point&) {
  ShapeGradients<LinearTet> gradients;
  gradients << Eigen::RowVector3d::Constant(-1), Matrix3<double>::Identity();
  return gradients;
}

const std::array<QuadraturePoint, 14> QuadraticTet::mass_points = [] {
  std::array<QuadraturePoint, 14> points{};
  int count = 0;
  const auto add_barycentric = [&](const std::array<double, 4>& L, double share) {
    points[count++] = {{L[1], L[2], L[3]}, share / 6};
  };
  const auto add_orbit_of_corner = [&](double a, double share) {  // three coordinates a
    for (int i = 0; i < 4; ++i) {
      std::array<double, 4> L{a, a, a, a};
      L[i] = 1 - 3 * a;
      add_barycentric(L, share);
    }
  };
  add_orbit_of_corner(0.31088591926330060980, 0.11268792571801585080);
  add_orbit_of_corner(0.092735250310891226402, 0.073493043116361949544);
  constexpr double a = 0.045503704125649649492;
  for (const auto& [i, j] : QuadraticTet::edges) {
    std::array<double, 4> L{a, a, a, a};
    L[i] = L[j] = 0.5 - a;
    add_barycentric(L, 0.042546020777081466438);
  }
  return points;
}();

Local<10> QuadraticTet::shape(const Point& xi) {
  const Local<4> L = LinearTet::shape(xi);
  Local<10> N;
  for (int a = 0; a < 4; ++a) N[a] = L[a] * (2 * L[a] - 1);
  for (int k = 0; k < 6; ++k) N[4 + k] = 4 * L[edges[k][0]] * L[edges[k][1]];
  return N;
}

ShapeGradients<QuadraticTet> QuadraticTet::shape_gradients(const Point& xi) {
  const Local<4> L = LinearTet::shape(xi);
  const ShapeGradients<LinearTet> dL = LinearTet::shape_gradients(xi);
  ShapeGradients<QuadraticTet> gradients;
  for (int a = 0; a < 4; ++a) gradients.row(a) = (4 * L[a] - 1) * dL.row(a);
  for (int k = 0; k < 6; ++k) {
    const auto [a, b] = edges[k];
    gradients.row(4 + k) = 4 * (L[a] * dL.row(b) + L[b] * dL.row(a));
  }
  return gradients;
}

namespace {

/// The factor of a trilinear shape function along one axis: ξ for a corner at 1, 1 − ξ for one at 0.
double factor(int corner, double xi) {
  return corner == 1 ? xi : 1 - xi;
}
double slope(int corner) {
  return corner == 1 ? 1 : -1;
}

}  // namespace

Local<8> TrilinearHex::shape(const Point& xi) {
  Local<8> N;
  for (int a = 0; a < 8; ++a) {
    const auto [i, j, k] = corners[a];
    N[a] = factor(i, xi[0]) * factor(j, xi[1]) * factor(k, xi[2]);
  }
  return N;
}

ShapeGradients<TrilinearHex> TrilinearHex::shape_gradients(const Point& xi) {
  ShapeGradients<TrilinearHex> gradients;
  for (int a = 0; a < 8; ++a) {
    const auto [i, j, k] = corners[a];
    const double x = factor(i, xi[0]), y = factor(j, xi[1]), z = factor(k, xi[2]);
    gradients.row(a) << slope(i) * y * z, x * slope(j) * z, x * y * slope(k);
  }
  return gradients;
}

}  // namespace supple
