#pragma once
/// \file Isoparametric element types of solids: shape functions and quadrature rules on a reference cell.

#include <core/check.hpp>
#include <core/types.hpp>

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

struct QuadraturePoint {
  std::array<double, 3> xi;  ///< in the reference cell
  double weight;             ///< the weights of a rule add up to the volume of the reference cell
};

/// How the mass of a cell goes to its nodes; either keeps the sum.
enum class MassLumping {
  RowSum,           ///< m_a ∝ ∫ N_a: keeps the centre of mass, too; for elements where all of these are positive
  DiagonalScaling,  ///< m_a ∝ ∫ N_a², always positive. \see Hinton, Rock, Zienkiewicz 1976
};

template <typename Element>
using ShapeGradients = Eigen::Matrix<double, Element::num_nodes, 3>;

/// Shape functions N_a(ξ), which interpolate rest positions and displacements alike: X(ξ) = Σ N_a(ξ) X_a.
/// An element also promises, and tests check: N_a is 1 at node a and 0 at the others; Σ N_a = 1; gradients
/// are those of the shape functions.
template <typename Element>
concept SolidElement = requires(const Point& xi) {
  { Element::name } -> std::convertible_to<std::string_view>;  // in messages
  { Element::num_nodes } -> std::convertible_to<int>;
  { Element::nodes } -> std::convertible_to<std::array<std::array<double, 3>, Element::num_nodes>>;  // ξ of the nodes
  { Element::shape(xi) } -> std::convertible_to<Local<Element::num_nodes>>;                          // N_a
  { Element::shape_gradients(xi) } -> std::convertible_to<ShapeGradients<Element>>;                  // ∂N_a/∂ξ
  { std::span(Element::gauss_points) } -> std::convertible_to<std::span<const QuadraturePoint>>;     // of the energy
  { std::span(Element::mass_points) } -> std::convertible_to<std::span<const QuadraturePoint>>;      // of the mass
  { Element::lumping } -> std::convertible_to<MassLumping>;
};

/// Four nodes: displacements linear, F constant, so one Gauss point is exact. Reference cell: the tet
/// ξ, η, ζ ≥ 0, ξ + η + ζ ≤ 1; nodes in its origin and on its axes, as VTK_TETRA.
struct LinearTet {
  static constexpr std::string_view name = "tet";
  static constexpr int num_nodes = 4;
  static constexpr MassLumping lumping = MassLumping::RowSum;
  static constexpr std::array<std::array<double, 3>, 4> nodes{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  static constexpr std::array<QuadraturePoint, 1> gauss_points{{{{0.25, 0.25, 0.25}, 1.0 / 6}}};
  static constexpr std::array<QuadraturePoint, 1> mass_points = gauss_points;

  static Local<4> shape(const Point& xi);
  static ShapeGradients<LinearTet> shape_gradients(const Point& xi);
};

/// Ten nodes: displacements quadratic. Corners as of LinearTet, then nodes amid the edges 01, 12, 20, 03, 13,
/// 23, as VTK_QUADRATIC_TETRA. The energy takes the four points of degree 2: with straight sides F is linear
/// in ξ, so the tangent at rest is exact, and its rank, 24, is full; with curved sides the rule is not exact
/// even for affine displacements (constant stress, but interior forces that balance to the error of the rule
/// only). The mass takes the 14 points of degree 5 of Walkington 2000: exact for ∫ N_a² with straight sides
/// and for the volume of curved ones. The row sums of corners are negative, so the lumped mass is scaled from
/// the diagonal: 1/36 of the mass for each corner, 4/27 for each mid-edge node with straight sides.
struct QuadraticTet {
  static constexpr std::string_view name = "quadratic tet";
  static constexpr int num_nodes = 10;
  static constexpr MassLumping lumping = MassLumping::DiagonalScaling;
  static constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
  static constexpr std::array<std::array<double, 3>, 10> nodes{{{0, 0, 0},
                                                                {1, 0, 0},
                                                                {0, 1, 0},
                                                                {0, 0, 1},
                                                                {0.5, 0, 0},
                                                                {0.5, 0.5, 0},
                                                                {0, 0.5, 0},
                                                                {0, 0, 0.5},
                                                                {0.5, 0, 0.5},
                                                                {0, 0.5, 0.5}}};
  static constexpr std::array<QuadraturePoint, 4> gauss_points = [] {
    constexpr double near = 0.1381966011250105, far = 0.5854101966249685;  // (5 − √5) / 20, (5 + 3 √5) / 20
    return std::array<QuadraturePoint, 4>{{{{near, near, near}, 1.0 / 24},
                                           {{far, near, near}, 1.0 / 24},
                                           {{near, far, near}, 1.0 / 24},
                                           {{near, near, far}, 1.0 / 24}}};
  }();
  static const std::array<QuadraturePoint, 14> mass_points;

