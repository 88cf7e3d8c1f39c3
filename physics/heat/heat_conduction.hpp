#pragma once
/// \file Nonlinear heat conduction in linear tetrahedra: one unknown a node, no potential.

#include <core/check.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/model/term_pack.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace supple {

/// A conductivity is an aggregate of its parameters over a scalar type Real (a number, a pack of numbers) with k(θ) >
/// 0 [W/(m K)] of the temperature θ above a reference [K], and its derivative.
template <typename Conductivity, typename Real>
concept ConductivityOver = requires(const Conductivity& k, const Real& theta) {
  { k.value(theta) } -> std::convertible_to<Real>;
  { k.derivative(theta) } -> std::convertible_to<Real>;
};

/// k(θ) = k₀ (1 + β θ), but never below a floor: what keeps heat from flowing towards the warmer side.
template <typename Real>
struct LinearConductivity {
  Real k0;     ///< at the reference temperature [W/(m K)]
  Real beta;   ///< relative change [1/K]
  Real floor;  ///< [W/(m K)]

  /// \param floor_share  the floor, as a share of k₀ in (0, 1]. \throws std::invalid_argument for another share,
  /// k₀ ≤ 0 or β that is not finite.
  static LinearConductivity from(double k0, double beta, double floor_share = 0.05) {
    require(std::isfinite(k0) && k0 > 0, "conductivity is " + std::to_string(k0) + " W/(m K), expected > 0");
    require(std::isfinite(beta), "change of the conductivity is not finite");
    require(floor_share > 0 && floor_share <= 1,
            "floor of the conductivity is " + std::to_string(floor_share) + " of it, expected (0, 1]");
    return {k0, beta, floor_share * k0};
  }

  Real value(const Real& theta) const {
    const Real above = k0 * (Real(1) + beta * theta) - floor;
    return floor + where_positive(above, above, Real(0));
  }
  Real derivative(const Real& theta) const {
    return where_positive(k0 * (Real(1) + beta * theta) - floor, k0 * beta, Real(0));
  }
};

/// k(θ) = k₀ exp(β θ): positive and smooth everywhere.
template <typename Real>
struct ExponentialConductivity {
  Real k0;    ///< at the reference temperature [W/(m K)]
  Real beta;  ///< relative change [1/K]

  /// \throws std::invalid_argument for k₀ ≤ 0 or β that is not finite.
  static ExponentialConductivity from(double k0, double beta) {
    require(std::isfinite(k0) && k0 > 0, "conductivity is " + std::to_string(k0) + " W/(m K), expected > 0");
    require(std::isfinite(beta), "change of the conductivity is not finite");
    return {k0, beta};
  }

  Real value(const Real& theta) const {
    using std::exp;
    return k0 * exp(beta * theta);
  }
  Real derivative(const Real& theta) const { return beta * value(theta); }
};

/// Steady heat flow out of nodes, f_a = ∫ k(θ) ∇θ·∇N_a [W], with ∇θ constant in a tet and k taken at the mean of its
/// four temperatures (exact for a linear k). So C θ̇ + f(θ) = q for capacities C [J/K] and heat flows q into nodes
/// [W]; nodes at the reference temperature are fixed ones. One component a tet, in order of the mesh. Where k varies,
/// f has no potential and its tangent ∂f_a/∂θ_b = V (k ∇N_a·∇N_b + ¼ k' ∇N_a·∇θ) is not symmetric.
template <template <typename> class Conductivity>
class HeatConduction {
 public:
  static constexpr int stencil_size = 4;
  static constexpr int node_dim = 1;
  static constexpr int local_dofs = 4;
  static constexpr bool symmetric_tangent = false;

  /// One tet: a function of the temperatures of its four corners.
  template <typename Real>
  struct Term {
    std::array<Real, 9> inverse_edges;  ///< as TetShape has them, by columns [1/m]; row a is ∇Nₐ₊₁
    Real volume;                        ///< [m³]
    Conductivity<Real> conductivity;

