#pragma once
/// \file Thin rods: polylines that resist stretching and bending, not twist.

#include <core/check.hpp>
#include <physics/model/term_pack.hpp>
#include <physics/model/vector_formulas.hpp>

#include <array>
#include <string>
#include <vector>

namespace supple {

/// How much a rod resists. A round one of radius r and Young's modulus E: E A = E π r², E I = E π r⁴ / 4.
struct RodMaterial {
  double stretch = 0;  ///< E A [N], ≥ 0
  double bending = 0;  ///< E I [N m²], ≥ 0

  /// \param young [Pa]  \param radius [m]  \throws std::invalid_argument unless both are > 0.
  static RodMaterial from(double young, double radius);
  /// \throws std::invalid_argument unless both are ≥ 0, finite, and one is not zero.
  void check() const;
};

/// Discrete elastic rods without twist. One component an inner node b of a polyline; it reads the nodes
/// before and after, too:
///   bending   E I / l · ½ (κ − κ̄)²  of the edges e and f that meet at b,
///   length    ½ E A / |ē| (|e| − |ē|)²  of e, and likewise of f.
/// l is half the sum of the rest lengths. κ = |κb| = 2 tan(φ / 2), φ the angle by which the
/// polyline turns at b and κb = 2 e × f / (|e| |f| + e · f) its curvature binormal. An edge between two inner
/// nodes gives half of its length term to either one, an end edge all of it to its only one: each edge counts
/// once.
///
/// Current lengths in κb, where Bergou et al. have rest lengths, keep stretching out of it: they agree for
/// rods that hardly stretch. The energy grows without bound as an edge folds back onto the one before, and
/// is undefined there.
///
/// Polylines are straight at rest (turns below 10⁻⁶ rad count as none) or bent. Nothing resists twist, so a
/// rod that is bent at rest may turn about itself: only changes of φ cost energy, and leaving its plane is
/// free to first order. Something else has to hold it there, such as a solid it runs through. Straight rods
/// bend alike in all directions.
/// \see Bergou, Wardetzky, Robinson, Audoly, Grinspun 2008, "Discrete Elastic Rods", Sec. 4.2.
class ElasticRod {
 public:
  static constexpr int stencil_size = 3;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 9;
  static constexpr bool translation_invariant = true;

  /// One inner node b: a function of the displacements of a, b, c.
  template <typename Real>
  struct Term {
    std::array<Real, 6> rest;         ///< b − a, c − b at rest [m]
    std::array<Real, 3> rest_cross;   ///< their cross product [m²]
    std::array<Real, 2> rest_length;  ///< [m]
    std::array<Real, 2> spring;       ///< k with ½ k (|e| − |ē|)², the share of this component [N/m]
    Real rest_bend;                   ///< κ̄
    Real bending;                     ///< k with ½ k (κ − κ̄)² [J]

    Real energy(const Local<9, Real>& u) const {
      const Shape s(*this, u);
      const Real change = s.bend - rest_bend, e = s.e.stretch(rest_length[0]), f = s.f.stretch(rest_length[1]);
      return Real(0.5) * (bending * change * change + spring[0] * e * e + spring[1] * f * f);
    }

    Local<9, Real> force(const Local<9, Real>& u) const {
      const Shape s(*this, u);
      const Real slope = bending_slope(s);
      const Real tension_e = spring[0] * s.e.stretch(rest_length[0]);
      const Real tension_f = spring[1] * s.f.stretch(rest_length[1]);
      Local<9, Real> result;
      for (int i = 0; i < 3; ++i) {
        const Real on_e = tension_e * s.e.unit[i] + slope * s.cos_by_e[i];
        const Real on_f = tension_f * s.f.unit[i] + slope * s.cos_by_f[i];
        result[i] = -on_e;
        result[3 + i] = on_e - on_f;
        result[6 + i] = on_f;
      }
      return result;
    }

    LocalMatrix<9, Real> stiffness(const Local<9, Real>& u) const;

    /// κ = 2 tan(φ / 2).
    Real bend(const Local<9, Real>& u) const { return Shape(*this, u).bend; }

   private:
    using Vec = Vector3<Real>;

    /// The two edges and their angle as they are now. Small angles keep their digits: e × f comes from
    /// displacements.
    struct Shape {
      detail::Segment<Real> e, f;
      Real cos, bend;          // cos φ = t · r of the unit edges t and r; κ
      Vec cos_by_e, cos_by_f;  // ∂ cos φ / ∂e = (r − cos φ t) / |e| = (t × r) × t / |e|, ∂ cos φ / ∂f = r ×
                               // (t × r) / |f|

      Shape(const Term& term, const Local<9, Real>& u)
          : e(term.rest.data(), u.data(), u.data() + 3), f(term.rest.data() + 3, u.data() + 3, u.data() + 6) {
        const Vec rest_e(term.rest[0], term.rest[1], term.rest[2]);
        const Vec change = detail::cross(e.change, f.now) + detail::cross(rest_e, f.change);
        const Real scale = e.inverse * f.inverse;
        Vec sine;  // t × r
        for (int i = 0; i < 3; ++i) sine[i] = (term.rest_cross[i] + change[i]) * scale;
        cos = detail::dot(e.unit, f.unit);
        bend = Real(2) * detail::norm(sine) / (Real(1) + cos);
        cos_by_e = detail::cross(sine, e.unit) * e.inverse;
        cos_by_f = detail::cross(f.unit, sine) * f.inverse;
      }
    };

