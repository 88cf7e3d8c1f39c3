#pragma once
/// \file Test suite of what every ForceModel promises, typed. A model joins with a factory and one line:
///
///     struct MyShell {
///       static MyModel make();                      // small: every component is tested
///       static constexpr double length = 0.1;       // typical distance of neighbouring nodes [m], or temperature
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MyShell, ForceModelConformance, MyShell);
///
/// Random states displace each coordinate by up to 0.12 length; forces (and energy) must be defined there.

#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/model/explain_force_model.hpp>
#include <physics/model/term_pack.hpp>
#include <testing/agreement.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <gtest/gtest.h>

#include <array>
#include <memory>
#include <set>
#include <thread>
#include <vector>

namespace supple::test {

/// The promises of a force model, component by component and state by state: each true, or a sentence that says what is
/// violated.
template <typename Model>
class ForceModelPromises {
 public:
  static_assert(explain_force_model<Model>());
  static constexpr int dofs = Model::local_dofs;
  static constexpr int num_states = 4;

  /// \param length  by which nodes may move [m].
  ForceModelPromises(std::shared_ptr<const Model> model, double length) : model_(std::move(model)), length_(length) {}

  const Model& model() const { return *model_; }

  /// Component `i` in random state `k`; state 0 is at rest.
  Local<dofs> state(Index i, int k) const {
    if (k == 0) return Local<dofs>::Zero();
    return random_vector(dofs, 0.12 * length_, static_cast<std::uint64_t>(1000 * k + i));
  }
  /// The first of promise(i, k) over all states k and components i that does not hold, or true.
  template <typename Promise>
  testing::AssertionResult in_all_states(const Promise& promise) const {
    for (int k = 0; k < num_states; ++k)
      for (Index i = 0; i < model_->num_components(); ++i)
        if (const testing::AssertionResult verdict = promise(i, k); !verdict) return verdict;
    return testing::AssertionSuccess();
  }

  testing::AssertionResult stencil_is_of_distinct_nodes(Index i) const {
    std::set<Index> distinct;
    for (const Index v : std::span<const Index, Model::stencil_size>(model_->stencil(i))) {
      if (v < 0 || v >= model_->num_nodes())
        return testing::AssertionFailure() << text("force model: component ", i, ": stencil: expected nodes 0 to ",
                                                   model_->num_nodes() - 1, ", found ", v);
      if (!distinct.insert(v).second)
        return testing::AssertionFailure()
               << text("force model: component ", i, ": stencil: expected distinct nodes, found ", v, " twice");
    }
    return testing::AssertionSuccess();
  }

  testing::AssertionResult is_in_equilibrium_at_rest(Index i) const {
    return agree(where(i, 0) + "there is force at rest", force_entry(i), model_->force(i, state(i, 0)),
                 Local<dofs>::Zero(), rounding * scale(i) * length_);
  }

  testing::AssertionResult force_is_the_gradient_of_the_energy(Index i, int k) const requires PotentialModel<Model> {
    const Local<dofs> u = state(i, k);
    Local<dofs> differences;
    for (int j = 0; j < dofs; ++j)
      differences[j] = (model_->energy(i, moved(u, j, h())) - model_->energy(i, moved(u, j, -h()))) / (2 * h());
    return agree(where(i, k) + "force is not the gradient of the energy", force_entry(i), model_->force(i, u),
                 differences, difference_tolerance * scale(i) * length_, " by differences of the energy");
  }
  testing::AssertionResult stiffness_is_the_derivative_of_the_force(Index i, int k) const {
    const Local<dofs> u = state(i, k);
    LocalMatrix<dofs> differences;
    for (int j = 0; j < dofs; ++j)
      differences.col(j) = (model_->force(i, moved(u, j, h())) - model_->force(i, moved(u, j, -h()))) / (2 * h());
    return agree(where(i, k) + "stiffness is not the derivative of the force", stiffness_entry(i),
                 model_->stiffness(i, u), differences, difference_tolerance * scale(i), " by differences of the force");
  }

  testing::AssertionResult tangent_is_symmetric(Index i, int k) const {
    const LocalMatrix<dofs> K = model_->stiffness(i, state(i, k));
    return agree(where(i, k) + "stiffness is not symmetric", stiffness_entry(i), K, K.transpose(), rounding * scale(i),
                 " as its mirror image");
  }
  testing::AssertionResult tangent_is_semidefinite_at_rest(Index i) const {
    const Matrix K = model_->stiffness(i, state(i, 0));
    const Vector eigenvalues = K.allFinite() ? symmetric_eigenvalues(K) : Vector::Constant(1, std::nan(""));
    if (eigenvalues.minCoeff() >= -rounding * K.norm()) return testing::AssertionSuccess();
    return testing::AssertionFailure() << where(i, 0)
                                       << text(
                                              "stiffness is not positive semi-definite at rest: smallest eigenvalue: "
                                              "expected >= 0, found ",
                                              eigenvalues.minCoeff(), ", largest ", eigenvalues.maxCoeff());
  }
  /// ‖K − Kᵀ‖ relative to the stiffness at rest, the largest there is.
  double asymmetry() const {
    double largest = 0;
    for (int k = 0; k < num_states; ++k)
      for (Index i = 0; i < model_->num_components(); ++i) {
        const LocalMatrix<dofs> K = model_->stiffness(i, state(i, k));
        largest = std::max(largest, (K - K.transpose()).norm() / scale(i));
      }
    return largest;
  }

