#pragma once
/// \file What every ForceModel promises, as a typed test suite. A model joins with a factory and one line:
///
///     struct MyShell {
///       static MyModel make();                      // small: every component is tested
///       static constexpr double length = 0.1;       // typical distance of neighbouring nodes [m], or temperature
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MyShell, ForceModelConformance, MyShell);
///
/// Random states displace each coordinate by up to 0.12 length; forces (and energy) must be defined there.

#include <physics/term_pack.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include <set>
#include <thread>

namespace supple::test {

template <typename Factory>
class ForceModelConformance : public testing::Test {
 protected:
  using Model = decltype(Factory::make());
  static_assert(ForceModel<Model>);
  static constexpr int dofs = Model::local_dofs;

  /// Component `i` in random state `k`; state 0 is at rest.
  static Local<dofs> state(Index i, int k) {
    if (k == 0) return Local<dofs>::Zero();
    return random_vector(dofs, 0.12 * Factory::length, static_cast<std::uint64_t>(1000 * k + i));
  }
  /// Body over all components and states.
  template <typename Body>
  void for_states(const Body& body) const {
    for (int k = 0; k < num_states; ++k)
      for (Index i = 0; i < model->num_components(); ++i) {
        SCOPED_TRACE("component " + std::to_string(i) + ", state " + std::to_string(k));
        body(i, state(i, k));
        if (testing::Test::HasFailure()) return;
      }
  }
  double stiffness_scale(Index i) const { return model->stiffness(i, Local<dofs>::Zero()).norm(); }

  /// Central differences err by h² ∂³ and by rounding / h: with h = ε^⅓ L both are about 1e-10 of K L (times
  /// constants of the model), so what is off by more than 1e-7 is another function.
  static constexpr double h = 1e-5 * Factory::length;
  static constexpr double difference_tolerance = 1e-7;
  static constexpr double rounding = 1e-12;  // a few thousand operations
  static constexpr int num_states = 4;