    /// κ̄ / κ; 0 for a polyline that is straight at rest.
    Real rest_share(const Shape& s) const { return where_positive(s.bend, rest_bend / s.bend, Real(0)); }
    /// Derivative of the bending energy by cos φ: with κ² = 4 (1 − cos φ) / (1 + cos φ), ½ k (κ²)' (1 − κ̄ /
    /// κ).
    Real bending_slope(const Shape& s) const {
      const Real width = Real(1) + s.cos;
      return Real(-4) * bending * (Real(1) - rest_share(s)) / (width * width);
    }
  };

  /// \param polylines  the nodes of each rod in turn, three or more; first and last the same if it is closed.
  /// Rods may share nodes, where they are hinged.  \param materials  one for all rods, or one each. \throws
  /// std::invalid_argument as RodMaterial::check, on another number of materials, for a polyline of fewer
  /// than three nodes, a node that does not exist, an edge without length, and edges that fold back at rest.
  ElasticRod(const Points& nodes, const std::vector<std::vector<Index>>& polylines,
             const std::vector<RodMaterial>& materials);
  ElasticRod(const Points& nodes, const std::vector<std::vector<Index>>& polylines, const RodMaterial& material)
      : ElasticRod(nodes, polylines, std::vector<RodMaterial>{material}) {}

  Index num_nodes() const { return rest_positions_.rows(); }
  const Points& rest_positions() const { return rest_positions_; }  ///< n × 3 [m]
  Index num_components() const { return static_cast<Index>(terms_.size()); }
  std::span<const Index, 3> stencil(Index i) const { return stencils_[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  double energy(Index i, const Local<9>& u_i) const { return terms_[i].energy(u_i); }
  Local<9> force(Index i, const Local<9>& u_i) const { return terms_[i].force(u_i); }
  LocalMatrix<9> stiffness(Index i, const Local<9>& u_i) const { return terms_[i].stiffness(u_i); }

 private:
  void add_polyline(const std::vector<Index>& polyline, const RodMaterial& material, const std::string& name);
  void add_bend(const std::array<Index, 3>& nodes, const RodMaterial& material, const std::array<double, 2>& shares,
                const std::string& name);

  Points rest_positions_;
  std::vector<std::array<Index, 3>> stencils_;
  std::vector<Term<double>> terms_;
};

/// With c = cos φ, e and f the edges, W(c) the bending energy: W'' ∇c ∇cᵀ + W' ∇²c, where
///   ∂²c/∂e² = −(g tᵀ + t gᵀ + c (I − t tᵀ) / |e|) / |e|,  g = ∂c/∂e (and likewise f),
///   ∂²c/∂e∂f = (I − t tᵀ − r rᵀ + c t rᵀ) / (|e| |f|).
template <typename Real>
LocalMatrix<9, Real> ElasticRod::Term<Real>::stiffness(const Local<9, Real>& u) const {
  const Shape s(*this, u);
  const Vec &t = s.e.unit, &r = s.f.unit;
  const Real width = Real(1) + s.cos, first = bending_slope(s), share = rest_share(s);
  // ½ k [(κ²)'' (1 − κ̄/κ) + (κ²)'² κ̄ / (2 κ³)], (κ²)' = −8 / width², (κ²)'' = 16 / width³
  const Real inverse = Real(1) / width;
  const Real square = where_positive(s.bend, Real(1) / (s.bend * s.bend), Real(0));
  const Real second =
      Real(8) * bending * inverse * inverse * inverse * (Real(1) - share + Real(2) * share * square * inverse);
  Matrix3<Real> ee, ef, ff;
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      const Real tt = t[i] * t[j], rr = r[i] * r[j], one(i == j ? 1 : 0);
      const Real bend_e = s.cos_by_e[i] * t[j] + t[i] * s.cos_by_e[j] + s.cos * (one - tt) * s.e.inverse;
      const Real bend_f = s.cos_by_f[i] * r[j] + r[i] * s.cos_by_f[j] + s.cos * (one - rr) * s.f.inverse;
      ee(i, j) = second * s.cos_by_e[i] * s.cos_by_e[j] - first * bend_e * s.e.inverse +
                 s.e.spring_tangent(spring[0], rest_length[0], i, j);
      ff(i, j) = second * s.cos_by_f[i] * s.cos_by_f[j] - first * bend_f * s.f.inverse +
                 s.f.spring_tangent(spring[1], rest_length[1], i, j);
      ef(i, j) = second * s.cos_by_e[i] * s.cos_by_f[j] +
                 first * (one - tt - rr + s.cos * t[i] * r[j]) * s.e.inverse * s.f.inverse;
    }
  LocalMatrix<9, Real> K;  // e = b − a, f = c − b
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 3; ++i) {
      K(i, j) = ee(i, j);
      K(i, 3 + j) = K(3 + j, i) = ef(i, j) - ee(i, j);
      K(i, 6 + j) = K(6 + j, i) = -ef(i, j);
      K(3 + i, 3 + j) = ee(i, j) - ef(i, j) - ef(j, i) + ff(i, j);
      K(3 + i, 6 + j) = K(6 + j, 3 + i) = ef(i, j) - ff(i, j);
      K(6 + i, 6 + j) = ff(i, j);
    }
  return K;
}

static_assert(PackableForceModel<ElasticRod>);

}  // namespace supple
