#include <numerics/linear/spd_solver.hpp>
#include <numerics/optimize/newton.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/discrete_shell.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/statics/equilibrium.hpp>
#include <reduction/basis/force_curvature.hpp>
#include <reduction/basis/modal_derivatives.hpp>
#include <testing/subspace_builder_conformance.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/force_models.hpp>
#include <tests/support/outside.hpp>
#include <tests/support/plates.hpp>

#include <Eigen/LU>
#include <gmock/gmock.h>

namespace supple::test {

template <auto system, Index num_modes, Index dimension = 0, bool affine = false>
struct DerivativesCase {
  static auto make() { return system(); }
  static ModalDerivatives builder() {
    return {.num_modes = num_modes, .dimension = dimension, .affine_fields = affine};
  }
};
using DerivativesCases =
    testing::Types<DerivativesCase<clamped_bar, 5>, DerivativesCase<clamped_bar, 5, 12>, DerivativesCase<free_bar, 4>,
                   DerivativesCase<free_bar, 4, 25, true>, DerivativesCase<clamped_and_free_bars, 4>,
                   DerivativesCase<free_bars, 4>, DerivativesCase<held_plate, 4>, DerivativesCase<free_plate, 4>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Derivatives, SubspaceBuilderConformance, DerivativesCases);

namespace {

/// H(x, x) of St. Venant–Kirchhoff in closed form. With G = ∇x, strains are sym G and ½ GᵀG to first and
/// second order, so P = F S has the second-order part G S₁ + S₂, and H is twice that.
Vector quadratic_force(const TetMesh& mesh, const StVenantKirchhoff<double>& material, VectorIn x) {
  Vector H = Vector::Zero(x.size());
  const auto stress = [&](const Matrix3<double>& E) -> Matrix3<double> {
    return material.lambda * E.trace() * Matrix3<double>::Identity() + 2 * material.mu * E;
  };
  for (const Tet& tet : mesh.cells) {
    Matrix3<double> D, moved;
    for (int a = 0; a < 3; ++a) {
      D.col(a) = mesh.nodes.row(tet[a + 1]) - mesh.nodes.row(tet[0]);
      moved.col(a) = x.segment<3>(3 * tet[a + 1]) - x.segment<3>(3 * tet[0]);
    }
    const Matrix3<double> G = moved * D.inverse();
    const Matrix3<double> P = 2 * (G * stress(0.5 * (G + G.transpose())) + stress(0.5 * G.transpose() * G));
    const Matrix3<double> f = std::abs(D.determinant()) / 6 * P * D.inverse().transpose();
    for (int a = 0; a < 3; ++a) {
      H.segment<3>(3 * tet[a + 1]) += f.col(a);
      H.segment<3>(3 * tet[0]) -= f.col(a);
    }
  }
  return H;
}

/// H(x, y) of any system from its tangents, [K(h x) − K(−h x)] y / 2h, extrapolated four times from a step
/// that is large against rounding.
template <typename System>
Vector from_tangents(const System& system, const Vector& x, const Vector& y, double step) {
  std::array<std::array<Vector, 5>, 5> table;
  for (int k = 0; k < 5; ++k, step /= 2) {
    table[k][0] = (system.stiffness(step * x) * y - system.stiffness(-step * x) * y) / (2 * step);
    for (int l = 1; l <= k; ++l)
      table[k][l] = table[k][l - 1] + (table[k][l - 1] - table[k - 1][l - 1]) / (std::pow(4, l) - 1);
  }
  return table[4][4];
}

TEST(ForceCurvature, IsTheQuadraticPartOfStVenantKirchhoff) {
  const StvkBar system = free_bar();
  const RestState rest = system.rest_state();
  const ForceCurvature H(rest);
  const TetMesh mesh = bar_mesh();
  const auto material = StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.35});
  const auto exact = [&](const Vector& a, const Vector& b) -> Vector {
    return 0.5 * (quadratic_force(mesh, material, a + b) - quadratic_force(mesh, material, a) -
                  quadratic_force(mesh, material, b));
  };
  const Matrix phi = vibration_modes(system, {.num_modes = 10}).vectors;
  for (Index i = 6; i < 10; ++i)
    for (Index j = 6; j < 10; ++j) {
      const Vector a = phi.col(i) / H.size(phi.col(i)), b = phi.col(j) / H.size(phi.col(j));
      const double size =
          std::max(quadratic_force(mesh, material, a).norm(), quadratic_force(mesh, material, b).norm());
      // rounding of strains, ε, against squares of gradients of 2⁻⁷ and less
      EXPECT_LT((H(a, b) - exact(a, b)).norm(), 1e-9 * size) << i << ", " << j;
    }
  // whatever the length of x
  for (const double length : {1e-9, 1.0, 1e6}) {
    const Vector x = length * random_vector(system.dim(), 0.02, 4), reference = quadratic_force(mesh, material, x);
    EXPECT_LT((H(x) - reference).norm(), 1e-9 * reference.norm());
  }
}

