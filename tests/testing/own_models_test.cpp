// What docs/testing.md shows: models of one's own, each put through its suite.
#include <physics/model/tet_elasticity.hpp>
#include <sparse/selectors/nn_htp.hpp>
#include <testing/force_model_conformance.hpp>
#include <testing/material_conformance.hpp>
#include <testing/subset_selector_conformance.hpp>
#include <testing/subspace_builder_conformance.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/spring_network.hpp>

namespace supple::test {

/// Gent's rubber, which stiffens without bound towards I₁ − 3 = limit.
template <typename Real>
struct Gent {
  Real mu, lambda, limit;
  static Gent from(const IsotropicModuli& m) {
    m.check();
    const double limit = 50;
    return {m.shear(), m.lame() - 2 * m.shear() / limit, limit};
  }
  Real energy(const Matrix3<Real>& F) const {
    using std::log;
    const Real log_J = log(determinant(F)), I1 = F.squaredNorm();
    return Real(-0.5) * mu * limit * log(Real(1) - (I1 - Real(3)) / limit) - mu * log_J +
           Real(0.5) * lambda * log_J * log_J;
  }
};
static_assert(explain_material<Gent>());
INSTANTIATE_TYPED_TEST_SUITE_P(Gent, MaterialConformance, FromModuli<Gent>);

struct Springs {
  static SpringNetwork make() { return edge_springs(kuhn_box(1, 1, 1, length), 200.0); }
  static constexpr double length = 0.1;
};
INSTANTIATE_TYPED_TEST_SUITE_P(Springs, ForceModelConformance, Springs);

struct CarefulHtp : NnHtp {
  CarefulHtp() : NnHtp{.candidates_per_size = 8} {}
};
static_assert(explain_subset_selector<CarefulHtp>());
INSTANTIATE_TYPED_TEST_SUITE_P(CarefulHtp, SubsetSelectorConformance, CarefulHtp);

/// Random displacements of the free nodes: a subspace to compare others with.
struct RandomBasis {
  Index dimension = 6;
  DenseBasis operator()(const RestState& object) const {
    const Index axes = object.node_dim;
    RowMatrix W = random_matrix(object.numbering.num_nodes() * axes, dimension, 1, 1);
    for (const Index v : object.numbering.fixed_nodes()) W.middleRows(v * axes, axes).setZero();
    return {mass_orthonormalize(W, object.mass_of_rows()).W, {}};
  }
};
struct RandomBasisOfABar {
  static StvkBar make() { return clamped_bar(); }
  static RandomBasis builder() { return {.dimension = 4}; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(RandomBasis, SubspaceBuilderConformance, RandomBasisOfABar);

}  // namespace supple::test
