#pragma once
/// \file Test suite of what every DynamicalSystem promises, typed. A system joins with a factory and one
/// line:
///
///     struct MySystem {
///       static System make();                                    // small; called once a test
///       static Vector deformed(const System&, std::uint64_t seed);  // random; energy defined at 1.01 × it
///       static Vector displacements(const System&, VectorIn u);     // unknowns → 3 n at all nodes, linear
///       static Vector nodal_mass(const System&);                    // n [kg]
///     };
///     INSTANTIATE_TYPED_TEST_SUITE_P(MySystem, DynamicalSystemConformance, MySystem);

#include <core/check.hpp>
#include <core/parallel.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/system/dynamical_system.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <thread>

namespace supple::test {

template <typename Factory>
class DynamicalSystemConformance : public testing::Test {
 protected:
  using System = decltype(Factory::make());
  using MatrixType = typename System::MatrixType;
  static_assert(DynamicalSystem<System>);

  Vector force(VectorIn u) const {
    Vector f(system.dim());
    system.force(u, f);
    return f;
  }
  MatrixType stiffness(VectorIn u) const {
    MatrixType K;
    system.stiffness(u, K);
    return K;
  }
  Vector deformed(std::uint64_t seed) const { return Factory::deformed(system, seed); }
  Index num_nodes() const { return Factory::nodal_mass(system).size(); }
  Point at_node(VectorIn u, Index v) const { return Factory::displacements(system, u).template segment<3>(3 * v); }

  const System system = Factory::make();
};
TYPED_TEST_SUITE_P(DynamicalSystemConformance);

TYPED_TEST_P(DynamicalSystemConformance, MassIsPositiveAndEveryUnknownHasOne) {
  const Vector& mass = this->system.mass();
  ASSERT_EQ(mass.size(), this->system.dim());
  EXPECT_GT(mass.minCoeff(), 0);
  EXPECT_TRUE(mass.allFinite());
}

TYPED_TEST_P(DynamicalSystemConformance, RestIsAnEquilibriumAndAMinimum) {
  const Vector zero = Vector::Zero(this->system.dim()), u = this->deformed(1);
  const double rounding = 1e-12;
  EXPECT_TRUE(is_near(this->force(zero), zero, rounding * (this->stiffness(zero) * u).norm()));
  EXPECT_GT(this->system.energy(u), this->system.energy(zero));
}

// Along a direction d of the size of u, central differences with step ε d err by about ε² |∂³| and by 1e-16 /
// ε: both near 1e-8 relative for ε = 1e-4.
TYPED_TEST_P(DynamicalSystemConformance, ForceIsTheGradientOfTheEnergy) {
  const double epsilon = 1e-4;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Vector u = this->deformed(seed), d = this->deformed(seed + 100);
    const double difference =
        (this->system.energy(u + epsilon * d) - this->system.energy(u - epsilon * d)) / (2 * epsilon);
    const Vector f = this->force(u);
    EXPECT_NEAR(f.dot(d), difference, 1e-6 * f.norm() * d.norm()) << "seed " << seed;
  }
}

TYPED_TEST_P(DynamicalSystemConformance, StiffnessIsTheDerivativeOfTheForce) {
  const double epsilon = 1e-4;
  for (std::uint64_t seed = 0; seed <= 3; ++seed) {
    const Vector d = this->deformed(seed + 100);
    const Vector u = seed == 0 ? Vector(0 * d) : this->deformed(seed);
    const Vector difference = (this->force(u + epsilon * d) - this->force(u - epsilon * d)) / (2 * epsilon);
    const Vector Kd = this->stiffness(u) * d;
    EXPECT_TRUE(is_near(Kd, difference, 1e-6 * Kd.norm())) << "seed " << seed;
  }
}

