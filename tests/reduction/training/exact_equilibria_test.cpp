#include <physics/statics/static_solver.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/system/pose_sweep.hpp>
#include <reduction/system/reduced_system.hpp>
#include <reduction/training/exact_equilibria.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

// f = K q: whatever tangent the search starts from, it ends at K⁻¹ λ.
TEST(ExactEquilibria, SolvesLinearForcesFromAWrongTangent) {
  const Vector k = Vector::LinSpaced(6, 1, 10);
  const Matrix loads = Matrix::NullaryExpr(6, 3, [](Index i, Index t) { return std::cos(3.0 * i + t); });
  const Matrix wrong = (1.5 * k).asDiagonal(), start = wrong.inverse() * loads;
  const ExactEquilibria found = exact_equilibria([&](MatrixIn Q) -> Matrix { return k.asDiagonal() * Q; },
                                                 [&](VectorIn) { return wrong; }, loads, {}, start, 1e-9);
  EXPECT_TRUE(is_near(found.Q, k.cwiseInverse().asDiagonal() * loads, 1e-7));
  EXPECT_LT(found.residuals.maxCoeff(), 1e-7);
}

TEST(ExactEquilibria, SaysWhereForcesAreNotFinite) {
  const auto forces = [](MatrixIn Q) -> Matrix {
    Matrix F = Q;
    for (Index t = 0; t < Q.cols(); ++t)
      if (Q(0, t) < 0) F.col(t).setConstant(std::numeric_limits<double>::quiet_NaN());
    return F;
  };
  Matrix loads = Matrix::Ones(2, 2);
  loads.col(1) *= -1;
  const ExactEquilibria found = exact_equilibria(
      forces, [](VectorIn) { return Matrix::Identity(2, 2); }, loads, Matrix::Identity(2, 2), 0.9 * loads, 1e-9);
  EXPECT_TRUE(is_near(found.Q.col(0), 0.5 * loads.col(0), 1e-7)) << "held by springs as stiff as itself";
  EXPECT_TRUE(std::isnan(found.residuals[1]));
}

// Large bends, from equilibria of a quarter of the tets: the same states as Newton's method on all of them.
TEST(ExactEquilibria, AreThoseOfAllComponents) {
  const StvkBar bar = clamped_bar();
  const auto basis = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 4}(bar));
  const Matrix stiffness = project_stiffness(*basis, bar);
  const Index m = bar.model().num_components();
  const auto with = [&](const Vector& w) {
    return ReducedSystem(bar.shared_model(), basis, all_components(m), w, stiffness, bar.nodal_mass());
  };
  const auto exact = with(Vector::Ones(m));
  const auto fitted = with(Vector::Ones(m) + 0.2 * random_vector(m, 1, 3).cwiseAbs());
  const ReducedModes modes = reduced_modes(stiffness);
  Matrix linear = Matrix::Zero(basis->dim(), 10), start = linear, expected = linear;
  const double length = std::sqrt(bar.nodal_mass().sum());
  for (Index t = 0; t < 10; ++t)
    linear.col(t) = length * (0.02 * (t + 1) * modes.Phi.col(t % 3) + 0.01 * modes.Phi.col(3));
  for (Index t = 0; t < 10; ++t) {
    const Vector load = stiffness * linear.col(t);
    Vector q = Vector::Zero(basis->dim());
    ASSERT_EQ(StaticSolver(fitted, {.tolerance = 1e-8}).solve({load, {}}, q).status, Status::Converged);
    start.col(t) = q;
    ASSERT_EQ(StaticSolver(exact, {.tolerance = 1e-10}).solve({load, {}}, q).status, Status::Converged);
    expected.col(t) = q;
  }
  const auto found = exact_equilibria([&](MatrixIn Q) { return reduced_forces(bar.shared_model(), *basis, Q); },
                                      [&](VectorIn q) { return fitted.stiffness(q); }, stiffness * linear, {}, start);
  for (Index t = 0; t < 10; ++t) {
    const double way = (expected.col(t) - start.col(t)).norm();
    EXPECT_GT(way, 0.02 * expected.col(t).norm());
    EXPECT_LT((found.Q.col(t) - expected.col(t)).norm(), 0.02 * way) << t;  // twice the last step that is left
  }
}

}  // namespace
}  // namespace supple::test
