#pragma once
/// \file Test suite of what every SubspaceBuilder promises, typed. A builder joins with a case and one
/// line:
///
///     struct MyCase {
///       static System make();                        // small; called once a test
///       static Builder builder();                    // called with that system
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MyBuilder, SubspaceBuilderConformance, MyCase);

#include <core/parallel.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/subspace/explain_subspace_builder.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <testing/agreement.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <cmath>

namespace supple::test {

/// 1 ≤ d ≤ unknowns, as many rows as nodes times node_dim, and finite; or a sentence that says what is not.
template <Subspace Basis, typename System>
testing::AssertionResult has_dimensions(const Basis& basis, const System& system) {
  if (basis.full_dim() != system.num_nodes() * System::node_dim)
    return testing::AssertionFailure() << text("subspace: rows: expected ", system.num_nodes() * System::node_dim,
                                               ", unknowns of all nodes, found ", basis.full_dim());
  if (basis.dim() < 1 || basis.dim() > system.dim())
    return testing::AssertionFailure() << text("subspace: dimension: expected 1 to ", system.dim(),
                                               ", unknowns of the system, found ", basis.dim());
  for (Index j = 0; j < basis.W.cols(); ++j)
    for (Index i = 0; i < basis.W.rows(); ++i)
      if (!std::isfinite(basis.W(i, j)))
        return testing::AssertionFailure()
               << text("subspace: W(", i, ", ", j, "): expected a finite number, found ", basis.W(i, j));
  return testing::AssertionSuccess();
}

/// UᵀMU = I with the masses of all nodes.
template <Subspace Basis, typename System>
testing::AssertionResult is_mass_orthonormal(const Basis& basis, const System& system) {
  const Matrix U = basis.dense();
  Vector mass(U.rows());
  for (Index i = 0; i < mass.size(); ++i) mass[i] = system.nodal_mass()[i / System::node_dim];
  const Matrix gram = U.transpose() * mass.asDiagonal() * U;
  return agree(
      "subspace: columns are not mass-orthonormal", [](Index i, Index j) { return text("u_", i, " . M u_", j); }, gram,
      Matrix::Identity(U.cols(), U.cols()), 1e-12);
}

template <Subspace Basis, typename System>
testing::AssertionResult keeps_fixed_nodes(const Basis& basis, const System& system) {
  const Matrix U = basis.dense();
  for (const Index v : system.numbering().fixed_nodes())
    for (int axis = 0; axis < System::node_dim; ++axis)
      for (Index j = 0; j < U.cols(); ++j)
        if (const double u = U(v * System::node_dim + axis, j); u != 0)
          return testing::AssertionFailure() << text("subspace: a fixed node moves: node ", v, ", axis ", axis,
                                                     ", column ", j, ": expected 0, found ", u);
  return testing::AssertionSuccess();
}

template <typename Case>
class SubspaceBuilderConformance : public testing::Test {
 protected:
  using System = decltype(Case::make());
  using Builder = decltype(Case::builder());
  static_assert(explain_subspace_builder<Builder>());
  static constexpr int node_dim = System::node_dim;
  static constexpr Index stencil_size = std::remove_cvref_t<decltype(std::declval<System>().model())>::stencil_size;

