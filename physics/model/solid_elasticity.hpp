#pragma once
/// \file Elastic solids of isoparametric elements.

#include <core/check.hpp>
#include <physics/material/explain_material.hpp>
#include <physics/material/material_response.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/mesh/elements.hpp>
#include <physics/model/solid_component.hpp>
#include <physics/model/term_pack.hpp>

#include <algorithm>
#include <array>
#include <vector>

namespace supple {

/// A hyperelastic solid of isoparametric elements: E = Σ_e Σ_g w_g det J_g ψ(F_g), F = I + Σₐ uₐ ⊗ ∇Nₐ at the
/// Gauss points. Component e is cell e of the mesh, or component e · P + g Gauss point g of the P points of
/// cell e. `Material` is a class template over the scalar type (see materials.hpp), `Element` one of
/// elements.hpp or your own.
template <SolidElement ElementType, template <typename> class Material,
          SolidComponent component = SolidComponent::Element>
class SolidElasticity {
  static_assert(explain_material<Material>());

 public:
  using Element = ElementType;
  static constexpr int stencil_size = Element::num_nodes;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 3 * stencil_size;
  static constexpr bool translation_invariant = true;

  static constexpr int points_per_cell = static_cast<int>(Element::gauss_points.size());
  static constexpr int components_per_cell = component == SolidComponent::Element ? 1 : points_per_cell;
  static constexpr int num_points = points_per_cell / components_per_cell;  ///< of a component

  /// One component: a function of the displacements of its nodes. Node 0 is left out, for Σₐ ∇Nₐ = 0.
  template <typename Real>
  struct Term {
    static constexpr int rest_nodes = stencil_size - 1;
    static constexpr int rest_dofs = 3 * rest_nodes;
    using Gradients = Eigen::Matrix<Real, rest_nodes, 3>;

    std::array<std::array<Real, rest_dofs>, num_points> gradients;  ///< of N₁ … at rest, J-th derivatives in turn [1/m]
    std::array<Real, num_points> volume;                            ///< w_g det J_g at rest [m³]
    Material<Real> material;

    Real energy(const Local<local_dofs, Real>& u) const {
      const Edges d(edges(u));
      Real sum(0);
      for (int g = 0; g < num_points; ++g) sum += volume[g] * material.energy(gradient(d, g));
      return sum;
    }

    Local<local_dofs, Real> force(const Local<local_dofs, Real>& u) const {
      const Edges d(edges(u));
      Local<local_dofs, Real> f;
      f.setZero();
      for (int g = 0; g < num_points; ++g) {
        const Matrix3<Real> P = stress(material, gradient(d, g)) * volume[g];
        const auto G = gradients_at(g);
        for (int a = 0; a < rest_nodes; ++a)
          for (int i = 0; i < 3; ++i) add(f[3 + 3 * a + i], P(i, 0) * G(a, 0) + P(i, 1) * G(a, 1) + P(i, 2) * G(a, 2));
      }
      for (int a = 1; a < stencil_size; ++a)
        for (int i = 0; i < 3; ++i) f[i] -= f[3 * a + i];
      return f;
    }

    LocalMatrix<local_dofs, Real> stiffness(const Local<local_dofs, Real>& u) const {
      const Edges d(edges(u));
      LocalMatrix<local_dofs, Real> K;
      if constexpr (num_points > 1) K.setZero();
      for (int g = 0; g < num_points; ++g) add_stiffness(tangent(material, gradient(d, g)), g, K);
      complete(K);
      return K;
    }

    /// The smallest det F of the Gauss points: current over rest volume; ≤ 0 where the cell is inverted.
    Real jacobian(const Local<local_dofs, Real>& u) const {
      using std::min;
      const Edges d(edges(u));
      Real smallest = determinant(gradient(d, 0));
      for (int g = 1; g < num_points; ++g) smallest = min(smallest, determinant(gradient(d, g)));
      return smallest;
    }

    /// F at Gauss point g of the component, given the displacements u of its nodes.
    Matrix3<Real> gradient(const Local<local_dofs, Real>& u, int g = 0) const { return gradient(edges(u), g); }

   private:
    using Edges = Eigen::Matrix<Real, 3, rest_nodes>;

    /// Displacements relative to node 0.
    static Edges edges(const Local<local_dofs, Real>& u) {
      Edges d;
      for (int a = 0; a < rest_nodes; ++a)
        for (int i = 0; i < 3; ++i) d(i, a) = u[3 + 3 * a + i] - u[i];
      return d;
    }
    Eigen::Map<const Gradients> gradients_at(int g) const { return Eigen::Map<const Gradients>(gradients[g].data()); }
    Matrix3<Real> gradient(const Edges& d, int g) const {
      const auto G = gradients_at(g);
      Matrix3<Real> F;
      for (int J = 0; J < 3; ++J)
        for (int i = 0; i < 3; ++i) {
          Real sum = d(i, 0) * G(0, J);
          for (int a = 1; a < rest_nodes; ++a) sum += d(i, a) * G(a, J);
          F(i, J) = i == J ? sum + Real(1) : sum;
        }
      return F;
    }

    /// A single Gauss point sets what several add up.
    static void add(Real& sum, const Real& value) {
      if constexpr (num_points == 1)
        sum = value;
      else
        sum += value;
    }