  std::shared_ptr<const Model> model = std::make_shared<const Model>(Factory::make());
};
TYPED_TEST_SUITE_P(ForceModelConformance);

TYPED_TEST_P(ForceModelConformance, StencilNodesAreDistinctAndInRange) {
  const auto& F = *this->model;
  ASSERT_GT(F.num_components(), 0);
  for (Index i = 0; i < F.num_components(); ++i) {
    std::set<Index> distinct;
    for (const Index v : F.stencil(i)) {
      EXPECT_GE(v, 0) << "component " << i;
      EXPECT_LT(v, F.num_nodes()) << "component " << i;
      EXPECT_TRUE(distinct.insert(v).second) << "node " << v << " twice in component " << i;
    }
  }
}

TYPED_TEST_P(ForceModelConformance, EveryTermIsInEquilibriumAtRest) {
  const Local<TestFixture::dofs> zero = Local<TestFixture::dofs>::Zero();
  for (Index i = 0; i < this->model->num_components(); ++i)
    EXPECT_TRUE(is_near(this->model->force(i, zero), zero,
                        this->rounding * this->stiffness_scale(i) * TypeParam::length))
        << "component " << i;
}

TYPED_TEST_P(ForceModelConformance, ForceIsTheGradientOfTheEnergyIfThereIsOne) {
  if constexpr (PotentialModel<typename TestFixture::Model>) this->for_states([&](Index i, const auto& u) {
    Local<TestFixture::dofs> differences;
    for (int j = 0; j < TestFixture::dofs; ++j) {
      Local<TestFixture::dofs> plus = u, minus = u;
      plus[j] += this->h;
      minus[j] -= this->h;
      differences[j] = (this->model->energy(i, plus) - this->model->energy(i, minus)) / (2 * this->h);
    }
    EXPECT_TRUE(is_near(this->model->force(i, u), differences,
                        this->difference_tolerance * this->stiffness_scale(i) * TypeParam::length));
  });
}

TYPED_TEST_P(ForceModelConformance, StiffnessIsTheDerivativeOfTheForce) {
  this->for_states([&](Index i, const auto& u) {
    LocalMatrix<TestFixture::dofs> differences;
    for (int j = 0; j < TestFixture::dofs; ++j) {
      Local<TestFixture::dofs> plus = u, minus = u;
      plus[j] += this->h;
      minus[j] -= this->h;
      differences.col(j) = (this->model->force(i, plus) - this->model->force(i, minus)) / (2 * this->h);
    }
    EXPECT_TRUE(is_near(this->model->stiffness(i, u), differences,
                        this->difference_tolerance * this->stiffness_scale(i)));
  });
}

TYPED_TEST_P(ForceModelConformance, TangentIsPositiveSemidefiniteAtRestAndSymmetricWherePromised) {
  constexpr bool symmetric = has_symmetric_tangent<typename TestFixture::Model>();
  double asymmetry = 0;
  this->for_states([&](Index i, const auto& u) {
    const LocalMatrix<TestFixture::dofs> K = this->model->stiffness(i, u);
    asymmetry = std::max(asymmetry, (K - K.transpose()).norm() / this->stiffness_scale(i));
    if (symmetric || u.isZero(0)) {
      EXPECT_TRUE(is_near(K, K.transpose(), this->rounding * this->stiffness_scale(i)));
    }
    if (u.isZero(0)) {
      const Eigen::SelfAdjointEigenSolver<Matrix> eigen(Matrix(K), Eigen::EigenvaluesOnly);
      EXPECT_GE(eigen.eigenvalues().minCoeff(), -this->rounding * K.norm());
    }
  });
  if (!symmetric) {
    EXPECT_GT(asymmetry, 1e-3) << "symmetric, then do not deny it: it halves the work";
  }
}

TYPED_TEST_P(ForceModelConformance, TranslationsChangeNothingWherePromised) {
  using F = typename TestFixture::Model;
  const auto t = random_vector(F::node_dim, 3 * TypeParam::length, 77);
  Local<TestFixture::dofs> translation;
  for (int a = 0; a < F::stencil_size; ++a) translation.template segment<F::node_dim>(a * F::node_dim) = t;
  if constexpr (is_translation_invariant<F>()) {
    static_assert(num_active_dofs<F> == F::local_dofs - F::node_dim);
    this->for_states([&](Index i, const auto& u) {
      const double K = this->stiffness_scale(i), L = TypeParam::length;
      if constexpr (PotentialModel<F>) {
        EXPECT_NEAR(this->model->energy(i, u + translation), this->model->energy(i, u),
                    this->rounding * K * L * L);
      }
      EXPECT_TRUE(
          is_near(this->model->force(i, u + translation), this->model->force(i, u), this->rounding * K * L));
    });
  } else {
    static_assert(num_active_dofs<F> == F::local_dofs);
    const Local<TestFixture::dofs> u = this->state(0, 1), moved = u + translation;
    EXPECT_GT((this->model->force(0, moved) - this->model->force(0, u)).norm(),
              1e-3 * this->stiffness_scale(0) * u.norm())
        << "invariant, then say so: work and storage of a reduced term fall by a node";
  }
}

TYPED_TEST_P(ForceModelConformance, ConstCallsFromSeveralThreadsGiveTheSameBits) {
  const auto& components = *this->model;
  constexpr int size = TestFixture::dofs;
  const auto evaluate = [&] {
    Matrix all = Matrix::Zero((size + 2) * components.num_components(), size);
    for (Index i = 0; i < components.num_components(); ++i) {
      const Local<size> u = this->state(i, 1);
      auto rows = all.template middleRows<size + 2>(i * (size + 2));
      if constexpr (PotentialModel<typename TestFixture::Model>) rows.row(0).setConstant(components.energy(i, u));
      rows.row(1) = components.force(i, u).transpose();
      rows.template bottomRows<size>() = components.stiffness(i, u);
    }
    return all;
  };
  const Matrix serial = evaluate();
  std::array<Matrix, 3> parallel;
  {
    std::vector<std::jthread> threads;
    for (Matrix& result : parallel) threads.emplace_back([&result, &evaluate] { result = evaluate(); });
  }
  for (const Matrix& result : parallel) EXPECT_TRUE(is_same(result, serial));
}

TYPED_TEST_P(ForceModelConformance, PacksEqualTheirTermsLaneByLane) {
  using F = typename TestFixture::Model;
  constexpr int size = TestFixture::dofs;
  const F& components = *this->model;
  Random random(5);
  for (int k = 0; k < 10; ++k) {
    PackIndices lanes;
    for (Index& i : lanes) i = random.below(components.num_components());  // any order, repetitions, too
    const TermPack<F> pack(this->model, lanes);
    Local<size, Pack> u;
    for (int lane = 0; lane < Pack::size; ++lane)
      for (int j = 0; j < size; ++j) u[j].set(lane, this->state(lane, k)[j]);
    const Local<size, Pack> force = pack.force(u);
    const LocalMatrix<size, Pack> stiffness = pack.stiffness(u);
    for (int lane = 0; lane < Pack::size; ++lane) {
      SCOPED_TRACE("state " + std::to_string(k) + ", lane " + std::to_string(lane) + ", component " +
                   std::to_string(lanes[lane]));
      const Local<size> u_lane = this->state(lane, k);
      const double K = this->stiffness_scale(lanes[lane]), L = TypeParam::length;
      if constexpr (PotentialModel<F>) {
        EXPECT_NEAR(pack.energy(u)[lane], components.energy(lanes[lane], u_lane), this->rounding * K * L * L);
      }
      Local<size> f;
      LocalMatrix<size> K_lane;
      for (int j = 0; j < size; ++j) f[j] = force[j][lane];
      for (Index e = 0; e < K_lane.size(); ++e) K_lane.data()[e] = stiffness.data()[e][lane];
      EXPECT_TRUE(is_near(f, components.force(lanes[lane], u_lane), this->rounding * K * L));
      EXPECT_TRUE(is_near(K_lane, components.stiffness(lanes[lane], u_lane), this->rounding * K));
    }
  }
}

REGISTER_TYPED_TEST_SUITE_P(ForceModelConformance, StencilNodesAreDistinctAndInRange,
                            EveryTermIsInEquilibriumAtRest, ForceIsTheGradientOfTheEnergyIfThereIsOne,
                            StiffnessIsTheDerivativeOfTheForce,
                            TangentIsPositiveSemidefiniteAtRestAndSymmetricWherePromised,
                            TranslationsChangeNothingWherePromised,
                            ConstCallsFromSeveralThreadsGiveTheSameBits, PacksEqualTheirTermsLaneByLane);

}  // namespace supple::test
