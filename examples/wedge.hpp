#pragma once
// An element type on a page: the wedge, a triangle drawn out along a line. Six nodes.

#include <physics/mesh/elements.hpp>

struct Wedge {
  static constexpr std::string_view name = "wedge";  // in messages
  static constexpr int num_nodes = 6;
  // the reference cell: the triangle ξ, η ≥ 0, ξ + η ≤ 1 at ζ = 0, and again at ζ = 1
  static constexpr std::array<std::array<double, 3>, 6> nodes{
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};

  // N_a: linear in the triangle times linear along the line
  static supple::Local<6> shape(const supple::Point& xi) {
    const supple::Local<3> in_triangle(1 - xi[0] - xi[1], xi[0], xi[1]);
    supple::Local<6> N;
    N << (1 - xi[2]) * in_triangle, xi[2] * in_triangle;
    return N;
  }
  // ∂N_a/∂ξ, a row a node
  static supple::ShapeGradients<Wedge> shape_gradients(const supple::Point& xi) {
    const supple::Local<3> in_triangle(1 - xi[0] - xi[1], xi[0], xi[1]), by_xi(-1, 1, 0), by_eta(-1, 0, 1);
    const double below = 1 - xi[2], above = xi[2];
    supple::ShapeGradients<Wedge> gradients;
    gradients << below * by_xi, below * by_eta, -in_triangle, above * by_xi, above * by_eta, in_triangle;
    return gradients;
  }

  // three points of the triangle times Gauss's two of the line; the weights add up to the volume, ½
  static constexpr std::array<supple::QuadraturePoint, 6> gauss_points = [] {
    constexpr double a = 1.0 / 6, b = 2.0 / 3, low = 0.2113248654051871, high = 0.7886751345948129;
    std::array<supple::QuadraturePoint, 6> points{};
    int k = 0;
    for (const double zeta : {low, high})
      for (const auto& [xi, eta] : {std::pair(a, a), std::pair(b, a), std::pair(a, b)})
        points[k++] = {{xi, eta, zeta}, 1.0 / 12};
    return points;
  }();
  static constexpr auto mass_points = gauss_points;
  static constexpr supple::MassLumping lumping = supple::MassLumping::RowSum;
};
static_assert(supple::SolidElement<Wedge>);
