#include <reduction/basis/modal_basis.hpp>
#include <reduction/pipeline/reduction.hpp>
#include <reduction/system/error_estimator.hpp>
#include <reduction/training/indicator_fitting.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace supple::test {
namespace {

using BarModel = TetElasticity<StVenantKirchhoff>;

TEST(OutsideModes, SpanWhatRemains) {
  const StvkBar bar = clamped_bar();
  const Matrix remainders = random_vector(bar.dim(), 1, 1) * random_vector(5, 1, 2).transpose() +
                            random_vector(bar.dim(), 1, 3) * random_vector(5, 0.1, 4).transpose();
  const Vector sizes = random_vector(5, 1, 5).cwiseAbs() + Vector::Ones(5);
  const Vector mass = bar.mass();
  const SparseMatrix& K = bar.rest_stiffness();

  const OutsideModes all = outside_modes(remainders, sizes, K, mass, 8);
  ASSERT_EQ(all.stiffness.size(), 2) << "the remainders have rank 2";
  EXPECT_TRUE(is_near(Matrix(all.V.transpose() * mass.asDiagonal() * all.V), Matrix::Identity(2, 2), 1e-10));
  const Matrix VKV = all.V.transpose() * (K * all.V);
  EXPECT_TRUE(is_near(VKV, Matrix(all.stiffness.asDiagonal()), 1e-8 * VKV.norm()));
  const Matrix shares = remainders * sizes.cwiseInverse().asDiagonal();
  EXPECT_TRUE(is_near(Matrix(all.V * all.coordinates), shares, 1e-8 * shares.norm()));

  const OutsideModes one = outside_modes(remainders, sizes, K, mass, 1);
  ASSERT_EQ(one.stiffness.size(), 1);
  const auto missed = [&](const OutsideModes& modes) {
    return (mass.cwiseSqrt().asDiagonal() * (shares - modes.V * modes.coordinates)).norm();
  };
  const Eigen::JacobiSVD<Matrix> svd(mass.cwiseSqrt().asDiagonal() * shares);
  EXPECT_NEAR(missed(one), svd.singularValues().tail(4).norm(), 1e-8 * missed(one)) << "not the principal component";
  EXPECT_EQ(outside_modes(Matrix::Zero(bar.dim(), 3), Vector::Ones(3), K, mass, 8).stiffness.size(), 0);
}

TEST(OutsideModes, TheNinthDecileLeavesOutWhatCollapsed) {
  Vector sizes = Vector::LinSpaced(21, 1, 21);
  sizes[4] = 1e6;
  EXPECT_EQ(ninth_decile(sizes), 20);
  EXPECT_EQ(ninth_decile(Vector::Constant(1, 3)), 3);
  EXPECT_THROW(ninth_decile({}), std::invalid_argument);
}

/// An indicator that has all components of a bar, with weight 1, in the subspace and along two displacements outside.
template <Subspace S>
struct ExactIndicator {
  ExactIndicator(StvkBar bar, S some) : system(std::move(bar)), subspace(std::move(some)) {
    modes = reduced_modes(project_stiffness(subspace, system), subspace.report.known_zero_modes());
    Matrix remainders(system.dim(), 2);
    for (Index k = 0; k < 2; ++k) {
      const Vector u = random_vector(system.dim(), 1, 21 + k);
      remainders.col(k) =
          u - system.restrict(subspace.reconstruct(subspace.project(system.expand(system.mass().cwiseProduct(u)))));
    }
    outside = outside_modes(remainders, Vector::Ones(2), system.rest_stiffness(), system.mass(), 2);
    DenseBasis V;
    V.W = system.rest_state().expand(outside.V);
    indicator.indices.resize(system.model().num_components());
    std::iota(indicator.indices.begin(), indicator.indices.end(), Index{0});
    indicator.weights = Vector::Ones(system.model().num_components());
    constexpr Index local = num_active_dofs<BarModel>;
    indicator.rows.resize(indicator.weights.size() * local, subspace.dim() + 2);
    for (const Index i : indicator.indices)
      indicator.rows.middleRows(i * local, local) << dense_component_rows(system.model(), subspace, i),
          component_rows(system.model(), V, i);
    indicator.outside_stiffness = outside.stiffness;
  }
  Vector full_force(VectorIn q) const { return system.force(system.restrict(subspace.reconstruct(q))); }
  Vector force(VectorIn q) const { return subspace.project(system.expand(full_force(q))); }

