#pragma once
/// \file Springs between nodes.

#include <core/check.hpp>
#include <physics/model/term_pack.hpp>
#include <physics/model/vector_formulas.hpp>

#include <array>
#include <vector>

namespace supple {

/// Straight springs, unstressed at rest: eᵢ = ½ kᵢ (|x_b − x_a| − Lᵢ)², L the distance of the two nodes at
/// rest. One component a spring, in the order given. A spring that has collapsed to a point pulls nowhere.
class SpringModel {
 public:
  using Ends = std::array<Index, 2>;  ///< the two nodes of a spring
  static constexpr int stencil_size = 2;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 6;
  static constexpr bool translation_invariant = true;

  /// One spring: a function of the displacements of its ends.
  template <typename Real>
  struct Term {
    std::array<Real, 3> rest;  ///< b − a at rest [m]
    Real rest_length;          ///< L [m]
    Real k;                    ///< [N/m]

    Real energy(const Local<6, Real>& u) const {
      const Real stretch = segment(u).stretch(rest_length);
      return Real(0.5) * k * stretch * stretch;
    }
    Local<6, Real> force(const Local<6, Real>& u) const {
      const detail::Segment<Real> e = segment(u);
      const Real tension = k * e.stretch(rest_length);
      Local<6, Real> f;
      for (int i = 0; i < 3; ++i) {
        f[3 + i] = tension * e.unit[i];
        f[i] = -f[3 + i];
      }
      return f;
    }
    LocalMatrix<6, Real> stiffness(const Local<6, Real>& u) const {
      const detail::Segment<Real> e = segment(u);
      LocalMatrix<6, Real> K;
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) {
          const Real entry = e.spring_tangent(k, rest_length, i, j);
          K(i, j) = K(3 + i, 3 + j) = entry;
          K(3 + i, j) = K(i, 3 + j) = -entry;
        }
      return K;
    }

   private:
    detail::Segment<Real> segment(const Local<6, Real>& u) const { return {rest.data(), u.data(), u.data() + 3}; }
  };

  /// \param stiffness  k [N/m], one for all springs or one each; > 0. \throws std::invalid_argument on
  /// another number or sign, for a node that does not exist and for a spring without length.
  SpringModel(const Points& nodes, const std::vector<Ends>& springs, VectorIn stiffness);
  SpringModel(const Points& nodes, const std::vector<Ends>& springs, double stiffness)
      : SpringModel(nodes, springs, Vector::Constant(1, stiffness)) {}

  Index num_nodes() const { return rest_positions_.rows(); }
  const Points& rest_positions() const { return rest_positions_; }  ///< n × 3 [m]
  Index num_components() const { return static_cast<Index>(terms_.size()); }
  std::span<const Index, 2> stencil(Index i) const { return springs_[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  double energy(Index i, const Local<6>& u_i) const { return terms_[i].energy(u_i); }
  Local<6> force(Index i, const Local<6>& u_i) const { return terms_[i].force(u_i); }
  LocalMatrix<6> stiffness(Index i, const Local<6>& u_i) const { return terms_[i].stiffness(u_i); }

 private:
  Points rest_positions_;
  std::vector<Ends> springs_;
  std::vector<Term<double>> terms_;
};

static_assert(PackableForceModel<SpringModel>);

}  // namespace supple
