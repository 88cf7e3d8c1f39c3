#pragma once
/// \file Elastic solids of linear tetrahedra.

#include <core/check.hpp>
#include <physics/material_response.hpp>
#include <physics/term_pack.hpp>
#include <physics/tet_mesh.hpp>

#include <array>
#include <vector>

namespace supple {

/// A hyperelastic solid of linear tetrahedra: eᵢ = Vᵢ ψ(Fᵢ), F = I + Σₐ uₐ ⊗ ∇Nₐ constant in a tet. One
/// component a tet, in order of the mesh. `Material` is a class template over the scalar type (see
/// materials.hpp).
template <template <typename> class Material>
class TetElasticity {
 public:
  static constexpr int stencil_size = 4;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 12;
  static constexpr bool translation_invariant = true;

  /// One tet: a function of the displacements of its four corners.
  template <typename Real>
  struct Term {
    std::array<Real, 9>
        inverse_edges;  ///< D⁻¹ by columns, D = [b − a, c − a, d − a] at rest [1/m]; row a is ∇Nₐ₊₁
    Real volume;  ///< at rest [m³]
    Material<Real> material;

    Real energy(const Local<12, Real>& u) const { return volume * material.energy(gradient(u)); }

    Local<12, Real> force(const Local<12, Real>& u) const {
      const Matrix3<Real> corners = stress(material, gradient(u)) * gradients().transpose() * volume;
      Local<12, Real> f;
      for (int i = 0; i < 3; ++i) {
        f[i] = -(corners(i, 0) + corners(i, 1) + corners(i, 2));
        for (int a = 0; a < 3; ++a) f[3 + 3 * a + i] = corners(i, a);
      }
      return f;
    }

    LocalMatrix<12, Real> stiffness(const Local<12, Real>& u) const {
      const Matrix9<Real> C = tangent(material, gradient(u));
      const Matrix3<Real> g = gradients();
      Matrix9<Real> half;  // Σ_L C_iJkL g_bL over (iJ, kb), times the volume
      for (int b = 0; b < 3; ++b)
        for (int k = 0; k < 3; ++k)
          half.col(k + 3 * b) =
              (C.col(k) * g(b, 0) + C.col(k + 3) * g(b, 1) + C.col(k + 6) * g(b, 2)) * volume;
      LocalMatrix<12, Real> K;
      for (int kb = 0; kb < 9; ++kb) {
        for (int a = 0; a < 3; ++a)
          for (int i = 0; i < 3; ++i)
            K(3 + 3 * a + i, 3 + kb) =
                g(a, 0) * half(i, kb) + g(a, 1) * half(i + 3, kb) + g(a, 2) * half(i + 6, kb);
        for (int i = 0; i < 3; ++i) K(i, 3 + kb) = -(K(3 + i, 3 + kb) + K(6 + i, 3 + kb) + K(9 + i, 3 + kb));
      }
      for (int k = 0; k < 3; ++k)
        for (int row = 0; row < 12; ++row) K(row, k) = -(K(row, 3 + k) + K(row, 6 + k) + K(row, 9 + k));
      return K;
    }

    /// det F: current over rest volume; ≤ 0 for an inverted tet.
    Real jacobian(const Local<12, Real>& u) const { return determinant(gradient(u)); }

    /// F at the displacements u of the corners.
    Matrix3<Real> gradient(const Local<12, Real>& u) const {
      Matrix3<Real> edges;
      for (int a = 0; a < 3; ++a)
        for (int i = 0; i < 3; ++i) edges(i, a) = u[3 + 3 * a + i] - u[i];
      Matrix3<Real> F = edges * gradients();
      for (int i = 0; i < 3; ++i) F(i, i) += Real(1);
      return F;
    }

   private:
    Matrix3<Real> gradients() const { return Eigen::Map<const Matrix3<Real>>(inverse_edges.data()); }
  };

  /// \param materials  one for all tets, or one a tet. \throws std::invalid_argument on another number of
  /// materials, a node that does not exist or a tet whose volume is not positive.
  TetElasticity(const TetMesh& mesh, const std::vector<Material<double>>& materials)
      : rest_positions_(mesh.nodes) {
    require(materials.size() == 1 || static_cast<Index>(materials.size()) == mesh.num_tets(),
            std::to_string(materials.size()) + " materials for " + std::to_string(mesh.num_tets()) +
                " tets, expected one for all or one each");
    tets_ = mesh.tets;
    terms_.reserve(tets_.size());
    for (Index e = 0; e < mesh.num_tets(); ++e) {
      const TetShape shape = tet_shape(mesh, e);
      Term<double> term{.inverse_edges = {},
                        .volume = shape.volume,
                        .material = materials.size() == 1 ? materials[0] : materials[e]};
      std::copy_n(shape.inverse_edges.data(), 9, term.inverse_edges.begin());
      terms_.push_back(term);
    }
  }
  TetElasticity(const TetMesh& mesh, const Material<double>& material)
      : TetElasticity(mesh, std::vector<Material<double>>{material}) {}

  Index num_nodes() const { return rest_positions_.rows(); }
  const Points& rest_positions() const { return rest_positions_; }  ///< n × 3 [m]
  Index num_components() const { return static_cast<Index>(tets_.size()); }
  std::span<const Index, 4> stencil(Index i) const { return tets_[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  double energy(Index i, const Local<12>& u_i) const { return terms_[i].energy(u_i); }
  Local<12> force(Index i, const Local<12>& u_i) const { return terms_[i].force(u_i); }
  LocalMatrix<12> stiffness(Index i, const Local<12>& u_i) const { return terms_[i].stiffness(u_i); }

 private:
  Points rest_positions_;
  std::vector<Tet> tets_;
  std::vector<Term<double>> terms_;
};

static_assert(PackableForceModel<TetElasticity<StVenantKirchhoff>>);
static_assert(PackableForceModel<TetElasticity<MooneyRivlin>>);

}  // namespace supple
