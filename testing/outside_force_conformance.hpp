#pragma once
/// \file Test suite of what every outside force promises, typed. A force joins with a case and one line:
///
///     struct MyCase {
///       static MyForce make();
///       static double reach();   // [m], displacements to test it at
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MyForce, OutsideForceConformance, MyCase);

#include <physics/load/outside_force.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>
#include <vector>

namespace supple::test {

template <typename Case>
class OutsideForceConformance : public testing::Test {
 protected:
  using Force = decltype(Case::make());
  static_assert(OutsideForce<Force>);

  const Force outside = Case::make();
  const Index k = static_cast<Index>(std::span<const Index>(outside.nodes()).size());

  Points displaced(unsigned seed) const {
    const Vector u = random_vector(3 * k, Case::reach(), seed);
    return Eigen::Map<const Points>(u.data(), k, 3);
  }
  Points force(const Points& u) const {
    Points f = Points::Zero(k, 3);
    outside.force(u, f);
    return f;
  }
  static Vector flat(const Points& at_nodes) { return at_nodes.template reshaped<Eigen::RowMajor>(); }
  /// (g(u + h e) − g(u − h e)) / 2h along unknown j, e at the scale of the reach.
  template <typename G>
  auto difference(const G& g, Points u, Index j) const {
    const double h = 1e-5 * Case::reach(), at = u(j / 3, j % 3);
    u(j / 3, j % 3) = at + h;
    const auto plus = g(u);
    u(j / 3, j % 3) = at - h;
    const auto minus = g(u);
    return std::decay_t<decltype(plus)>((plus - minus) / (2 * h));
  }
};
TYPED_TEST_SUITE_P(OutsideForceConformance);

TYPED_TEST_P(OutsideForceConformance, TouchesEachNodeOnce) {
  const std::span<const Index> nodes = this->outside.nodes();
  std::vector<Index> sorted(nodes.begin(), nodes.end());
  std::ranges::sort(sorted);
  ASSERT_FALSE(sorted.empty());
  EXPECT_GE(sorted.front(), 0);
  EXPECT_TRUE(std::ranges::adjacent_find(sorted) == sorted.end());
}

TYPED_TEST_P(OutsideForceConformance, SaysTheSameAgainAndOverwritesWhatWasThere) {
  const Points u = this->displaced(1);
  Points f = Points::Constant(this->k, 3, 7.0);
  this->outside.force(u, f);
  EXPECT_TRUE(is_same(f, this->force(u)));
}

TYPED_TEST_P(OutsideForceConformance, ForceIsMinusTheGradientOfThePotential) {
  if constexpr (PotentialOutsideForce<typename TestFixture::Force>) {
    for (const unsigned seed : {1u, 2u, 3u}) {
      const Points u = this->displaced(seed);
      Vector gradient(3 * this->k);
      for (Index j = 0; j < gradient.size(); ++j)
        gradient[j] = this->difference([&](const Points& at) { return this->outside.potential(at); }, u, j);
      const Vector f = this->flat(this->force(u));
      EXPECT_TRUE(is_near(-gradient, f, 1e-6 * (f.norm() + gradient.norm()) + 1e-12));
    }
  } else {
    GTEST_SKIP() << "it has no potential";
  }
}

TYPED_TEST_P(OutsideForceConformance, StiffnessIsMinusTheDerivativeOfTheForce) {
  if constexpr (StiffOutsideForce<typename TestFixture::Force>) {
    for (const unsigned seed : {1u, 2u, 3u}) {
      const Points u = this->displaced(seed);
      ForceGradient gradient;
      this->outside.stiffness(u, gradient);
      Matrix K = Matrix::Zero(3 * this->k, 3 * this->k), differences = K;
      for (const auto& [a, b, block] : gradient.blocks()) K.block<3, 3>(3 * a, 3 * b) += block;
      for (Index j = 0; j < K.cols(); ++j)
        differences.col(j) = this->difference([&](const Points& at) { return this->flat(this->force(at)); }, u, j);
      EXPECT_TRUE(is_near(-differences, K, 1e-5 * K.norm() + 1e-12));
    }
  } else {
    GTEST_SKIP() << "it does not know its derivative";
  }
}

REGISTER_TYPED_TEST_SUITE_P(OutsideForceConformance, TouchesEachNodeOnce, SaysTheSameAgainAndOverwritesWhatWasThere,
                            ForceIsMinusTheGradientOfThePotential, StiffnessIsMinusTheDerivativeOfTheForce);

}  // namespace supple::test