TYPED_TEST_P(DynamicalSystemConformance, StiffnessIsSymmetricAndReusesItsMatrix) {
  const Vector u = this->deformed(1), other = this->deformed(2);
  auto K = this->stiffness(other);
  this->system.stiffness(u, K);  // overwrites, adds nothing
  const Matrix dense = K;
  EXPECT_TRUE(is_near(dense, dense.transpose(), 1e-12 * dense.norm()));
  EXPECT_TRUE(is_same(dense, Matrix(this->stiffness(u))));
}

TYPED_TEST_P(DynamicalSystemConformance, RestStiffnessIsTheTangentAtRestAndSemidefinite) {
  const Matrix K = this->system.rest_stiffness();
  EXPECT_TRUE(is_near(K, Matrix(this->stiffness(Vector::Zero(this->system.dim()))), 1e-12 * K.norm()));
  ASSERT_TRUE(K.allFinite());
  EXPECT_GE(symmetric_eigenvalues(K)[0], -1e-12 * K.norm());
}

// Virtual work: what the projected load does along u is what the loads do along the displacements of their
// nodes, whatever the unknowns.
TYPED_TEST_P(DynamicalSystemConformance, ProjectedLoadsDoTheWorkOfTheLoads) {
  const Index n = this->num_nodes();
  Loads loads;
  loads.gravity = {0.3, -9.81, 1.2};
  for (Index k = 0; k < 5; ++k)
    loads.forces.push_back({k * (n - 1) / 4, Point(random_vector(3, 10, 200 + static_cast<unsigned>(k)))});
  for (Index k = 0; k < 7; ++k)  // two of them at the last node
    loads.springs.push_back({std::min(n - 1, k * (n - 1) / 5), 50.0 + static_cast<double>(k),
                             Point(random_vector(3, 0.2, 300 + static_cast<unsigned>(k)))});
  const auto load = this->system.project(loads);
  ASSERT_EQ(load.force.size(), this->system.dim());
  ASSERT_TRUE(load.has_stiffness());
  const Vector mass = TypeParam::nodal_mass(this->system);
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Vector u = this->deformed(seed), w = this->deformed(seed + 50);
    const Vector u_nodes = TypeParam::displacements(this->system, u),
                 w_nodes = TypeParam::displacements(this->system, w);
    double work = 0, size = 0, spring_work = 0, spring_size = 0;
    const auto add = [](double& sum, double& magnitude, double term) {
      sum += term;
      magnitude += std::abs(term);
    };
    for (Index v = 0; v < n; ++v) add(work, size, mass[v] * loads.gravity.dot(u_nodes.template segment<3>(3 * v)));
    for (const NodalForce& f : loads.forces) add(work, size, f.force.dot(u_nodes.template segment<3>(3 * f.node)));
    for (const PointSpring& s : loads.springs) {
      add(work, size, s.stiffness * s.displacement.dot(u_nodes.template segment<3>(3 * s.node)));
      add(spring_work, spring_size,
          s.stiffness * w_nodes.template segment<3>(3 * s.node).dot(u_nodes.template segment<3>(3 * s.node)));
    }
    EXPECT_NEAR(load.force.dot(u), work, 1e-12 * size);
    EXPECT_NEAR(w.dot(load.stiffness * u), spring_work, 1e-12 * spring_size);
  }
}

TYPED_TEST_P(DynamicalSystemConformance, NoLoadProjectsToNothing) {
  const auto load = this->system.project({});
  EXPECT_TRUE(is_same(load.force, Vector::Zero(this->system.dim())));
  EXPECT_FALSE(load.has_stiffness());
}