  static Local<10> shape(const Point& xi);
  static ShapeGradients<QuadraticTet> shape_gradients(const Point& xi);
};

/// Eight nodes: displacements trilinear. Reference cell: the unit cube; nodes counter-clockwise in its bottom
/// ζ = 0 from the origin, then in its top, as VTK_HEXAHEDRON. 2 × 2 × 2 Gauss points for energy and mass;
/// those of the mass are exact for ∫ N_a, whatever the shape, and these are positive.
struct TrilinearHex {
  static constexpr std::string_view name = "hex";
  static constexpr int num_nodes = 8;
  static constexpr MassLumping lumping = MassLumping::RowSum;
  static constexpr std::array<std::array<int, 3>, 8> corners{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  static constexpr std::array<std::array<double, 3>, 8> nodes{
      {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  static constexpr std::array<QuadraturePoint, 8> gauss_points = [] {
    constexpr std::array<double, 2> at{0.2113248654051871, 0.7886751345948129};  // (1 ∓ 1/√3) / 2
    std::array<QuadraturePoint, 8> points{};
    for (int a = 0; a < 8; ++a)
      points[a] = {{at[corners[a][0]], at[corners[a][1]], at[corners[a][2]]}, 1.0 / 8};  // each near node a
    return points;
  }();
  static constexpr std::array<QuadraturePoint, 8> mass_points = gauss_points;

  static Local<8> shape(const Point& xi);
  static ShapeGradients<TrilinearHex> shape_gradients(const Point& xi);
};

static_assert(SolidElement<LinearTet> && SolidElement<QuadraticTet> && SolidElement<TrilinearHex>);

/// A cell of given rest positions at a point of its reference cell.
template <SolidElement Element>
struct CellPoint {
  ShapeGradients<Element> gradients;  ///< ∇N_a, by rest positions [1/m]
  double det_J;                       ///< det ∂X/∂ξ [m³]

  /// \param X  rest positions of the nodes, one a row [m].  \param xi  in the reference cell.
  CellPoint(const ShapeGradients<Element>& X, const Point& xi) {
    const ShapeGradients<Element> reference = Element::shape_gradients(xi);
    const Matrix3<double> J = X.transpose() * reference;
    det_J = J.determinant();
    gradients = reference * J.inverse();
  }
};

/// Rest positions of the nodes of cell e, one a row [m].
/// \throws std::invalid_argument that names the cell unless its nodes exist and differ.
template <SolidElement Element>
ShapeGradients<Element> cell_positions(const Points& nodes,
                                       std::span<const std::array<Index, Element::num_nodes>> cells, Index e) {
  const auto& cell = cells[e];
  const auto name = [&] { return std::string(Element::name) + " " + std::to_string(e); };
  ShapeGradients<Element> X;
  for (int a = 0; a < Element::num_nodes; ++a) {
    const Index v = cell[a];
    if (v < 0 || v >= nodes.rows())
      throw std::invalid_argument(name() + " names node " + std::to_string(v) + ", expected 0 to " +
                                  std::to_string(nodes.rows() - 1));
    if (std::find(cell.begin(), cell.begin() + a, v) != cell.begin() + a)
      throw std::invalid_argument(name() + " names node " + std::to_string(v) + " twice");
    X.row(a) = nodes.row(v);
  }
  return X;
}

/// Cell e at each point of a rule. \throws std::invalid_argument that names the cell and the point unless det
/// J > 0.
template <SolidElement Element>
std::vector<CellPoint<Element>> cell_points(const ShapeGradients<Element>& X, Index e,
                                            std::span<const QuadraturePoint> rule) {
  std::vector<CellPoint<Element>> points;
  points.reserve(rule.size());
  for (std::size_t g = 0; g < rule.size(); ++g) {
    points.emplace_back(X, Point(rule[g].xi[0], rule[g].xi[1], rule[g].xi[2]));
    if (!(points.back().det_J > 0))
      throw std::invalid_argument(std::string(Element::name) + " " + std::to_string(e) +
                                  " has det J = " + std::to_string(points.back().det_J) + " m^3 at Gauss point " +
                                  std::to_string(g) + ", expected > 0");
  }
  return points;
}

}  // namespace supple