  testing::AssertionResult translation_changes_nothing(Index i, int k) const {
    const Local<dofs> u = state(i, k), there = u + translation();
    if constexpr (PotentialModel<Model>) {
      const auto verdict = agree(where(i, k) + moves, "energy", model_->energy(i, there), model_->energy(i, u),
                                 rounding * scale(i) * length_ * length_);
      if (!verdict) return verdict;
    }
    return agree(where(i, k) + moves, force_entry(i), model_->force(i, there), model_->force(i, u),
                 rounding * scale(i) * length_);
  }
  testing::AssertionResult translation_changes_something() const {
    const Local<dofs> u = state(0, 1), there = u + translation();
    if ((model_->force(0, there) - model_->force(0, u)).norm() > 1e-3 * scale(0) * u.norm())
      return testing::AssertionSuccess();
    return testing::AssertionFailure() << "force model: translations do not change the force: expected `static "
                                          "constexpr bool translation_invariant "
                                          "= true`, for work and storage of a reduced term then fall by a node";
  }

  /// Pack of these components, component of lane l in state(l, k).
  testing::AssertionResult pack_equals_its_terms(const PackIndices& lanes, int k) const {
    const TermPack<Model> pack(model_, lanes);
    Local<dofs, Pack> u;
    for (int lane = 0; lane < Pack::size; ++lane)
      for (int j = 0; j < dofs; ++j) u[j].set(lane, state(lane, k)[j]);
    const Local<dofs, Pack> force = pack.force(u);
    const LocalMatrix<dofs, Pack> stiffness = pack.stiffness(u);
    for (int lane = 0; lane < Pack::size; ++lane) {
      const Index i = lanes[lane];
      const Local<dofs> u_lane = state(lane, k);
      const std::string claim = where(i, k) + text("lane ", lane, " of a pack differs from the component");
      if constexpr (PotentialModel<Model>) {
        const auto verdict = agree(claim, "energy", pack.energy(u)[lane], model_->energy(i, u_lane),
                                   rounding * scale(i) * length_ * length_);
        if (!verdict) return verdict;
      }
      Local<dofs> f;
      LocalMatrix<dofs> K;
      for (int j = 0; j < dofs; ++j) f[j] = force[j][lane];
      for (Index e = 0; e < K.size(); ++e) K.data()[e] = stiffness.data()[e][lane];
      const auto verdict =
          all_hold(agree(claim, force_entry(i), f, model_->force(i, u_lane), rounding * scale(i) * length_),
                   agree(claim, stiffness_entry(i), K, model_->stiffness(i, u_lane), rounding * scale(i)));
      if (!verdict) return verdict;
    }
    return testing::AssertionSuccess();
  }

 private:
  static constexpr const char* moves = "promises translation_invariant, but changes when all its nodes move alike";
  /// Central differences err by h² ∂³ and by rounding / h: with h = ε^⅓ L both are about 1e-10 of K L (times
  /// constants of the model), so what is off by more than 1e-7 is another function.
  static constexpr double difference_tolerance = 1e-7;
  static constexpr double rounding = 1e-12;  // a few thousand operations
  double h() const { return 1e-5 * length_; }
  double scale(Index i) const { return model_->stiffness(i, state(i, 0)).norm(); }

  static Local<dofs> moved(Local<dofs> u, int j, double by) {
    u[j] += by;
    return u;
  }
  Local<dofs> translation() const {
    const Vector t = random_vector(Model::node_dim, 3 * length_, 77);
    Local<dofs> all;
    for (int j = 0; j < dofs; ++j) all[j] = t[j % Model::node_dim];
    return all;
  }

  static std::string where(Index i, int k) { return text("force model: component ", i, ", state ", k, ": "); }
  /// "5 (node 17, z)": an unknown of component i.
  std::string unknown(Index i, Index j) const {
    const Index node = std::span<const Index, Model::stencil_size>(model_->stencil(i))[j / Model::node_dim];
    if constexpr (Model::node_dim == 3) return text(j, " (node ", node, ", ", "xyz"[j % 3], ")");
    return text(j, " (node ", node, ")");
  }
  auto force_entry(Index i) const {
    return [this, i](Index j, Index) { return "force[" + unknown(i, j) + "]"; };
  }
  auto stiffness_entry(Index i) const {
    return [this, i](Index j, Index k) { return "stiffness[" + unknown(i, j) + "][" + unknown(i, k) + "]"; };
  }

