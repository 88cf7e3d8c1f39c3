#pragma once
/// \file Thin shells: triangles that resist bending at their common edges and stretching in their plane.

#include <core/pack.hpp>
#include <physics/material/shell_material.hpp>
#include <physics/mesh/triangle_mesh.hpp>
#include <physics/model/term_pack.hpp>
#include <physics/model/vector_formulas.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace supple {

/// Discrete shells. One component an interior edge ("flap"), in order of interior_edges(); it reads the nodes
/// a, b of the edge and c, d of the triangles (a, b, c) and (b, a, d). With θ the angle between the normals
/// of the two, positive where the surface is convex on the side of its normals, and rest values barred:
///   bending   k_B · 3 |ē|² / (Ā₁ + Ā₂) · (θ − θ̄)²
///   length    ½ k_L Ā_e (|e| / |ē| − 1)²  of the edge, Ā_e a third of the areas beside it,
///   area      ½ k_A Ā (A / Ā − 1)²        of both triangles.
/// The one to three flaps of a triangle share its area term equally, and the length terms of its boundary
/// edges. So the sum over all flaps counts every edge and triangle once.
///
/// The difference of angles is taken modulo 2π in (−π, π]: nothing jumps where a hinge folds through π; the
/// kink that an energy of angles must have is where a hinge stands opposite to its rest angle. Energy and
/// force are finite in every finite state: a triangle of no area counts as one at its rest angle, an edge of
/// no length pulls nowhere. But close to such a state bending forces grow as 1 / height, and in it the energy
/// has no derivative.
/// \see Grinspun, Hirani, Desbrun, Schröder 2003, "Discrete Shells"; docs/notation.md.
class DiscreteShell {
 public:
  static constexpr int stencil_size = 4;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 12;
  static constexpr bool translation_invariant = true;

  /// One flap: a function of the displacements of a, b, c, d.
  template <typename Real>
  struct Term {
    std::array<Real, 9> rest;         ///< b − a, c − a, d − a at rest [m]
    Real rest_cos, rest_sin;          ///< of θ̄
    Real bending;                     ///< k with ½ k (θ − θ̄)² [J]
    std::array<Real, 5> rest_length;  ///< of the edges ab, ac, bc, ad, bd [m]
    std::array<Real, 5> spring;       ///< k with ½ k (l − l̄)², the share of this flap [N/m]
    std::array<Real, 2> rest_normal;  ///< twice the area of abc and bad at rest [m²]
    std::array<Real, 2> area_spring;  ///< k with ½ k (|n| − |n̄|)², the share of this flap [N/m³]

    Real energy(const Local<12, Real>& u) const;
    Local<12, Real> force(const Local<12, Real>& u) const;
    LocalMatrix<12, Real> stiffness(const Local<12, Real>& u) const;

    /// θ − θ̄ in (−π, π].
    Real bend(const Local<12, Real>& u) const { return bend(Shape(*this, u)); }

   private:
    using Vec = Vector3<Real>;
    /// Lengths and areas below are taken for this: far below any mesh, and its powers are still numbers.
    static constexpr double smallest = 1e-100;

    /// An edge as it is now. Its square is compared with that at rest through the displacements, which keeps
    /// the digits of small ones: |e|² − |ē|² = Δ · (2 e − Δ) with Δ = e − ē.
    struct Edge {
      Vec now, change;  // e, Δ
      Real rest_length;

      Real growth() const { return detail::dot(change, Vec(now + (now - change))); }  // |e|² − |ē|²
      Real stretch(const Real& length) const { return growth() / (length + rest_length); }
    };
    /// A flap as it is now, seen from a.
    struct Shape {
      Vec e, c, d;                       // b − a, c − a, d − a
      Vec change_e, change_c, change_d;  // since rest
      Vec n_c, n_d;                      // e × c, the normal of abc, and e × d, that of bad reversed
      Real length;                       // |e|

      Shape(const Term& term, const Local<12, Real>& u);
      /// |n|² − |n̄|² of the normal n = e × p, likewise from displacements.
      Real growth(const Vec& n, const Vec& p, const Vec& change_p) const {
        const Vec change_n = detail::cross(e, change_p) + detail::cross(change_e, Vec(p - change_p));
        return detail::dot(change_n, Vec(n + (n - change_n)));
      }
    };
    Edge inner_edge(const Shape& s) const { return {s.e, s.change_e, rest_length[0]}; }
    /// Edge k = 1 … 4: ac, bc, ad, bd.
    Edge outer_edge(const Shape& s, int k) const {
      const Vec &p = k < 3 ? s.c : s.d, &change = k < 3 ? s.change_c : s.change_d;
      if (k % 2 == 1) return {p, change, rest_length[k]};
      return {p - s.e, change - s.change_e, rest_length[k]};
    }
    /// One of the two triangles in the frame of its own: p − a = t e + h b̂ with p its node off the edge.
    struct Wing;