template <typename System>
void check_against_tangents(const System& system, double accuracy) {
  const RestState rest = system.rest_state();
  const ForceCurvature H(rest);
  const FreeComponents components = find_free_components(rest.stencils, rest.stencil_size, rest.numbering);
  const VibrationModes modes = vibration_modes(system, {.num_modes = components.num_rigid_modes() + 4});
  Matrix phi = rest.restrict(modes.vectors.rightCols(4));
  for (Index i = 0; i < 4; ++i) phi.col(i) /= H.size(phi.col(i));
  Vector own(4);
  for (Index i = 0; i < 4; ++i) own[i] = from_tangents(system, phi.col(i), phi.col(i), 0.05).norm();
  for (Index i = 0; i < 4; ++i)
    for (Index j = 0; j < 4; ++j) {
      const Vector found = H(phi.col(i), phi.col(j));
      EXPECT_TRUE(is_same(H(phi.col(j), phi.col(i)), found));
      EXPECT_LT((found - from_tangents(system, phi.col(i), phi.col(j), 0.05)).norm(),
                accuracy * std::max(own[i], own[j]))
          << i << ", " << j;
      // H(a, b) · c does not depend on the order: a third derivative of the energy
      for (Index k = 0; k < 4; ++k)
        EXPECT_NEAR(found.dot(phi.col(k)), H(phi.col(i), phi.col(k)).dot(phi.col(j)),
                    accuracy * own.maxCoeff() * phi.colwise().norm().maxCoeff());
    }
}

TEST(ForceCurvature, HasTheStatedAccuracyForMooneyRivlin) {
  const TetMesh mesh = bar_mesh();
  const auto material = MooneyRivlin<double>::from({.young = 1e5, .poisson = 0.35});
  using System = FullSystem<TetElasticity<MooneyRivlin>>;
  check_against_tangents(System(TetElasticity<MooneyRivlin>(mesh, material), lumped_mass(mesh, 1000.0), {}), 1e-8);
  check_against_tangents(System(TetElasticity<MooneyRivlin>(mesh, material), lumped_mass(mesh, 1000.0), bar_end(mesh)),
                         1e-8);
}

TEST(ForceCurvature, HasTheStatedAccuracyForDiscreteShells) {
  check_against_tangents(held_plate(), 1e-8);
  check_against_tangents(free_plate(), 1e-8);
  check_against_tangents(FullSystem<DiscreteShell>(CurvedShell::make(), CurvedShell::nodal_mass()), 1e-7);
}

TEST(ForceCurvature, ShortensItsStepWhereForcesEnd) {
  // a sliver: gradients along its edges say little of how it flattens
  TetMesh mesh = single_tet(1);
  mesh.nodes.row(3) << 0.3, 0.3, 2e-3;
  using System = FullSystem<TetElasticity<MooneyRivlin>>;
  const System system(TetElasticity<MooneyRivlin>(mesh, MooneyRivlin<double>::from({.young = 1e5, .poisson = 0.35})),
                      lumped_mass(mesh, 1000.0), {});
  const RestState rest = system.rest_state();
  const ForceCurvature H(rest);
  Vector x = Vector::Zero(12);
  x[11] = 1;
  Vector f(12);
  system.force(-x / 128 / H.size(x), f);
  ASSERT_FALSE(f.allFinite());
  const Vector reference = from_tangents(system, x, x, 2e-4);
  EXPECT_LT((H(x) - reference).norm(), 1e-4 * reference.norm());
}

