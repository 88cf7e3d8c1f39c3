#include <reduction/basis/modal_basis.hpp>
#include <reduction/pipeline/training.hpp>
#include <reduction/system/reduced_system.hpp>
#include <reduction/training/equilibrium_fitting.hpp>
#include <reduction/training/training_poses.hpp>
#include <sparse/selectors/nn_sp.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

using System = ReducedSystem<TetElasticity<StVenantKirchhoff>, NodalBasis>;
using Fitting = EquilibriumFitting<TetElasticity<StVenantKirchhoff>, NodalBasis>;

/// A bar, bent by some random loads; its reduced system has all components.
struct EquilibriumFittingTest : testing::Test {
  EquilibriumFittingTest() : EquilibriumFittingTest(clamped_bar(), 3) {}
  EquilibriumFittingTest(StvkBar bar, Index num_modes)
      : system(std::move(bar)),
        basis(std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = num_modes}(system))),
        stiffness(project_stiffness(*basis, system)),
        modes(reduced_modes(stiffness)),
        reduced(with(Vector::Ones(system.model().num_components()))),
        linear(linear_responses(0.1)) {}

  System with(const Vector& w) const {
    return {system.shared_model(), basis, all_components(w.size()), w, stiffness, system.nodal_mass()};
  }
  Matrix linear_responses(double amplitude, Index count = 6) const {
    return sample_poses(system.shared_model(), *basis, modes, system.nodal_mass().sum(), 1.0,
                        {.count = count, .amplitudes = {amplitude}})
        .Q;
  }
  Fitting fitting(const Matrix& Q, Index rank, double scale = 1, const Matrix& targets = {}) const {
    return {system.shared_model(),     basis, Q,    targets, [&](VectorIn q) { return reduced.stiffness(q); },
            modes.softest_stiffness(), rank,  scale};
  }

  /// Root mean square over the poses of how far their equilibria move in another system, relative.
  double moved(const System& wrong, const Matrix& Q) const {
    double sum = 0;
    for (Index t = 0; t < Q.cols(); ++t) {
      Vector q = Q.col(t);
      StaticSolver solver(wrong, {.tolerance = 1e-12});
      EXPECT_LE(solver.solve({reduced.force(Q.col(t)), {}}, q).residual, 1e-9);
      sum += (q - Q.col(t)).squaredNorm() / Q.col(t).squaredNorm();
    }
    return std::sqrt(sum / static_cast<double>(Q.cols()));
  }

  const StvkBar system;
  const std::shared_ptr<const NodalBasis> basis;
  const Matrix stiffness;
  const ReducedModes modes;
  const System reduced;
  const Matrix linear;  // responses
};

TEST_F(EquilibriumFittingTest, PosesAreInEquilibriumUnderTheirLoads) {
  const Matrix Q = equilibrium_poses(reduced, modes, linear);
  for (Index t = 0; t < Q.cols(); ++t) {
    const Vector load = stiffness * linear.col(t);
    EXPECT_LT((reduced.force(Q.col(t)) - load).norm(), 1e-4 * load.norm());
    EXPECT_GT((Q.col(t) - linear.col(t)).norm(), 0.02 * Q.col(t).norm()) << "the bend is to be nonlinear";
  }
}

// Forces of another object, such as the relaxed one: what the rows ask of the components, and measure them by.
TEST_F(EquilibriumFittingTest, AreFittedToTheTargets) {
  const Matrix Q = equilibrium_poses(reduced, modes, linear);
  const Index m = system.model().num_components();
  const Vector w = Vector::Ones(m) + 0.1 * random_vector(m, 1, 5).cwiseAbs();
  const System other = with(w);
  Matrix targets(Q.rows(), Q.cols());
  for (Index t = 0; t < Q.cols(); ++t) targets.col(t) = other.force(Q.col(t));
  const Fitting fitted = fitting(Q, basis->dim(), 1, targets);
  EXPECT_LT(fitted.error(all_components(m), w), 1e-10);
  EXPECT_GT(fitted.error(all_components(m), Vector::Ones(m)), 0.01);
  const std::vector<Index> some{1, 4};
  EXPECT_LT(fitted.restricted_to(some).error(all_components(m), w), 1e-10);
  EXPECT_LT(fitted.with_tangents_of(other).error(all_components(m), w), 1e-10);
  EXPECT_THROW(fitting(Q, basis->dim(), 1, targets.leftCols(2)), std::invalid_argument);
}

// What the rows promise: a small error of the forces moves the equilibrium by as much as they say.
TEST_F(EquilibriumFittingTest, ErrorsAreDisplacementsOfTheEquilibrium) {
  const Matrix Q = equilibrium_poses(reduced, modes, linear);
  const Index m = system.model().num_components();
  const Vector w = Vector::Ones(m) + 1e-4 * random_vector(m, 1, 5);
  const double moved = this->moved(with(w), Q);
  EXPECT_GT(moved, 1e-6);
  EXPECT_NEAR(fitting(Q, basis->dim()).error(all_components(m), w), moved, 2e-3 * moved);
  EXPECT_NEAR(fitting(Q, basis->dim(), 7).error(all_components(m), w), moved, 2e-3 * moved);  // whatever the scale
  EXPECT_LE(fitting(Q, 8).error(all_components(m), w), moved * 1.002);  // along some directions only
  EXPECT_GT(fitting(Q, 8).error(all_components(m), w), 0.5 * moved);    // the softest tell nearly all
}