    bool has_boundary() const { return any_positive(spring[1] + spring[2] + spring[3] + spring[4]); }
    bool resists_area() const { return any_positive(area_spring[0] + area_spring[1]); }
    Real bend(const Shape& shape) const;
    /// Few flaps are at the boundary: kept out of the way of the others.
    [[gnu::noinline]] Local<12, Real> boundary_force(const Shape& shape) const;
    Local<12, Real> area_force(const Shape& shape) const;
    /// The force on all corners: that on a balances the others.
    static Local<12, Real> on_corners(const Vec& f_b, const Vec& f_c, const Vec& f_d) {
      Local<12, Real> f;
      for (int i = 0; i < 3; ++i) {
        f[i] = -(f_b[i] + f_c[i] + f_d[i]);
        f[3 + i] = f_b[i];
        f[6 + i] = f_c[i];
        f[9 + i] = f_d[i];
      }
      return f;
    }
  };

  /// \param materials  one for all triangles, or one a triangle (say, of varying thickness): an edge takes
  /// the mean of its triangles for stretching and, as two strips that bend in series, the harmonic mean for
  /// bending, both weighted by area. \throws std::invalid_argument as check_mesh and ShellMaterial::check,
  /// on another number of materials, and for a triangle without an interior edge, of which no component
  /// would know.
  DiscreteShell(const TriangleMesh& mesh, const std::vector<ShellMaterial>& materials);
  DiscreteShell(const TriangleMesh& mesh, const ShellMaterial& material)
      : DiscreteShell(mesh, std::vector<ShellMaterial>{material}) {}