TEST(ForceCurvature, OfNothingIsNothing) {
  const StvkBar system = clamped_bar();
  const RestState rest = system.rest_state();
  const ForceCurvature H(rest);
  EXPECT_TRUE(H(Vector::Zero(system.dim())).isZero(0));
  EXPECT_THROW((void)H(Vector::Zero(system.dim() + 3)), std::invalid_argument);
  EXPECT_THROW((void)H(Vector::Constant(system.dim(), NAN)), std::invalid_argument);
}

TEST(ModalDerivatives, AreTheSecondDerivativesOfStaticSolutions) {
  const StvkBar system = clamped_bar();
  const RestState rest = system.rest_state();
  const VibrationModes modes = vibration_modes(system, {.num_modes = 3});
  const ModalDerivativeVectors derivatives = modal_derivatives(rest, modes);
  ASSERT_EQ(derivatives.pairs.size(), 6u);
  EXPECT_LT(derivatives.residual, 1e-8);
  const ForceCurvature H(rest);
  const Matrix phi = rest.restrict(modes.vectors);
  SpdSolver<SparseMatrix> solver;
  const auto statics = [&](const Vector& linear) -> Vector {
    Equilibrium<StvkBar> equilibrium(system, {system.rest_stiffness() * linear, {}}, 1e-11);
    Vector u = linear;
    EXPECT_EQ(Newton{}(equilibrium, solver, u, {.tolerance = 1e-11}).status, Status::Converged);
    return u;
  };
  for (std::size_t p = 0; p < derivatives.pairs.size(); ++p) {
    const auto [i, j] = derivatives.pairs[p];
    const Vector theta = rest.restrict(derivatives.vectors.col(p));
    std::array<double, 2> error;
    for (int k = 0; k < 2; ++k) {
      const double gradient = 0.02 / (k + 1);
      const double s = gradient / H.size(phi.col(i)), t = gradient / H.size(phi.col(j));
      const Vector a = s * phi.col(i), b = t * phi.col(j);
      const Vector difference =
          i == j ? Vector((statics(a) + statics(-a)) / (s * s))
                 : Vector((statics(a + b) - statics(a - b) - statics(b - a) + statics(-a - b)) / (4 * s * t));
      error[k] = (difference - theta).norm() / theta.norm();
    }
    EXPECT_LT(error[1], 2e-3) << i << ", " << j;
    EXPECT_NEAR(error[0] / error[1], 4, 0.3) << i << ", " << j << ": second order in the loads";
  }
}

// A mode is what its inertia forces hold in place, K(0) φᵢ = ωᵢ² M φᵢ. Held by the same forces at the state q φⱼ it is
// x(q) with K(q φⱼ) x = ωᵢ² M φᵢ, and dx/dq at q = 0 is the derivative θᵢⱼ with inertia frozen.
TEST(ModalDerivatives, AreTheLimitOfFiniteDifferencesOfModes) {
  const StvkBar system = clamped_bar();
  const RestState rest = system.rest_state();
  const VibrationModes modes = vibration_modes(system, {.num_modes = 4});
  const ModalDerivativeVectors derivatives = modal_derivatives(rest, modes);
  const ForceCurvature H(rest);
  const Matrix phi = rest.restrict(modes.vectors);
  for (std::size_t p = 0; p < derivatives.pairs.size(); ++p) {
    const auto [i, j] = derivatives.pairs[p];
    const Vector theta = rest.restrict(derivatives.vectors.col(p));
    const Vector inertia = modes.omega[i] * modes.omega[i] * system.mass().cwiseProduct(phi.col(i));
    const auto mode_at = [&, j = j](double q) -> Vector {
      return Matrix(system.stiffness(q * phi.col(j))).partialPivLu().solve(inertia);
    };
    std::array<double, 2> error;
    for (int k = 0; k < 2; ++k) {
      const double q = 0.01 / (k + 1) / H.size(phi.col(j));
      error[k] = ((mode_at(q) - mode_at(-q)) / (2 * q) - theta).norm() / theta.norm();
    }
    EXPECT_LT(error[1], 5e-3) << i << ", " << j;
    EXPECT_NEAR(error[0] / error[1], 4, 0.4) << i << ", " << j << ": second order in the step";
  }
}