  StvkBar system;
  S subspace;
  ReducedModes modes;
  OutsideModes outside;
  ErrorIndicator indicator;
};

template <Subspace S>
void expect_linear_responses(const ExactIndicator<S>& bar) {
  const ErrorEstimator estimate(bar.system.shared_model(), bar.indicator, bar.modes);
  const Index d = bar.subspace.dim(), rigid = bar.modes.num_zero;
  const Vector q = bar.modes.Phi.rightCols(d - rigid).leftCols(3) * random_vector(3, 0.05, 7);
  const Vector exact = bar.force(q);
  const Vector outside = (bar.outside.V.transpose() * bar.full_force(q)).cwiseQuotient(bar.outside.stiffness);
  const double single = 1e-5;  // the rows are kept in single precision

  const ErrorEstimate right = estimate(q, exact);
  EXPECT_LT(right.fit, single * q.norm()) << "the forces of the model are those of all components";
  EXPECT_NEAR(right.outside, outside.norm(), single * q.norm());
  EXPECT_GT(right.outside, 1e-3 * q.norm()) << "there is nothing outside";
  EXPECT_DOUBLE_EQ(right.total(), std::hypot(right.fit, right.outside));
  EXPECT_TRUE(right.beyond_training) << "it was trained on nothing";

  // a model whose forces are off by those of a displacement, with a part that has no energy
  const Index soft = std::min<Index>(40, d - rigid);
  Vector off = bar.modes.Phi.middleCols(rigid, soft) * random_vector(soft, 1e-2, 8);
  const Vector wrong =
      exact + bar.modes.Phi * bar.modes.omega.cwiseAbs2().asDiagonal() * bar.modes.Phi.transpose() * off;
  EXPECT_NEAR(estimate(q, wrong).fit, off.norm(), single * q.norm() + 1e-6 * off.norm());

  ErrorIndicator trained = bar.indicator;
  trained.scale = 3;
  trained.trained_size = 1.001 * q.norm();
  const ErrorEstimate scaled = ErrorEstimator(bar.system.shared_model(), trained, bar.modes)(q, wrong);
  EXPECT_NEAR(scaled.total(), 3 * estimate(q, wrong).total(), 1e-12 * scaled.total());
  EXPECT_FALSE(scaled.beyond_training);
  if (rigid > 0) {
    const Vector moved = q + bar.modes.Phi.col(0);
    EXPECT_FALSE(ErrorEstimator(bar.system.shared_model(), trained, bar.modes)(moved, wrong).beyond_training)
        << "a rigid motion deforms nothing";
  }
}

TEST(ErrorEstimator, AsksForTheLinearResponsesInModes) {
  const StvkBar bar = clamped_bar();
  VibrationModes modes = vibration_modes(bar.rest_state(), {.num_modes = 6});
  expect_linear_responses(ExactIndicator<DenseBasis>(bar, {modes.vectors, modes.report()}));
}
TEST(ErrorEstimator, AsksForTheLinearResponsesInExtendedModes) {
  const StvkBar bar = free_bar();
  expect_linear_responses(ExactIndicator<NodalBasis>(bar, ExtendedModalBasis{.num_modes = 9}(bar)));
}

/// What a motion of a bar at rest is off by at the end, if its forces are off by λ sin(ω t) along its softest mode.
Vector error_at_resonance(const ErrorEstimator& states, const ReducedModes& modes, const RayleighDamping& damping,
                          double periods, Index calls_per_period) {
  MotionErrorEstimator motion(states, damping);
  const double omega = modes.omega[modes.num_zero], period = 2 * std::numbers::pi / omega;
  const Vector rest = Vector::Zero(modes.omega.size());
  ErrorEstimate estimate;
  const auto calls = static_cast<Index>(std::lround(periods * static_cast<double>(calls_per_period)));
  for (Index k = 1; k <= calls; ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(calls_per_period) * period;
    estimate = motion.advance(t, rest, omega * omega * std::sin(omega * t) * modes.Phi.col(modes.num_zero));
  }
  return motion.displacement();
}

// ë + ω² e = ω² sin(ω t), from rest: e = ½ (sin(ω t) − ω t cos(ω t)).
TEST(MotionErrorEstimator, AddsUpWhatActsInTheRhythmOfAMode) {
  const StvkBar bar = clamped_bar();
  VibrationModes modes = vibration_modes(bar.rest_state(), {.num_modes = 6});
  const ExactIndicator<DenseBasis> exact(bar, {modes.vectors, modes.report()});
  const ErrorEstimator states(exact.system.shared_model(), exact.indicator, exact.modes);
  const double expected = 0.5 * (std::sin(2.25 * 2 * std::numbers::pi) -
                                 2.25 * 2 * std::numbers::pi * std::cos(2.25 * 2 * std::numbers::pi));
  double before = 0;
  for (const Index calls : {16, 32, 64}) {
    const Vector by_mode = error_at_resonance(states, exact.modes, {}, 2.25, calls);
    const double off = std::abs(by_mode[0] - expected);
    EXPECT_LT(by_mode.tail(by_mode.size() - 1).norm(), 1e-6) << "the other modes lack nothing";
    if (before > 0) {
      EXPECT_NEAR(before / off, 4, 1) << calls << " calls a period: not of second order";
    }
    before = off;
  }
  EXPECT_LT(before, 0.01);
  // damped, the amplitude stays below stiffness / (damping · ω)
  const double omega = exact.modes.omega[0], ratio = 0.1;
  const RayleighDamping damping{.alpha = ratio * omega, .beta = ratio / omega};
  EXPECT_NEAR(error_at_resonance(states, exact.modes, damping, 12, 64)[0], -1 / (2 * ratio), 0.02 / (2 * ratio));
}

// What a free object drifts by as a whole is not looked at: two fits differ there more than either does from the truth.
TEST(MotionErrorEstimator, LeavesRigidModesOut) {
  const StvkBar bar = free_bar();
  const ExactIndicator<NodalBasis> exact(bar, ExtendedModalBasis{.num_modes = 9}(bar));
  MotionErrorEstimator motion(ErrorEstimator(exact.system.shared_model(), exact.indicator, exact.modes), {});
  const Vector rest = Vector::Zero(exact.modes.omega.size());
  const ErrorEstimate estimate = motion.advance(1e-3, rest, 3 * exact.modes.Phi.leftCols(6).rowwise().sum());
  EXPECT_NEAR(estimate.total(), 0, 1e-12);
}

TEST(MotionErrorEstimator, TakesFastModesToFollowAtOnce) {
  const StvkBar bar = clamped_bar();
  VibrationModes modes = vibration_modes(bar.rest_state(), {.num_modes = 6});
  const ExactIndicator<DenseBasis> exact(bar, {modes.vectors, modes.report()});
  const ErrorEstimator states(exact.system.shared_model(), exact.indicator, exact.modes);
  MotionErrorEstimator motion(states, {});
  const Vector rest = Vector::Zero(6), force = exact.modes.Phi * exact.modes.omega.cwiseAbs2();
  const double period = 2 * std::numbers::pi / exact.modes.omega[0];
  const ErrorEstimate estimate = motion.advance(period, rest, force);
  EXPECT_NEAR(estimate.fit, states(rest, force).fit, 1e-9);
  EXPECT_TRUE(is_near(motion.displacement(), Vector::Ones(6), 1e-9));
  EXPECT_THROW(motion.advance(period, rest, force), std::invalid_argument);
}

TEST(ErrorEstimator, RefusesRowsThatAreNotThoseOfTheComponents) {
  const StvkBar bar = clamped_bar();
  VibrationModes modes = vibration_modes(bar.rest_state(), {.num_modes = 6});
  const ExactIndicator<DenseBasis> exact(bar, {modes.vectors, modes.report()});
  ErrorIndicator short_of_rows = exact.indicator, of_another_subspace = exact.indicator;
  short_of_rows.rows.conservativeResize(9, Eigen::NoChange);
  of_another_subspace.outside_stiffness = Vector::Ones(3);
  for (const ErrorIndicator& indicator : {short_of_rows, of_another_subspace})
    EXPECT_THROW(ErrorEstimator(exact.system.shared_model(), indicator, exact.modes), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