// Large errors of the forces make an object softer or stiffer, too: its own tangents tell how far it moves.
TEST_F(EquilibriumFittingTest, OwnTangentsTellOfLargeErrors) {
  const Matrix Q = equilibrium_poses(reduced, modes, linear);
  const Index m = system.model().num_components();
  const Vector w = Vector::Constant(m, 0.8) + 0.3 * random_vector(m, 1, 5);
  const System wrong = with(w);
  const double moved = this->moved(wrong, Q);
  const Fitting exact = fitting(Q, basis->dim(), 2), own = exact.with_tangents_of(wrong, 10);
  EXPECT_GT(moved, 0.05);
  EXPECT_LT(std::abs(own.error(all_components(m), w) - moved),
            0.5 * std::abs(exact.error(all_components(m), w) - moved));
  const auto rows = [](const Fitting& f) -> Matrix { return f.columns(all_components(10)).values(); };
  EXPECT_FALSE(is_near(rows(own), rows(exact), 1e-3 * rows(exact).norm()));
  EXPECT_TRUE(is_same(rows(exact.with_tangents_of(wrong, 0)), rows(exact)));  // nothing trusted, nothing changed
}

TEST_F(EquilibriumFittingTest, RefittedWeightsBringEquilibriaNearer) {
  const Matrix Q = equilibrium_poses(reduced, modes, linear);
  using Model = TetElasticity<StVenantKirchhoff>;
  Training<Model, NodalBasis> training{
      .object = {.system = std::shared_ptr<const StvkBar>(std::shared_ptr<void>(), &system),
                 .subspace = basis,
                 .traits = {},
                 .rest_stiffness = stiffness,
                 .modes = modes},
      .poses = {},
      .fitting = {system.shared_model(), basis, force_metric(ForceNorm::Stiffness, modes), linear},
      .held_out = {}};
  const auto select = [&] {
    return training.with_problem(
        [](const auto& problem) { return working_components(NnSp{.seed = 3}(problem, 12), "nn-sp"); });
  };
  const WorkingComponents before = select();
  EXPECT_EQ(training.refitted(before).indices, before.indices);  // without equilibria nothing changes
  EXPECT_TRUE(is_same(training.refitted(before).weights, before.weights));

  training.equilibria.emplace(fitting(Q, 20));
  const WorkingComponents rough = select(), refit = training.refitted(rough);
  EXPECT_TRUE(std::ranges::includes(rough.indices, refit.indices));
  EXPECT_GT(refit.weights.minCoeff(), 0);
  const auto moved = [&](const WorkingComponents& working) {
    return this->moved(training.object.reduced_system(working.indices, working.weights), Q);
  };
  EXPECT_LT(moved(refit), 0.97 * moved(rough));
  EXPECT_LE(moved(refit), moved(before));
  EXPECT_NEAR(training.equilibria_of(refit).error(refit.indices, refit.weights), moved(refit), 0.3 * moved(refit));
}

TEST_F(EquilibriumFittingTest, OffersWhatSelectorsAskForOfOneMatrix) {
  const Index T = 20;
  const Fitting f = fitting(equilibrium_poses(reduced, modes, linear_responses(0.1, T)), 5, 2);
  const Index m = f.cols();
  ASSERT_EQ(m, system.model().num_components());
  ASSERT_EQ(f.rows(), 5 * T);
  Matrix A(f.rows(), m);
  for (Index j = 0; j < m; ++j) f.column(j, A.col(j));
  EXPECT_TRUE(is_near(A * Vector::Ones(m), f.rhs(), 1e-12 * A.norm()));
  const Vector r = random_vector(f.rows(), 1, 3);
  EXPECT_TRUE(is_near(f.transpose_times(r), A.transpose() * r, 1e-12 * A.norm() * r.norm()));
  EXPECT_TRUE(is_near(f.squared_norms(), A.colwise().squaredNorm().transpose(), 1e-12 * A.squaredNorm()));
  EXPECT_TRUE(is_near(f.columns(all_components(m)).values(), A, 1e-12 * A.norm()));
  const std::vector<Index> some{3, 100, 41}, poses{4, 1};
  EXPECT_TRUE(is_near(f.columns(some).values(), A(Eigen::all, some), 1e-12 * A.norm()));
  const Fitting restricted = f.restricted_to(poses);
  ASSERT_EQ(restricted.rows(), 10);
  EXPECT_TRUE(is_near(restricted.columns(some).values().topRows(5), A(Eigen::seqN(20, 5), some), 1e-12 * A.norm()));
  EXPECT_TRUE(is_near(restricted.columns(some).values().bottomRows(5), A(Eigen::seqN(5, 5), some), 1e-12 * A.norm()));
}

struct FreeEquilibriumFittingTest : EquilibriumFittingTest {
  FreeEquilibriumFittingTest() : EquilibriumFittingTest(free_bar(), 9) {}
};

TEST_F(FreeEquilibriumFittingTest, FreeObjectsAreHeldBySoftSprings) {
  ASSERT_EQ(modes.num_zero, 6);
  const Matrix Q = equilibrium_poses(reduced, modes, linear_responses(0.05));
  const auto rigid = modes.Phi.leftCols(6);
  const double k = modes.softest_stiffness();
  for (Index t = 0; t < Q.cols(); ++t) {
    const Vector load = stiffness * linear_responses(0.05).col(t);
    const Vector rest = reduced.force(Q.col(t)) + k * rigid * (rigid.transpose() * Q.col(t)) - load;
    EXPECT_LT(rest.norm(), 1e-4 * load.norm());
  }
  const Fitting f = fitting(Q, 12);
  EXPECT_TRUE(f.rhs().allFinite());
  const Index m = f.cols();
  EXPECT_LT(f.error(all_components(m), Vector::Ones(m)), 1e-10);
}

}  // namespace
}  // namespace supple::test