  Index num_nodes() const { return rest_positions_.rows(); }
  const Points& rest_positions() const { return rest_positions_; }  ///< n × 3 [m]
  Index num_components() const { return static_cast<Index>(terms_.size()); }
  std::span<const Index, 4> stencil(Index i) const { return stencils_[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  double energy(Index i, const Local<12>& u_i) const { return terms_[i].energy(u_i); }
  Local<12> force(Index i, const Local<12>& u_i) const { return terms_[i].force(u_i); }
  LocalMatrix<12> stiffness(Index i, const Local<12>& u_i) const { return terms_[i].stiffness(u_i); }

 private:
  Points rest_positions_;
  std::vector<std::array<Index, 4>> stencils_;
  std::vector<Term<double>> terms_;
};

template <typename Real>
DiscreteShell::Term<Real>::Shape::Shape(const Term& term, const Local<12, Real>& u) {
  for (int i = 0; i < 3; ++i) {
    change_e[i] = u[3 + i] - u[i];
    change_c[i] = u[6 + i] - u[i];
    change_d[i] = u[9 + i] - u[i];
    e[i] = term.rest[i] + change_e[i];
    c[i] = term.rest[3 + i] + change_c[i];
    d[i] = term.rest[6 + i] + change_d[i];
  }
  n_c = detail::cross(e, c);
  n_d = detail::cross(e, d);
  length = detail::norm(e);
}

template <typename Real>
Real DiscreteShell::Term<Real>::bend(const Shape& shape) const {
  using std::atan2;
  const Real sin = -shape.length * detail::dot(shape.n_c, shape.d);  // both times |n_c| |n_d|
  const Real cos = -detail::dot(shape.n_c, shape.n_d);
  return atan2(sin * rest_cos - cos * rest_sin, cos * rest_cos + sin * rest_sin);
}

template <typename Real>
Real DiscreteShell::Term<Real>::energy(const Local<12, Real>& u) const {
  const Shape shape(*this, u);
  const Real angle = bend(shape), stretch = inner_edge(shape).stretch(shape.length);
  Real twice = bending * angle * angle + spring[0] * stretch * stretch;
  if (has_boundary())
    for (int k = 1; k < 5; ++k) {
      const Edge edge = outer_edge(shape, k);
      const Real change = edge.stretch(detail::norm(edge.now));
      twice += spring[k] * change * change;
    }
  if (resists_area()) {
    const auto spread = [&](int k, const Vec& n, const Vec& p, const Vec& change_p) {
      const Real change = shape.growth(n, p, change_p) / (detail::norm(n) + rest_normal[k]);
      twice += area_spring[k] * change * change;
    };
    spread(0, shape.n_c, shape.c, shape.change_c);
    spread(1, shape.n_d, shape.d, shape.change_d);
  }
  return Real(0.5) * twice;
}

template <typename Real>
Local<12, Real> DiscreteShell::Term<Real>::force(const Local<12, Real>& u) const {
  using detail::at_least, detail::dot;
  const Shape shape(*this, u);
  // ∂θ/∂c = −|e| n_c / |n_c|², ∂θ/∂d = |e| n_d / |n_d|², and at b what keeps rotations free
  const Real moment = bending * bend(shape) * shape.length;
  const Vec f_c = shape.n_c * (-moment / at_least(smallest * smallest, dot(shape.n_c, shape.n_c)));
  const Vec f_d = shape.n_d * (moment / at_least(smallest * smallest, dot(shape.n_d, shape.n_d)));
  // one division for 1 / |e|² and (|e| − |ē|) / |e|
  const Real sum = shape.length + rest_length[0], square = shape.length * shape.length;
  const Real inverse = Real(1) / at_least(smallest * smallest, square * sum);
  const Real inverse_square = inverse * sum;
  const Vec f_b = shape.e * (spring[0] * inner_edge(shape).growth() * shape.length * inverse) -
                  (f_c * (dot(shape.c, shape.e) * inverse_square) + f_d * (dot(shape.d, shape.e) * inverse_square));
  Local<12, Real> f = on_corners(f_b, f_c, f_d);
  if (has_boundary()) f += boundary_force(shape);
  if (resists_area()) f += area_force(shape);
  return f;
}

template <typename Real>
Local<12, Real> DiscreteShell::Term<Real>::boundary_force(const Shape& shape) const {
  const auto pull = [&](int k) -> Vec {
    const Edge edge = outer_edge(shape, k);
    const Real length = detail::norm(edge.now);
    return edge.now * (spring[k] * edge.growth() / detail::at_least(smallest, length * (length + rest_length[k])));
  };
  const Vec ac = pull(1), bc = pull(2), ad = pull(3), bd = pull(4);
  return on_corners(-bc - bd, ac + bc, ad + bd);
}

template <typename Real>
Local<12, Real> DiscreteShell::Term<Real>::area_force(const Shape& shape) const {
  const auto tension = [&](int k, const Vec& n, const Vec& p, const Vec& change_p) -> Vec {
    const Real size = detail::norm(n);
    return n *
           (area_spring[k] * shape.growth(n, p, change_p) / detail::at_least(smallest, size * (size + rest_normal[k])));
  };
  const Vec at_c = tension(0, shape.n_c, shape.c, shape.change_c);
  const Vec at_d = tension(1, shape.n_d, shape.d, shape.change_d);
  return on_corners(detail::cross(shape.c, at_c) + detail::cross(shape.d, at_d), detail::cross(at_c, shape.e),
                    detail::cross(at_d, shape.e));
}

template <typename Real>
struct DiscreteShell::Term<Real>::Wing {
  Vec e, b, n;  // unit vectors: along the edge, towards p, and e × b
  Real t, h;    // h the height over the edge
  Real inverse_height, inverse_length;

  Wing(const Shape& shape, const Vec& p, const Vec& normal) {
    const Real size = detail::norm(normal), inverse = Real(1) / detail::at_least(smallest, size);
    inverse_length = Real(1) / detail::at_least(smallest, shape.length);
    e = shape.e * inverse_length;
    n = normal * inverse;
    b = detail::cross(n, e);
    t = detail::dot(p, e) * inverse_length;
    h = size * inverse_length;
    inverse_height = shape.length * inverse;
  }
};

template <typename Real>
LocalMatrix<12, Real> DiscreteShell::Term<Real>::stiffness(const Local<12, Real>& u) const {
  using detail::at_least, detail::dot, detail::norm;
  const Shape shape(*this, u);
  const std::array<Wing, 2> wings{Wing(shape, shape.c, shape.n_c), Wing(shape, shape.d, shape.n_d)};
  const std::array<Real, 2> sign{Real(-1), Real(1)};  // θ falls as c rises along n_c, grows as d along n_d
  LocalMatrix<12, Real> K;                            // first over b, c, d; then what follows for a

  // bending: k (g gᵀ + (θ − θ̄) ∂²θ)
  Local<9, Real> g;
  for (int i = 0; i < 3; ++i) {
    for (int w = 0; w < 2; ++w) g[3 + 3 * w + i] = sign[w] * wings[w].inverse_height * wings[w].n[i];
    g[i] = -(wings[0].t * g[3 + i] + wings[1].t * g[6 + i]);
  }
  for (int j = 0; j < 9; ++j) {
    const Real k_g = bending * g[j];
    for (int i = 0; i <= j; ++i) K(3 + i, 3 + j) = k_g * g[i];
  }
  const Real moment = bending * bend(shape);
  for (int w = 0; w < 2; ++w) {
    const Wing& wing = wings[w];
    const int p = 6 + 3 * w;
    const Real m = sign[w] * moment;
    const Real alpha = m * wing.inverse_height * wing.inverse_height;
    const Real beta = m * wing.inverse_height * wing.inverse_length;
    const Real alpha_t = alpha * wing.t, beta_t = beta * wing.t;
    const Real both = alpha_t * wing.t + Real(0.5) * m * wing.inverse_length * wing.inverse_length;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        const Real B = wing.n[i] * wing.b[j] + wing.b[i] * wing.n[j];
        const Real N = wing.e[i] * wing.n[j], Nt = wing.n[i] * wing.e[j];
        if (i <= j) {
          K(p + i, p + j) -= alpha * B;
          K(3 + i, 3 + j) -= both * B - beta_t * (N + Nt);
        }
        K(3 + i, p + j) += alpha_t * B - beta * Nt;
      }
  }

  // length: k (l̄ ê êᵀ + (l − l̄) I) / l
  const auto add_edge = [&](int k, const Edge& edge, auto&& add) {
    const Vec& now = edge.now;
    const Real length = norm(now), inverse = Real(1) / at_least(smallest, length);
    const Real along = spring[k] * rest_length[k] * inverse * inverse * inverse;
    const Real across = spring[k] * edge.stretch(length) * inverse;
    for (int j = 0; j < 3; ++j)
      for (int i = 0; i < 3; ++i) {
        Real entry = along * now[i] * now[j];
        if (i == j) entry += across;
        add(i, j, entry);
      }
  };
  const auto add_diagonal = [&](int row, int i, int j, const Real& entry) {
    if (i <= j) K(row + i, row + j) += entry;
  };
  add_edge(0, inner_edge(shape), [&](int i, int j, const Real& entry) { add_diagonal(3, i, j, entry); });
  if (has_boundary())
    for (int w = 0; w < 2; ++w) {
      const int p = 6 + 3 * w;
      add_edge(1 + 2 * w, outer_edge(shape, 1 + 2 * w),
               [&](int i, int j, const Real& entry) { add_diagonal(p, i, j, entry); });
      add_edge(2 + 2 * w, outer_edge(shape, 2 + 2 * w), [&](int i, int j, const Real& entry) {
        add_diagonal(3, i, j, entry);
        add_diagonal(p, i, j, entry);
        K(3 + i, p + j) -= entry;
      });
    }

  // area: k (q qᵀ + (|n| − |n̄|) ∂²|n|) with q = ∂|n|, |e| b̂ at p and h ê − t |e| b̂ at b
  if (resists_area())
    for (int w = 0; w < 2; ++w) {
      const Wing& wing = wings[w];
      const int p = 6 + 3 * w;
      const Real growth =
          w == 0 ? shape.growth(shape.n_c, shape.c, shape.change_c) : shape.growth(shape.n_d, shape.d, shape.change_d);
      const Real k = area_spring[w], tension = k * growth / (shape.length * wing.h + rest_normal[w]);
      const Vec q_p = wing.b * shape.length, q_b = wing.e * wing.h - q_p * wing.t;
      const Real n_pp = tension * shape.length * wing.inverse_height, n_bp = n_pp * wing.t;
      const Real n_bb = n_bp * wing.t + tension * wing.h * wing.inverse_length;
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
          const Real nn = wing.n[i] * wing.n[j];
          if (i <= j) {
            K(p + i, p + j) += k * q_p[i] * q_p[j] + n_pp * nn;
            K(3 + i, 3 + j) += k * q_b[i] * q_b[j] + n_bb * nn;
          }
          K(3 + i, p + j) +=
              k * q_b[i] * q_p[j] - n_bp * nn + tension * (wing.e[i] * wing.b[j] - wing.b[i] * wing.e[j]);
        }
    }

  for (int j = 3; j < 12; ++j)
    for (int i = 3; i < j; ++i) K(j, i) = K(i, j);
  for (int j = 3; j < 12; ++j)
    for (int i = 0; i < 3; ++i) {
      K(i, j) = -(K(3 + i, j) + K(6 + i, j) + K(9 + i, j));
      K(j, i) = K(i, j);
    }
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i <= j; ++i) {
      K(i, j) = -(K(i, 3 + j) + K(i, 6 + j) + K(i, 9 + j));
      K(j, i) = K(i, j);
    }
  return K;
}

static_assert(PackableForceModel<DiscreteShell>);

}  // namespace supple
