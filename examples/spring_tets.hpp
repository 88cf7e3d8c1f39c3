#pragma once
// An element of one's own on the nodes of tets: each tet is six springs.

#include <physics/body/material_law.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/model/spring_model.hpp>

using namespace supple;

/// Springs along the edges of tets, k = c V / L² for each tet at an edge of length L: on average over directions an
/// isotropic solid of Young's modulus c and Poisson's ratio ¼.
class SpringTets {
 public:
  static constexpr int stencil_size = 4, node_dim = 3, local_dofs = 12;
  static constexpr bool translation_invariant = true;
  static constexpr std::array<std::array<int, 2>, 6> edges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

  template <typename Real>
  struct Term {
    std::array<SpringModel::Term<Real>, 6> springs;

    Real energy(const Local<12, Real>& u) const {
      Real sum(0);
      for (int k = 0; k < 6; ++k) sum += springs[k].energy(ends(u, k));
      return sum;
    }
    Local<12, Real> force(const Local<12, Real>& u) const {
      Local<12, Real> f = Local<12, Real>::Constant(Real(0));
      for (int k = 0; k < 6; ++k) {
        const Local<6, Real> of_spring = springs[k].force(ends(u, k));
        for (int i = 0; i < 6; ++i) f[dof(k, i)] += of_spring[i];
      }
      return f;
    }
    LocalMatrix<12, Real> stiffness(const Local<12, Real>& u) const {
      LocalMatrix<12, Real> K = LocalMatrix<12, Real>::Constant(Real(0));
      for (int k = 0; k < 6; ++k) {
        const LocalMatrix<6, Real> of_spring = springs[k].stiffness(ends(u, k));
        for (int j = 0; j < 6; ++j)
          for (int i = 0; i < 6; ++i) K(dof(k, i), dof(k, j)) += of_spring(i, j);
      }
      return K;
    }

   private:
    static int dof(int spring, int i) { return 3 * edges[spring][i / 3] + i % 3; }
    static Local<6, Real> ends(const Local<12, Real>& u, int spring) {
      Local<6, Real> result;
      for (int i = 0; i < 6; ++i) result[i] = u[dof(spring, i)];
      return result;
    }
  };

  SpringTets(const TetMesh& mesh, const std::vector<double>& moduli) : mesh_(mesh) {
    for (Index e = 0; e < mesh.num_cells(); ++e) {
      const double c = moduli.size() == 1 ? moduli[0] : moduli[e], volume = tet_volume(mesh, e);
      require(volume > 0, "tet " + std::to_string(e) + " has no volume");
      Term<double> term;
      for (int k = 0; k < 6; ++k) {
        const Point edge = mesh.nodes.row(mesh.cells[e][edges[k][1]]) - mesh.nodes.row(mesh.cells[e][edges[k][0]]);
        term.springs[k] = {{edge[0], edge[1], edge[2]}, edge.norm(), c * volume / edge.squaredNorm()};
      }
      terms_.push_back(term);
    }
  }

  Index num_nodes() const { return mesh_.num_nodes(); }
  const Points& rest_positions() const { return mesh_.nodes; }
  Index num_components() const { return mesh_.num_cells(); }
  std::span<const Index, 4> stencil(Index i) const { return mesh_.cells[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }
  double energy(Index i, const Local<12>& u) const { return terms_[i].energy(u); }
  Local<12> force(Index i, const Local<12>& u) const { return terms_[i].force(u); }
  LocalMatrix<12> stiffness(Index i, const Local<12>& u) const { return terms_[i].stiffness(u); }

 private:
  TetMesh mesh_;
  std::vector<Term<double>> terms_;
};

/// What it is called, and how it follows from a mesh: a law of solids that knows tets only.
inline MaterialLaw spring_tets() {
  return {
      .name = "spring-tets",
      .parameters = {"modulus"},
      .from = [](const IsotropicModuli& moduli) { return std::vector<double>{moduli.young}; },
      .objection =
          [](const std::vector<double>& values) { return values.at(0) > 0 ? "" : "the modulus is not positive"; },
      .tets =
          [](const TetMesh& mesh, const RowMatrix& rows, const std::vector<std::int32_t>& of_tet) {
            std::vector<double> moduli(rows.data(), rows.data() + rows.rows());
            if (!of_tet.empty()) {
              moduli.clear();
              for (const std::int32_t k : of_tet) moduli.push_back(rows(k, 0));
            }
            return std::make_shared<const AnyModel<4>>(std::make_shared<const SpringTets>(mesh, moduli));
          },
  };
}