TYPED_TEST_P(DynamicalSystemConformance, WrongSizesAndLoadsThrowAtTheDoor) {
  const Index d = this->system.dim(), n = this->num_nodes();
  Vector f(d);
  typename TestFixture::MatrixType K;
  for (const Index wrong : {Index{0}, d - 1, d + 3}) {
    const Vector u = Vector::Zero(wrong);
    EXPECT_THROW((void)this->system.energy(u), std::invalid_argument);
    EXPECT_THROW(this->system.force(u, f), std::invalid_argument);
    EXPECT_THROW(this->system.stiffness(u, K), std::invalid_argument);
    Vector f_wrong(wrong);
    EXPECT_THROW(this->system.force(Vector::Zero(d), f_wrong), std::invalid_argument);
  }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto expect_throw = [&](const Loads& loads, const char* what) {
    EXPECT_THROW((void)this->system.project(loads), std::invalid_argument) << what;
  };
  expect_throw({.gravity = {0, nan, 0}, .forces = {}, .springs = {}}, "gravity NaN");
  expect_throw({.gravity = Point::Zero(), .forces = {{n, Point::Zero()}}, .springs = {}}, "force past the end");
  expect_throw({.gravity = Point::Zero(), .forces = {{-1, Point::Zero()}}, .springs = {}}, "force at -1");
  expect_throw({.gravity = Point::Zero(), .forces = {{0, {nan, 0, 0}}}, .springs = {}}, "force NaN");
  expect_throw({.gravity = Point::Zero(), .forces = {}, .springs = {{n, 1, Point::Zero()}}}, "spring past the end");
  expect_throw({.gravity = Point::Zero(), .forces = {}, .springs = {{0, 0, Point::Zero()}}}, "no stiffness");
  expect_throw({.gravity = Point::Zero(), .forces = {}, .springs = {{0, nan, Point::Zero()}}}, "stiffness NaN");
  expect_throw({.gravity = Point::Zero(), .forces = {}, .springs = {{0, 1, {0, 0, nan}}}}, "target NaN");
}

TYPED_TEST_P(DynamicalSystemConformance, NumberOfThreadsDoesNotChangeABit) {
  const Vector u = this->deformed(4);
  const int before = num_threads();
  set_num_threads(1);
  const double energy = this->system.energy(u);
  const Vector force = this->force(u);
  const Matrix stiffness = this->stiffness(u);
  for (const int threads : {2, 3}) {
    set_num_threads(threads);
    EXPECT_EQ(this->system.energy(u), energy);
    EXPECT_TRUE(is_same(this->force(u), force));
    EXPECT_TRUE(is_same(Matrix(this->stiffness(u)), stiffness));
  }
  set_num_threads(before);
}

TYPED_TEST_P(DynamicalSystemConformance, ConstCallsFromSeveralThreadsGiveTheSameBits) {
  const auto evaluate = [&](std::uint64_t seed) {
    const Vector u = this->deformed(seed);
    const Matrix K = this->stiffness(u);
    Matrix all(K.rows(), K.cols() + 2);
    all << Vector::Constant(u.size(), this->system.energy(u)), this->force(u), K;
    return all;
  };
  std::array<Matrix, 3> serial, parallel;
  for (std::uint64_t k = 0; k < 3; ++k) serial[k] = evaluate(k);
  {
    std::vector<std::jthread> threads;
    for (std::uint64_t k = 0; k < 3; ++k)
      threads.emplace_back([&parallel, &evaluate, k] {
        for (int repeat = 0; repeat < 5; ++repeat) parallel[k] = evaluate(k);
      });
  }
  for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(is_same(parallel[k], serial[k]));
}

REGISTER_TYPED_TEST_SUITE_P(DynamicalSystemConformance, MassIsPositiveAndEveryUnknownHasOne,
                            RestIsAnEquilibriumAndAMinimum, ForceIsTheGradientOfTheEnergy,
                            StiffnessIsTheDerivativeOfTheForce, StiffnessIsSymmetricAndReusesItsMatrix,
                            RestStiffnessIsTheTangentAtRestAndSemidefinite, ProjectedLoadsDoTheWorkOfTheLoads,
                            NoLoadProjectsToNothing, WrongSizesAndLoadsThrowAtTheDoor, NumberOfThreadsDoesNotChangeABit,
                            ConstCallsFromSeveralThreadsGiveTheSameBits);

}  // namespace supple::test
