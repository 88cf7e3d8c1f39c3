#pragma once
/// \file Two force models as small as they get: no packs, no template over the scalar type.

#include <core/check.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/model/force_model.hpp>

#include <array>
#include <set>
#include <vector>

namespace supple::test {

/// Straight springs between pairs of nodes: eᵢ = ½ k (‖x_b − x_a‖ − Lᵢ)², unstressed at rest. The library's SpringModel
/// comes in packs; this one shows that models need not, and is a second formula to hold that one against.
class SpringNetwork {
 public:
  static constexpr int stencil_size = 2;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 6;
  static constexpr bool translation_invariant = true;

  SpringNetwork(const Points& nodes, std::vector<std::array<Index, 2>> springs, double stiffness)
      : nodes_(nodes), springs_(std::move(springs)), stiffness_(stiffness) {}

  Index num_nodes() const { return nodes_.rows(); }
  Index num_components() const { return static_cast<Index>(springs_.size()); }
  std::span<const Index, 2> stencil(Index i) const { return springs_[i]; }

  double energy(Index i, const Local<6>& u) const {
    const double stretch = edge(i, u).norm() - rest_edge(i).norm();
    return 0.5 * stiffness_ * stretch * stretch;
  }
  Local<6> force(Index i, const Local<6>& u) const {
    const Point d = edge(i, u);
    const Point f_b = stiffness_ * (1 - rest_edge(i).norm() / d.norm()) * d;
    Local<6> f;
    f << -f_b, f_b;
    return f;
  }
  LocalMatrix<6> stiffness(Index i, const Local<6>& u) const {
    const Point d = edge(i, u);
    const double ratio = rest_edge(i).norm() / d.norm();
    const Matrix3<double> along = d * d.transpose() / d.squaredNorm();
    const Matrix3<double> K_bb = stiffness_ * ((1 - ratio) * Matrix3<double>::Identity() + ratio * along);
    LocalMatrix<6> K;
    K << K_bb, -K_bb, -K_bb, K_bb;
    return K;
  }

 private:
  Point rest_edge(Index i) const { return nodes_.row(springs_[i][1]) - nodes_.row(springs_[i][0]); }
  Point edge(Index i, const Local<6>& u) const { return rest_edge(i) + u.tail<3>() - u.head<3>(); }

  Points nodes_;
  std::vector<std::array<Index, 2>> springs_;
  double stiffness_;
};
static_assert(ForceModel<SpringNetwork>);

/// The edges of a mesh, each once.
inline std::vector<std::array<Index, 2>> mesh_edges(const TetMesh& mesh) {
  std::set<std::array<Index, 2>> edges;
  for (const Tet& tet : mesh.cells)
    for (int a = 0; a < 4; ++a)
      for (int b = 0; b < a; ++b) edges.insert({std::min(tet[a], tet[b]), std::max(tet[a], tet[b])});
  return {edges.begin(), edges.end()};
}

/// A spring at each edge of a mesh.
inline SpringNetwork edge_springs(const TetMesh& mesh, double stiffness) {
  return {mesh.nodes, mesh_edges(mesh), stiffness};
}

/// Independent nodes, each held by eᵢ = ½ k |u|² + ¼ c |u|⁴ (c = 0: a harmonic oscillator). Not translation
/// invariant.
class DuffingOscillators {
 public:
  static constexpr int stencil_size = 1;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 3;

  DuffingOscillators(Index count, double k, double c) : nodes_(count), k_(k), c_(c) {
    for (Index i = 0; i < count; ++i) nodes_[i] = i;
  }

  Index num_nodes() const { return num_components(); }
  Index num_components() const { return static_cast<Index>(nodes_.size()); }
  std::span<const Index, 1> stencil(Index i) const { return std::span<const Index, 1>(&nodes_[i], 1); }

  double energy(Index, const Local<3>& u) const {
    const double s = u.squaredNorm();
    return 0.5 * k_ * s + 0.25 * c_ * s * s;
  }
  Local<3> force(Index, const Local<3>& u) const { return (k_ + c_ * u.squaredNorm()) * u; }
  LocalMatrix<3> stiffness(Index, const Local<3>& u) const {
    return (k_ + c_ * u.squaredNorm()) * LocalMatrix<3>::Identity() + 2 * c_ * u * u.transpose();
  }

 private:
  std::vector<Index> nodes_;
  double k_, c_;
};
static_assert(ForceModel<DuffingOscillators>);

}  // namespace supple::test
