#pragma once
/// \file Heat that a surface loses by convection and radiation.

#include <physics/mesh/triangle_mesh.hpp>
#include <physics/model/term_pack.hpp>

#include <array>
#include <vector>

namespace supple {

/// What a surface gives to its surroundings. They are at the reference temperature, so nothing flows at θ = 0.
struct SurfaceExchange {
  double film = 0;          ///< convection, h [W/(m² K)]
  double emissivity = 0;    ///< radiation, ε in [0, 1]
  double ambient = 293.15;  ///< absolute reference temperature T₀ [K]
};

/// Heat flow out of the nodes of a surface [W], each triangle at the mean θ of its corners:
/// f_a = ⅓ A (h θ + ε σ ((T₀ + θ)⁴ − T₀⁴)), which has a potential [W K]. Stable for θ > −T₀. One component a
/// triangle.
class SurfaceHeatLoss {
 public:
  static constexpr int stencil_size = 3;
  static constexpr int node_dim = 1;
  static constexpr int local_dofs = 3;

  /// One triangle. With T = T₀: (T + θ)⁴ − T⁴ = θ (4 T³ + 6 T² θ + 4 T θ² + θ³), so no digits cancel.
  template <typename Real>
  struct Term {
    Real area;       ///< [m²]
    Real film;       ///< h [W/(m² K)]
    Real radiation;  ///< ε σ [W/(m² K⁴)]
    Real ambient;    ///< T₀ [K]

    Real energy(const Local<3, Real>& theta) const {
      const Real t = mean(theta), T = ambient;
      return area * t * t *
             (Real(0.5) * film + radiation * (T * T * (Real(2) * T + Real(2) * t) + t * t * (T + Real(0.2) * t)));
    }
    Local<3, Real> force(const Local<3, Real>& theta) const {
      const Real t = mean(theta), T = ambient;
      const Real flow = t * (film + radiation * (T * T * (Real(4) * T + Real(6) * t) + t * t * (Real(4) * T + t)));
      return Local<3, Real>::Constant(area * flow * Real(1.0 / 3));
    }
    LocalMatrix<3, Real> stiffness(const Local<3, Real>& theta) const {
      const Real T = ambient + mean(theta);
      return LocalMatrix<3, Real>::Constant(area * (film + Real(4) * radiation * T * T * T) * Real(1.0 / 9));
    }

   private:
    static Real mean(const Local<3, Real>& theta) { return (theta[0] + theta[1] + theta[2]) * Real(1.0 / 3); }
  };

  /// \param positions  of all nodes of the object [m].  \param triangles  e.g. its boundary_faces().
  /// \throws std::invalid_argument for a node that does not exist, a triangle without area, no exchange at all or one
  /// that is negative or not finite.
  SurfaceHeatLoss(const Points& positions, std::vector<Triangle> triangles, const SurfaceExchange& exchange);

  Index num_nodes() const { return num_nodes_; }
  Index num_components() const { return static_cast<Index>(triangles_.size()); }
  std::span<const Index, 3> stencil(Index i) const { return triangles_[i]; }
  const Term<double>& term(Index i) const { return terms_[i]; }

  double energy(Index i, const Local<3>& theta_i) const { return terms_[i].energy(theta_i); }
  Local<3> force(Index i, const Local<3>& theta_i) const { return terms_[i].force(theta_i); }
  LocalMatrix<3> stiffness(Index i, const Local<3>& theta_i) const { return terms_[i].stiffness(theta_i); }

 private:
  Index num_nodes_;
  std::vector<Triangle> triangles_;
  std::vector<Term<double>> terms_;
};

static_assert(PackableForceModel<SurfaceHeatLoss> && PotentialModel<SurfaceHeatLoss>);

}  // namespace supple
