#include <core/parallel.hpp>
#include <physics/statics/static_solver.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/basis/modal_derivatives.hpp>
#include <reduction/pipeline/training.hpp>
#include <reduction/training/relaxation.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

using BarModel = TetElasticity<StVenantKirchhoff>;

/// A bar in the subspace of a few modes.
template <Subspace S>
struct RelaxedBar {
  RelaxedBar(StvkBar bar, S some)
      : system(std::make_shared<const StvkBar>(std::move(bar))),
        basis(std::make_shared<const S>(std::move(some))),
        modes(reduced_modes(project_stiffness(*basis, *system), basis->report.known_zero_modes())),
        relaxation(system, basis, modes) {}

  /// Rms displacement of `amplitude` [m], along random mixtures of the softest modes.
  Matrix poses(double amplitude, Index count = 3) const {
    Matrix Q = Matrix::Zero(basis->dim(), count);
    for (Index t = 0; t < count; ++t) {
      const Index soft = std::min<Index>(4, basis->dim() - modes.num_zero);
      Q.col(t) = modes.Phi.middleCols(modes.num_zero, soft) * random_vector(soft, 1, 11 + t);
      Q.col(t) *= amplitude * std::sqrt(system->nodal_mass().sum()) / Q.col(t).norm();
    }
    return Q;
  }
  double locked_energy(VectorIn q) const { return system->energy(system->restrict(basis->reconstruct(q))); }
  Vector locked_force(VectorIn q) const {
    return basis->project(system->expand(system->force(system->restrict(basis->reconstruct(q)))));
  }

  std::shared_ptr<const StvkBar> system;
  std::shared_ptr<const S> basis;
  ReducedModes modes;
  Relaxation relaxation;
};

RelaxedBar<DenseBasis> modal_bar() {
  const StvkBar bar = clamped_bar();
  VibrationModes modes = vibration_modes(bar.rest_state(), {.num_modes = 6});
  return {bar, DenseBasis{modes.vectors, modes.report()}};
}
RelaxedBar<NodalBasis> extended_bar(StvkBar bar) {
  NodalBasis basis = ExtendedModalBasis{.num_modes = 8}(bar);
  return {std::move(bar), std::move(basis)};
}

template <typename Bar>
void expect_the_gradient_of_the_relaxed_energy(const Bar& bar) {
  const Matrix Q = bar.poses(0.08, 1);
  const FullStates at = bar.relaxation.relaxed(Q, 400);
  EXPECT_TRUE(is_near(at.Q, Q, 1e-9 * Q.norm())) << "the part in the subspace stays";
  EXPECT_LT(at.energies[0], 0.999 * bar.locked_energy(Q.col(0)));
  const Index d = Q.rows();
  const double h = 1e-4 * Q.norm();
  Matrix around(d, 2 * d);
  for (Index k = 0; k < d; ++k) {
    around.col(2 * k) = Q + h * Vector::Unit(d, k);
    around.col(2 * k + 1) = Q - h * Vector::Unit(d, k);
  }
  const Vector energies = bar.relaxation.relaxed(around, 400).energies;
  Vector gradient(d);
  for (Index k = 0; k < d; ++k) gradient[k] = (energies[2 * k] - energies[2 * k + 1]) / (2 * h);
  EXPECT_TRUE(is_near(Vector(at.forces.col(0)), gradient, 2e-4 * gradient.norm()));
  EXPECT_GT((bar.locked_force(Q.col(0)) - gradient).norm(), 0.01 * gradient.norm()) << "too small a pose to tell";
}

TEST(Relaxation, ForcesAreTheGradientOfTheRelaxedEnergyInModes) {
  expect_the_gradient_of_the_relaxed_energy(modal_bar());
}
TEST(Relaxation, ForcesAreTheGradientOfTheRelaxedEnergyInAnExtendedSubspace) {
  expect_the_gradient_of_the_relaxed_energy(extended_bar(clamped_bar()));
}

// min ½ uᵀ K u with UᵀM u = q has the multiplier (Uᵀ M K⁻¹ M U)⁻¹ q.
TEST(Relaxation, CondensesTheStiffnessInSmallMotions) {
  const auto bar = extended_bar(clamped_bar());
  const Index d = bar.basis->dim();
  const Matrix Q = 1e-6 * random_vector(d, 1, 3);  // energies of smaller ones lose the digits that a search needs
  Matrix MU(bar.system->dim(), d);
  for (Index k = 0; k < d; ++k)
    MU.col(k) = bar.system->mass().cwiseProduct(bar.system->restrict(bar.basis->reconstruct(Vector::Unit(d, k))));
  const Matrix K = bar.system->rest_stiffness();
  const Vector expected = (MU.transpose() * K.llt().solve(MU)).llt().solve(Q.col(0));
  EXPECT_TRUE(is_near(Vector(bar.relaxation.relaxed(Q, 400).forces.col(0)), expected, 1e-3 * expected.norm()));
}