TEST(ModalDerivatives, OfFreeObjectsAreOrthogonalToRigidMotions) {
  for (const StvkBar& system : {free_bar(), clamped_and_free_bars(), free_bars()}) {
    const RestState rest = system.rest_state();
    const FreeComponents components = find_free_components(rest.stencils, rest.stencil_size, rest.numbering);
    const VibrationModes modes = vibration_modes(system, {.num_modes = components.num_rigid_modes() + 3});
    const ModalDerivativeVectors derivatives = modal_derivatives(rest, modes);
    EXPECT_LT(derivatives.residual, 1e-8);
    const Matrix theta = rest.restrict(derivatives.vectors), phi = rest.restrict(modes.vectors);
    const Matrix M_rigid = rest.mass.asDiagonal() * phi.leftCols(modes.num_rigid);
    const ForceCurvature H(rest);
    for (Index p = 0; p < theta.cols(); ++p) {
      EXPECT_LT((M_rigid.transpose() * theta.col(p)).norm(),
                1e-12 * std::sqrt(theta.col(p).dot(rest.mass.cwiseProduct(theta.col(p)))));
      const auto [i, j] = derivatives.pairs[p];
      Vector load = -H(phi.col(i) / H.size(phi.col(i)), phi.col(j) / H.size(phi.col(j))) * H.size(phi.col(i)) *
                    H.size(phi.col(j));
      load -= M_rigid * (phi.leftCols(modes.num_rigid).transpose() * load);
      EXPECT_LT((rest.K * theta.col(p) - load).norm(), 1e-7 * load.norm());
    }
  }
}

TEST(ModalDerivatives, HaveTheDimensionThatWasAskedFor) {
  const Index r = 6, all = r * (r + 3) / 2;
  EXPECT_EQ(ModalDerivatives{.num_modes = r}(clamped_bar()).dim(), all);
  EXPECT_EQ(ModalDerivatives{.num_modes = r}(free_bar()).dim(), 6 + all);
  EXPECT_EQ((ModalDerivatives{.num_modes = r, .affine_fields = true}(free_bar()).dim()), 12 + all);
  EXPECT_EQ((ModalDerivatives{.num_modes = r, .affine_fields = true}(clamped_bar()).dim()), all);
  EXPECT_EQ((ModalDerivatives{.num_modes = r, .dimension = 20}(clamped_bar()).dim()), 20);
  EXPECT_EQ((ModalDerivatives{.num_modes = r, .dimension = 20}(free_bar()).dim()), 20);
  const DenseBasis most = ModalDerivatives{.num_modes = r, .dimension = 1000}(clamped_bar());
  EXPECT_EQ(most.dim(), all);
  EXPECT_THAT(most.report.notes, testing::ElementsAre(testing::HasSubstr("fewer than the 1000")));
  EXPECT_THROW((void)(ModalDerivatives{.num_modes = r, .dimension = 11}(free_bar())), std::invalid_argument);
}

TEST(ModalDerivatives, ContainModesAndDerivativesAndAreNested) {
  for (const StvkBar& system : {clamped_bar(), free_bar()}) {
    const Index rigid = system.numbering().num_free() < system.num_nodes() ? 0 : 6;
    const VibrationModes modes = vibration_modes(system, {.num_modes = rigid + 5});
    const Matrix theta = modal_derivatives(system.rest_state(), modes).vectors;
    const DenseBasis all = ModalDerivatives{.num_modes = 5, .derivative_tolerance = 1e-9}(system);
    EXPECT_LT(outside(all, system, modes.vectors), 1e-10);
    EXPECT_LT(outside(all, system, theta), 1e-8);
    EXPECT_EQ(all.report.singular_values.size(), 15);
    const DenseBasis some =
        ModalDerivatives{.num_modes = 5, .dimension = rigid + 12, .derivative_tolerance = 1e-9}(system);
    EXPECT_LT(outside(some, system, modes.vectors), 1e-10);
    EXPECT_LT(outside(some, system, Matrix(theta.col(0))), 1e-2) << "weighted most";
    EXPECT_TRUE(is_same(some.W, all.W.leftCols(rigid + 12)));
  }
}

