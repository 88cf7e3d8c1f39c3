// compiles: what the wrong ones beside it are wrong about, right
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/subspace/explain_subspace_builder.hpp>
#include <sparse/selection/explain_subset_selector.hpp>

using namespace supple;

template <typename Real>
struct Tissue {
  Real mu;
  Real energy(const Matrix3<Real>& F) const { return mu * F.squaredNorm(); }
};
struct FirstColumns {
  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const;
};
struct RandomBasis {
  DenseBasis operator()(const RestState& object) const;
};
static_assert(explain_material<Tissue>());
static_assert(explain_force_model<TetElasticity<Tissue>>());
static_assert(explain_subset_selector<FirstColumns>());
static_assert(explain_subspace_builder<RandomBasis>());