    Local<4, Real> force(const Local<4, Real>& theta) const {
      const Vector3<Real> flow = gradient(theta) * (volume * conductivity.value(mean(theta)));
      return against_gradients(flow);
    }

    LocalMatrix<4, Real> stiffness(const Local<4, Real>& theta) const {
      const Real mean_theta = mean(theta);
      const Real kV = volume * conductivity.value(mean_theta);
      const Local<4, Real> warming =
          against_gradients(gradient(theta) * (Real(0.25) * volume * conductivity.derivative(mean_theta)));
      LocalMatrix<4, Real> K;
      for (int b = 0; b < 3; ++b) K.col(b + 1) = against_gradients(gradients().row(b).transpose() * kV) + warming;
      K.col(0) = warming * Real(4) - K.col(1) - K.col(2) - K.col(3);
      return K;
    }

    /// ∇θ [K/m].
    Vector3<Real> gradient(const Local<4, Real>& theta) const {
      const Vector3<Real> differences(theta[1] - theta[0], theta[2] - theta[0], theta[3] - theta[0]);
      return gradients().transpose() * differences;
    }

   private:
    Matrix3<Real> gradients() const { return Eigen::Map<const Matrix3<Real>>(inverse_edges.data()); }
    static Real mean(const Local<4, Real>& theta) {
      return Real(0.25) * ((theta[0] + theta[1]) + (theta[2] + theta[3]));
    }
    /// ∇N_a · flow for each corner; they add up to nothing.
    Local<4, Real> against_gradients(const Vector3<Real>& flow) const {
      const Vector3<Real> others = gradients() * flow;
      return Local<4, Real>(-(others[0] + others[1] + others[2]), others[0], others[1], others[2]);
    }
  };

  /// \param conductivities  one for all tets, or one a tet. \throws std::invalid_argument on another number of them,
  /// a node that does not exist or a tet whose volume is not positive.
  HeatConduction(const TetMesh& mesh, const std::vector<Conductivity<double>>& conductivities)
      : rest_positions_(mesh.nodes), tets_(mesh.cells) {
    const bool one_for_all = conductivities.size() == 1;
    require(one_for_all || static_cast<Index>(conductivities.size()) == mesh.num_cells(),
            std::to_string(conductivities.size()) + " conductivities for " + std::to_string(mesh.num_cells()) +
                " tets, expected one for all or one each");
    terms_.reserve(tets_.size());
    for (Index e = 0; e < mesh.num_cells(); ++e) {
      const TetShape shape = tet_shape(mesh, e);
      Term<double> term{{}, shape.volume, conductivities[one_for_all ? 0 : e]};
      std::copy_n(shape.inverse_edges.data(), 9, term.inverse_edges.begin());
      terms_.push_back(term);
    }
  }
  HeatConduction(const TetMesh& mesh, const Conductivity<double>& conductivity)
      : HeatConduction(mesh, std::vector<Conductivity<double>>{conductivity}) {}

  Index num_nodes() const { return rest_positions_.rows(); }
  const Points& rest_positions() const { return rest_positions_; }  ///< n × 3 [m]
  Index num_components() const { return static_cast<Index>(tets_.size()); }
  std::span<const Index, 4> stencil(Index i) const { return tets_[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  Local<4> force(Index i, const Local<4>& theta_i) const { return terms_[i].force(theta_i); }                ///< [W]
  LocalMatrix<4> stiffness(Index i, const Local<4>& theta_i) const { return terms_[i].stiffness(theta_i); }  ///< [W/K]

 private:
  Points rest_positions_;
  std::vector<Tet> tets_;
  std::vector<Term<double>> terms_;
};

static_assert(ConductivityOver<LinearConductivity<Pack>, Pack> &&
              ConductivityOver<ExponentialConductivity<Pack>, Pack>);
static_assert(PackableForceModel<HeatConduction<LinearConductivity>> &&
              !PotentialModel<HeatConduction<LinearConductivity>>);

}  // namespace supple