TEST(ModalDerivatives, OfFewPairsAreThoseOfTheSoftestModes) {
  const StvkBar system = free_bar();
  const VibrationModes modes = vibration_modes(system, {.num_modes = 6 + 5});
  const ModalDerivativeVectors all = modal_derivatives(system.rest_state(), modes),
                               few = modal_derivatives(system.rest_state(), modes, 1e-8, {}, 7);
  ASSERT_EQ(few.pairs.size(), 7u);
  const auto product = [&](const std::array<Index, 2>& pair) { return modes.omega[pair[0]] * modes.omega[pair[1]]; };
  double stiffest = 0;
  for (const auto& pair : few.pairs) stiffest = std::max(stiffest, product(pair));
  for (std::size_t k = 0; k < all.pairs.size(); ++k) {
    const auto found = std::ranges::find(few.pairs, all.pairs[k]);
    if (found == few.pairs.end()) {
      EXPECT_GE(product(all.pairs[k]), stiffest);
      continue;
    }
    const Vector theta = all.vectors.col(k);
    EXPECT_TRUE(is_near(Vector(few.vectors.col(found - few.pairs.begin())), theta, 1e-6 * theta.norm()));
  }
  EXPECT_EQ((ModalDerivatives{.num_modes = 5, .num_pairs = 7}(system).dim()), 6 + 5 + 7);
  EXPECT_EQ((ModalDerivatives{.num_modes = 5, .num_pairs = 99}(system).dim()), 6 + 5 + 15);
  EXPECT_EQ((ModalDerivatives{.num_modes = 5, .num_derivatives = 4}(system).report.singular_values.size()), 8);
  EXPECT_THROW((void)(ModalDerivatives{.num_modes = 5, .num_pairs = -1}(system)), std::invalid_argument);
}

TEST(ModalDerivatives, WithAffineFieldsContainAllAffineMotions) {
  const StvkBar system = free_bar();
  const DenseBasis basis = ModalDerivatives{.num_modes = 3, .affine_fields = true}(system);
  for (std::uint64_t seed : {1, 2, 3})
    EXPECT_LT(
        outside(basis, system, affine_displacement(system.model().rest_positions(), random_matrix(3, 3, 1, seed))),
        1e-12);
}

TEST(ModalDerivatives, RepresentALargeBendBetterThanAsManyModes) {
  const StvkBar system = clamped_bar();
  Loads loads;
  loads.gravity = {0, 0, -9};
  SystemLoad<SparseMatrix> load = system.project(loads);
  const double full = 60;
  Vector u = Vector::Zero(system.dim());
  SpdSolver<SparseMatrix> solver;
  for (const double share : {0.25, 0.5, 0.75, 1.0}) {
    Equilibrium<StvkBar> equilibrium(system, {share * full / 9 * load.force, {}});
    ASSERT_EQ(Newton{}(equilibrium, solver, u).status, Status::Converged);
  }
  EXPECT_GT(u.lpNorm<Eigen::Infinity>(), 0.2) << "a third of its length";
  const Vector bent = system.expand(u);
  for (const auto& [d, ratio] : {std::pair<Index, double>{9, 0.75}, {20, 0.5}}) {  // some, all derivatives
    const double linear = outside(ModalBasis{.num_modes = d}(system), system, bent);
    const double derived = outside(ModalDerivatives{.num_modes = 5, .dimension = d}(system), system, bent);
    EXPECT_LT(derived, ratio * linear) << d;
  }
}

}  // namespace
}  // namespace supple::test