TEST(Relaxation, EachStepLowersTheEnergy) {
  const auto bar = modal_bar();
  const Matrix Q = bar.poses(0.1);
  Vector before = bar.relaxation.relaxed(Q, 0).energies;
  for (Index t = 0; t < Q.cols(); ++t) EXPECT_NEAR(before[t], bar.locked_energy(Q.col(t)), 1e-9 * before[t]);
  for (const Index iterations : {1, 2, 4, 8, 32}) {
    const Vector energies = bar.relaxation.relaxed(Q, iterations).energies;
    EXPECT_TRUE((energies.array() <= before.array()).all()) << iterations;
    before = energies;
  }
}

TEST(Relaxation, EquilibriaAreThoseOfNewtonsMethod) {
  const auto bar = extended_bar(clamped_bar());
  const Matrix start = bar.poses(0.02),
               loads = bar.modes.Phi * bar.modes.omega.cwiseAbs2().asDiagonal() * bar.modes.Phi.transpose() * start;
  const FullStates states = bar.relaxation.equilibria(loads, start, 1e-9, 400);
  for (Index t = 0; t < start.cols(); ++t) {
    Vector u = bar.system->restrict(bar.basis->reconstruct(start.col(t)));
    const Vector load = bar.system->mass().cwiseProduct(bar.system->restrict(bar.basis->reconstruct(loads.col(t))));
    StaticSolver solver(*bar.system, {.tolerance = 1e-11});
    ASSERT_EQ(solver.solve({load, {}}, u).status, Status::Converged);
    const Vector mass = bar.system->mass();
    const double size = std::sqrt(u.cwiseAbs2().dot(mass));
    const Vector q = bar.basis->project(bar.system->expand(mass.cwiseProduct(u)));
    const Vector rest = u - bar.system->restrict(bar.basis->reconstruct(q));
    EXPECT_TRUE(is_near(Vector(states.Q.col(t)), q, 1e-6 * q.norm()));
    EXPECT_NEAR(states.sizes[t], size, 1e-6 * size);
    EXPECT_NEAR(states.outside[t], std::sqrt(rest.cwiseAbs2().dot(mass)) / size, 1e-6);
    EXPECT_GT(states.outside[t], 1e-4) << "the subspace has it all";
    EXPECT_LT(states.residuals[t], 1e-9);
    EXPECT_TRUE(is_near(Vector(states.forces.col(t)), Vector(loads.col(t)), 1e-5 * loads.col(t).norm()));
  }
}

// What has no energy is held by springs; a pull along the flexible modes does not move it far.
TEST(Relaxation, HoldsFreeObjects) {
  const auto bar = extended_bar(free_bar());
  ASSERT_EQ(bar.modes.num_zero, 6);
  const Matrix Q = bar.poses(0.03);
  const FullStates relaxed = bar.relaxation.relaxed(Q, 100);
  EXPECT_TRUE(is_near(relaxed.Q, Q, 1e-9 * Q.norm()));
  const Matrix loads = bar.modes.Phi * bar.modes.omega.cwiseAbs2().asDiagonal() * bar.modes.Phi.transpose() * Q;
  const FullStates states = bar.relaxation.equilibria(loads, Q, 1e-8, 400);
  EXPECT_LT(states.residuals.maxCoeff(), 1e-8);
  const Matrix rigid = bar.modes.Phi.leftCols(6);
  const Matrix held = states.forces + bar.modes.softest_stiffness() * rigid * (rigid.transpose() * states.Q);
  EXPECT_TRUE(is_near(held, loads, 1e-5 * loads.norm()));
}

TEST(Relaxation, IsTheSameForAnyNumberOfThreads) {
  const auto bar = modal_bar();
  const Matrix Q = bar.poses(0.1, 10);  // more than are solved for at once
  set_num_threads(1);
  const FullStates one = bar.relaxation.relaxed(Q);
  set_num_threads(3);
  const FullStates three = bar.relaxation.relaxed(Q);
  set_num_threads(0);
  EXPECT_EQ(one.forces, three.forces);
  EXPECT_EQ(one.energies, three.energies);
}

TEST(Relaxation, ColumnsAreThoseOfOneVector) {
  for (const bool dense : {true, false}) {
    const auto check = [](const auto& basis) {
      const Matrix Q = random_vector(basis.dim() * 5, 1, 3).reshaped(basis.dim(), 5);
      const Matrix F = random_vector(basis.full_dim() * 5, 1, 4).reshaped(basis.full_dim(), 5);
      const Matrix u = reconstruct_columns(basis, Q), f = project_columns(basis, F);
      for (Index k = 0; k < 5; ++k) {
        EXPECT_TRUE(is_near(Vector(u.col(k)), basis.reconstruct(Q.col(k)), 1e-12 * u.norm()));
        EXPECT_TRUE(is_near(Vector(f.col(k)), basis.project(F.col(k)), 1e-12 * f.norm()));
      }
    };
    if (dense)
      check(*modal_bar().basis);
    else
      check(*extended_bar(clamped_bar()).basis);
  }
}

}  // namespace
}  // namespace supple::test