  const System system = Case::make();
  const decltype(Case::builder()(system)) basis = Case::builder()(system);
};
TYPED_TEST_SUITE_P(SubspaceBuilderConformance);

TYPED_TEST_P(SubspaceBuilderConformance, DimensionsFitAndNumbersAreFinite) {
  EXPECT_TRUE(has_dimensions(this->basis, this->system));
}

TYPED_TEST_P(SubspaceBuilderConformance, ColumnsAreMassOrthonormal) {
  EXPECT_TRUE(is_mass_orthonormal(this->basis, this->system));
}

TYPED_TEST_P(SubspaceBuilderConformance, FixedNodesDoNotMove) {
  EXPECT_TRUE(keeps_fixed_nodes(this->basis, this->system));
}

TYPED_TEST_P(SubspaceBuilderConformance, GivesTheSameBitsAgainWhateverTheNumberOfThreads) {
  for (const int threads : {1, 2}) {
    set_num_threads(threads);
    EXPECT_TRUE(is_same(TypeParam::builder()(this->system).W, this->basis.W)) << threads << " threads";
  }
  set_num_threads(0);
}

TYPED_TEST_P(SubspaceBuilderConformance, FrequenciesAscendAndOneIsTheSmallestInTheSubspace) {
  const SubspaceReport& report = this->basis.report;
  ASSERT_EQ(report.residuals.size(), report.omega.size());
  if (report.omega.size() == 0) {  // not made from modes; no subspace has lower frequencies than the system
    EXPECT_EQ(report.rigid_modes, 0);
    const FreeComponents components =
        find_free_components(this->system.stencils(), TestFixture::stencil_size, this->system.numbering());
    const VibrationModes exact = vibration_modes(this->system, {.num_modes = components.num_rigid_modes() + 2});
    const Vector omega = reduced_modes(project_stiffness(this->basis, this->system)).omega;
    for (Index k = 0; k < std::min(omega.size(), exact.omega.size()); ++k)
      EXPECT_GE(omega[k], exact.omega[k] * (1 - 1e-6)) << "mode " << k;
    return;
  }
  ASSERT_GT(report.omega.size(), report.rigid_modes);
  EXPECT_LE(report.residuals.maxCoeff(), 1e-6);
  for (Index k = 1; k < report.omega.size(); ++k) EXPECT_GE(report.omega[k], report.omega[k - 1] * (1 - 1e-9));
  // the subspace contains the modes, and no subspace has lower frequencies (Rayleigh)
  const ReducedModes modes = reduced_modes(project_stiffness(this->basis, this->system));
  ASSERT_EQ(modes.num_zero, report.rigid_modes);
  for (Index k = report.rigid_modes; k < report.omega.size(); ++k)
    EXPECT_LE(modes.omega[k], report.omega[k] * (1 + 1e-6)) << "mode " << k;
  EXPECT_NEAR(modes.omega[report.rigid_modes], report.omega[report.rigid_modes],
              1e-6 * report.omega[report.rigid_modes]);
}

// U is given by the action of its rows, of its columns and as a matrix: three ways to say the same.
TYPED_TEST_P(SubspaceBuilderConformance, AllViewsOfTheBasisAgree) {
  const auto& view = this->basis;
  const Matrix U = view.dense();
  ASSERT_EQ(view.dim(), U.cols());
  ASSERT_EQ(view.full_dim(), U.rows());
  const Vector q = random_vector(view.dim(), 1, 3), f = random_vector(view.full_dim(), 1, 4);
  const double rounding = 1e-13 * U.cwiseAbs().rowwise().sum().maxCoeff();
  EXPECT_TRUE(is_near(view.reconstruct(q), U * q, rounding));
  EXPECT_TRUE(is_near(view.project(f), U.transpose() * f, 1e-13 * U.cwiseAbs().colwise().sum().maxCoeff()));
  Vector sum = Vector::Ones(view.dim());
  for (const Index dof : {Index{0}, Index{1}, Index{2}, U.rows() / 2, U.rows() - 1}) {
    EXPECT_NEAR(view.at(dof, q), U.row(dof) * q, rounding);
    const Vector before = sum;
    view.add_row(dof, 2.5, sum);
    EXPECT_TRUE(is_near(sum - before, 2.5 * U.row(dof).transpose(), 1e-14 * (1 + sum.norm())));
  }
  EXPECT_THROW((void)view.reconstruct(Vector::Zero(view.dim() + 1)), std::invalid_argument);
  EXPECT_THROW((void)view.project(Vector::Zero(view.full_dim() - 1)), std::invalid_argument);
}

REGISTER_TYPED_TEST_SUITE_P(SubspaceBuilderConformance, DimensionsFitAndNumbersAreFinite, ColumnsAreMassOrthonormal,
                            FixedNodesDoNotMove, GivesTheSameBitsAgainWhateverTheNumberOfThreads,
                            FrequenciesAscendAndOneIsTheSmallestInTheSubspace, AllViewsOfTheBasisAgree);

}  // namespace supple::test