  std::shared_ptr<const Model> model_;
  double length_;
};

template <typename Factory>
class ForceModelConformance : public testing::Test {
 protected:
  using Model = decltype(Factory::make());
  static constexpr int dofs = Model::local_dofs;

  const ForceModelPromises<Model> terms{std::make_shared<const Model>(Factory::make()), Factory::length};
};
TYPED_TEST_SUITE_P(ForceModelConformance);

TYPED_TEST_P(ForceModelConformance, StencilNodesAreDistinctAndInRange) {
  ASSERT_GT(this->terms.model().num_components(), 0);
  for (Index i = 0; i < this->terms.model().num_components(); ++i)
    EXPECT_TRUE(this->terms.stencil_is_of_distinct_nodes(i));
}

TYPED_TEST_P(ForceModelConformance, EveryTermIsInEquilibriumAtRest) {
  for (Index i = 0; i < this->terms.model().num_components(); ++i)
    EXPECT_TRUE(this->terms.is_in_equilibrium_at_rest(i));
}

TYPED_TEST_P(ForceModelConformance, ForceIsTheGradientOfTheEnergyIfThereIsOne) {
  if constexpr (PotentialModel<typename TestFixture::Model>) {
    EXPECT_TRUE(this->terms.in_all_states(
        [&](Index i, int k) { return this->terms.force_is_the_gradient_of_the_energy(i, k); }));
  }
}

TYPED_TEST_P(ForceModelConformance, StiffnessIsTheDerivativeOfTheForce) {
  EXPECT_TRUE(this->terms.in_all_states(
      [&](Index i, int k) { return this->terms.stiffness_is_the_derivative_of_the_force(i, k); }));
}

TYPED_TEST_P(ForceModelConformance, TangentIsPositiveSemidefiniteAtRestAndSymmetricWherePromised) {
  constexpr bool symmetric = has_symmetric_tangent<typename TestFixture::Model>();
  for (Index i = 0; i < this->terms.model().num_components(); ++i) {
    EXPECT_TRUE(this->terms.tangent_is_symmetric(i, 0));
    EXPECT_TRUE(this->terms.tangent_is_semidefinite_at_rest(i));
  }
  if (symmetric) {
    EXPECT_TRUE(this->terms.in_all_states([&](Index i, int k) { return this->terms.tangent_is_symmetric(i, k); }));
  } else {
    EXPECT_GT(this->terms.asymmetry(), 1e-3) << "symmetric, then do not deny it: it halves the work";
  }
}

TYPED_TEST_P(ForceModelConformance, TranslationsChangeNothingWherePromised) {
  using F = typename TestFixture::Model;
  if constexpr (is_translation_invariant<F>()) {
    static_assert(num_active_dofs<F> == F::local_dofs - F::node_dim);
    EXPECT_TRUE(
        this->terms.in_all_states([&](Index i, int k) { return this->terms.translation_changes_nothing(i, k); }));
  } else {
    static_assert(num_active_dofs<F> == F::local_dofs);
    EXPECT_TRUE(this->terms.translation_changes_something());
  }
}

TYPED_TEST_P(ForceModelConformance, ConstCallsFromSeveralThreadsGiveTheSameBits) {
  const auto& components = this->terms.model();
  constexpr int size = TestFixture::dofs;
  const auto evaluate = [&] {
    Matrix all = Matrix::Zero((size + 2) * components.num_components(), size);
    for (Index i = 0; i < components.num_components(); ++i) {
      const Local<size> u = this->terms.state(i, 1);
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
  Random random(5);
  for (int k = 0; k < 10; ++k) {
    PackIndices lanes;
    for (Index& i : lanes) i = random.below(this->terms.model().num_components());  // any order, repetitions, too
    EXPECT_TRUE(this->terms.pack_equals_its_terms(lanes, k));
  }
}

REGISTER_TYPED_TEST_SUITE_P(ForceModelConformance, StencilNodesAreDistinctAndInRange, EveryTermIsInEquilibriumAtRest,
                            ForceIsTheGradientOfTheEnergyIfThereIsOne, StiffnessIsTheDerivativeOfTheForce,
                            TangentIsPositiveSemidefiniteAtRestAndSymmetricWherePromised,
                            TranslationsChangeNothingWherePromised, ConstCallsFromSeveralThreadsGiveTheSameBits,
                            PacksEqualTheirTermsLaneByLane);

}  // namespace supple::test