    /// The blocks of nodes a ≤ b, a ≥ 1, of Σ_JL V ∇N_aJ C_iJkL ∇N_bL.
    void add_stiffness(const Matrix9<Real>& C, int g, LocalMatrix<local_dofs, Real>& K) const {
      const auto G = gradients_at(g);
      for (int b = 0; b < rest_nodes; ++b) {
        const Vector3<Real> G_b{G(b, 0) * volume[g], G(b, 1) * volume[g], G(b, 2) * volume[g]};
        for (int k = 0; k < 3; ++k) {
          Local<9, Real> half;  // Σ_L C_iJkL V ∇N_bL over iJ
          for (int iJ = 0; iJ < 9; ++iJ) half[iJ] = C(iJ, k) * G_b[0] + C(iJ, k + 3) * G_b[1] + C(iJ, k + 6) * G_b[2];
          for (int a = 0; a <= b; ++a)
            for (int i = 0; i < 3; ++i)
              add(K(3 + 3 * a + i, 3 + 3 * b + k), G(a, 0) * half[i] + G(a, 1) * half[i + 3] + G(a, 2) * half[i + 6]);
        }
      }
    }

    /// The other half by symmetry, and node 0, which balances the others.
    static void complete(LocalMatrix<local_dofs, Real>& K) {
      for (int b = 0; b < rest_nodes; ++b)
        for (int k = 0; k < 3; ++k)
          for (int row = 3 + 3 * (b + 1); row < local_dofs; ++row) K(row, 3 + 3 * b + k) = K(3 + 3 * b + k, row);
      for (int column = 3; column < local_dofs; ++column)
        for (int i = 0; i < 3; ++i) {
          Real sum = K(3 + i, column);
          for (int a = 2; a < stencil_size; ++a) sum += K(3 * a + i, column);
          K(i, column) = -sum;
          K(column, i) = -sum;
        }
      for (int k = 0; k < 3; ++k)
        for (int i = 0; i < 3; ++i) {
          Real sum = K(i, 3 + k);
          for (int a = 2; a < stencil_size; ++a) sum += K(i, 3 * a + k);
          K(i, k) = -sum;
        }
    }
  };

  /// \param materials  one for all cells, or one a cell. \throws std::invalid_argument on another number of
  /// materials, a node that does not exist or occurs twice in a cell, and where det J ≤ 0 at a Gauss point.
  SolidElasticity(const CellMesh<stencil_size>& mesh, const std::vector<Material<double>>& materials)
      : SolidElasticity(mesh.nodes, mesh.cells, materials) {}
  SolidElasticity(const CellMesh<stencil_size>& mesh, const Material<double>& material)
      : SolidElasticity(mesh, std::vector<Material<double>>{material}) {}

  Index num_nodes() const { return rest_positions_.rows(); }
  const Points& rest_positions() const { return rest_positions_; }  ///< n × 3 [m]
  Index num_components() const { return static_cast<Index>(terms_.size()); }
  std::span<const Index, stencil_size> stencil(Index i) const { return cells_[i / components_per_cell]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  double energy(Index i, const Local<local_dofs>& u_i) const { return terms_[i].energy(u_i); }
  Local<local_dofs> force(Index i, const Local<local_dofs>& u_i) const { return terms_[i].force(u_i); }
  LocalMatrix<local_dofs> stiffness(Index i, const Local<local_dofs>& u_i) const { return terms_[i].stiffness(u_i); }

 private:
  using Cells = std::vector<std::array<Index, stencil_size>>;

  SolidElasticity(const Points& nodes, const Cells& cells, const std::vector<Material<double>>& materials)
      : rest_positions_(nodes), cells_(cells) {
    const Index count = static_cast<Index>(cells.size());
    require(materials.size() == 1 || static_cast<Index>(materials.size()) == count,
            std::to_string(materials.size()) + " materials for " + std::to_string(count) +
                " cells, expected one for all or one each");
    terms_.reserve(count * components_per_cell);
    for (Index e = 0; e < count; ++e) {
      const auto points = cell_points<Element>(cell_positions<Element>(nodes, cells, e), e, Element::gauss_points);
      for (int first = 0; first < points_per_cell; first += num_points) {
        Term<double>& term = terms_.emplace_back(Term<double>{{}, {}, materials[materials.size() == 1 ? 0 : e]});
        for (int g = 0; g < num_points; ++g) {
          const CellPoint<Element>& point = points[first + g];
          Eigen::Map<typename Term<double>::Gradients>(term.gradients[g].data()) =
              point.gradients.template bottomRows<stencil_size - 1>();
          term.volume[g] = Element::gauss_points[first + g].weight * point.det_J;
        }
      }
    }
  }

  Points rest_positions_;
  Cells cells_;
  std::vector<Term<double>> terms_;
};

/// A solid whose components are single Gauss points.
template <SolidElement Element, template <typename> class Material>
using GaussPointElasticity = SolidElasticity<Element, Material, SolidComponent::GaussPoint>;

static_assert(PackableForceModel<SolidElasticity<QuadraticTet, StVenantKirchhoff>>);
static_assert(PackableForceModel<GaussPointElasticity<TrilinearHex, MooneyRivlin>>);

}  // namespace supple
