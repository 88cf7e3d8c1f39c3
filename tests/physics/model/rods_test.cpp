#include <numerics/linear/symmetric_eigen.hpp>
#include <numerics/optimize/newton.hpp>
#include <physics/model/elastic_rod.hpp>
#include <physics/model/spring_model.hpp>
#include <physics/statics/equilibrium.hpp>
#include <physics/system/full_system.hpp>
#include <testing/force_model_conformance.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/rounding.hpp>
#include <tests/support/spring_network.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

namespace supple::test {
namespace {

using Mat3 = Matrix3<double>;
constexpr double pi = std::numbers::pi;

struct SpringLattice {
  static constexpr double length = 0.1;
  static TetMesh mesh() { return perturbed(kuhn_box(2, 1, 1, length), 0.1 * length, 11); }
  static SpringModel make() {
    const auto springs = mesh_edges(mesh());
    return {mesh().nodes, springs, Vector::LinSpaced(static_cast<Index>(springs.size()), 100, 400)};
  }
};

/// 0, 1, …, count − 1.
std::vector<Index> chain(Index count) {
  std::vector<Index> nodes(count);
  std::iota(nodes.begin(), nodes.end(), Index{0});
  return nodes;
}

/// Nodes on a line along `direction`, `edge` [m] apart.
Points line(Index num_edges, double edge, const Point& direction = Point::UnitX()) {
  Points nodes(num_edges + 1, 3);
  for (Index v = 0; v <= num_edges; ++v)
    nodes.row(v) = edge * static_cast<double>(v) * direction.normalized().transpose();
  return nodes;
}

/// As stiff in bending as in stretching at this edge length, so that neither hides the other.
RodMaterial balanced(double edge) {
  return RodMaterial::from(1e5, 2 * edge);
}

/// Edges of different lengths along a line askew, an end edge at either side.
struct StraightRod {
  static constexpr double length = 0.1;
  static ElasticRod make() {
    Points nodes = line(6, length, {1, 2, -1});
    nodes.row(2) += 0.2 * (nodes.row(3) - nodes.row(2));
    return {nodes, {chain(7)}, balanced(length)};
  }
};
/// Bent at rest by up to 100 degrees; a closed ring shares a node with it.
struct BentRods {
  static constexpr double length = 0.1;
  static ElasticRod make() {
    Points nodes = 0.8 * length * Points(random_matrix(11, 3, 1, 17));
    for (Index v = 0; v < 6; ++v) nodes.row(v) += line(5, length).row(v) * 2;
    for (Index v = 5; v < 11; ++v) {
      const double angle = 2 * pi * static_cast<double>(v) / 6;
      nodes.row(v) = 0.4 * nodes.row(v) + 2 * length * Eigen::RowVector3d(std::cos(angle), std::sin(angle), 0);
    }
    return {nodes, {chain(6), {5, 6, 7, 8, 9, 10, 5}}, {balanced(length), balanced(0.8 * length)}};
  }
};

TEST(SpringModel, AgreesWithAFormulaOfItsOwn) {
  const TetMesh mesh = SpringLattice::mesh();
  const SpringModel springs(mesh.nodes, mesh_edges(mesh), 250.0);
  const SpringNetwork other = edge_springs(mesh, 250);
  ASSERT_EQ(springs.num_components(), other.num_components());
  for (Index i = 0; i < springs.num_components(); ++i) {
    const Local<6> u = random_vector(6, 0.05, i);
    EXPECT_NEAR(springs.energy(i, u), other.energy(i, u), rounding * 250 * 0.01);
    EXPECT_TRUE(is_near(springs.force(i, u), other.force(i, u), rounding * 250 * 0.1));
    EXPECT_TRUE(is_near(springs.stiffness(i, u), other.stiffness(i, u), rounding * 250));
  }
}

// A plain |d| − L loses eight of sixteen digits here.
TEST(SpringModel, KeepsTheDigitsOfTinyStretches) {
  const SpringModel spring(line(1, 0.3, {1, 1, 1}), {{0, 1}}, 7.0);
  const Point t = Point(1, 1, 1).normalized();
  Local<6> u = Local<6>::Zero();
  u.tail<3>() = 1e-8 * t;
  EXPECT_NEAR(spring.energy(0, u), 0.5 * 7 * 1e-16, 1e-12 * 7e-16);
  EXPECT_TRUE(is_near(spring.force(0, u).tail<3>(), 7e-8 * t, 1e-12 * 7e-8));
}

TEST(SpringModel, PullsNowhereWhereItHasCollapsed) {
  const SpringModel spring(line(1, 0.3), {{0, 1}}, 7.0);
  Local<6> u = Local<6>::Zero();
  u[0] = 0.3;
  EXPECT_DOUBLE_EQ(spring.energy(0, u), 0.5 * 7 * 0.09);
  EXPECT_TRUE(spring.force(0, u).isZero(0));
  EXPECT_TRUE(spring.stiffness(0, u).allFinite());
}

TEST(SpringModel, RefusesSpringsThatCannotBe) {
  const Points two = line(1, 0.3);
  EXPECT_THROW(SpringModel(two, {{0, 2}}, 1.0), std::invalid_argument);
  EXPECT_THROW(SpringModel(two, {{-1, 1}}, 1.0), std::invalid_argument);
  EXPECT_THROW(SpringModel(two, {{1, 1}}, 1.0), std::invalid_argument);
  EXPECT_THROW(SpringModel(Points::Zero(2, 3), {{0, 1}}, 1.0), std::invalid_argument);
  EXPECT_THROW(SpringModel(two, {{0, 1}}, 0.0), std::invalid_argument);
  EXPECT_THROW(SpringModel(two, {{0, 1}}, Vector::Ones(2)), std::invalid_argument);
}

/// Three nodes that turn by `rest_angle` at rest; nothing resists stretching.
ElasticRod bend_only(double rest_angle) {
  Points nodes(3, 3);
  nodes << -0.1, 0, 0, 0, 0, 0, 0.12 * std::cos(rest_angle), 0.12 * std::sin(rest_angle), 0;
  return {nodes, {chain(3)}, {.stretch = 0, .bending = 0.3}};
}

/// Displacements after which the rod turns by `angle` in a plane askew, its edges 10 and 20 % longer.
Local<9> turned_by(double angle, const ElasticRod& rod) {
  Points now(3, 3);
  now << -0.11, 0, 0, 0, 0, 0, 0.144 * std::cos(angle), 0.144 * std::sin(angle), 0;
  now = (now * random_rotation(12).transpose()).rowwise() + Eigen::RowVector3d(0.2, 0.1, -0.3);
  const Points u = now - rod.rest_positions();
  return Eigen::Map<const Vector>(u.data(), 9);
}

/// Bending alone, against differences scaled with bending alone.
void expect_derivatives(const ElasticRod& rod, const Local<9>& u) {
  constexpr double h = 1e-6;
  Local<9> f;
  LocalMatrix<9> K;
  for (int j = 0; j < 9; ++j) {
    Local<9> plus = u, minus = u;
    plus[j] += h;
    minus[j] -= h;
    f[j] = (rod.energy(0, plus) - rod.energy(0, minus)) / (2 * h);
    K.col(j) = (rod.force(0, plus) - rod.force(0, minus)) / (2 * h);
  }
  const double scale = rod.stiffness(0, u).norm();
  EXPECT_TRUE(is_near(rod.force(0, u), f, 1e-8 * scale * 0.1));
  EXPECT_TRUE(is_near(rod.stiffness(0, u), K, 1e-7 * scale));
}

TEST(ElasticRod, BendingHasExactDerivativesNearStraightAndStronglyBent) {
  for (const double rest : {0.0, 0.3, 1.8})
    for (const double angle : {0.0, 1e-9, 1e-5, 1e-2, 0.1, 0.5, 1.5, 2.5, 2.9}) {
      if (rest > 0 && angle < 0.1)
        continue;  // the energy of a rod that is bent at rest has a kink where it is straight
      SCOPED_TRACE("bent by " + std::to_string(rest) + " at rest, by " + std::to_string(angle) + " now");
      const ElasticRod rod = bend_only(rest);
      expect_derivatives(rod, turned_by(angle, rod));
    }
}

TEST(ElasticRod, BendingDependsOnTheAngleAlone) {
  for (const double rest : {0.0, 0.7})
    for (const double angle : {1e-4, 0.1, 2.0}) {
      const ElasticRod rod = bend_only(rest);
      const double bend = 2 * std::tan(angle / 2), rest_bend = 2 * std::tan(rest / 2);
      const double expected = 0.5 * (0.3 / 0.11) * (bend - rest_bend) * (bend - rest_bend);
      EXPECT_NEAR(rod.energy(0, turned_by(angle, rod)), expected,
                  1e-11 * expected);  // the angle is rounded, too
    }
}

// Angles from coordinates as such would err by 1e-16 / 1e-10.
TEST(ElasticRod, KeepsTheDigitsOfTinyDeflections) {
  const ElasticRod rod(line(2, 0.1, {1, 2, -1}), {chain(3)}, {.stretch = 0, .bending = 0.3});
  const Point across = Point(2, -1, 0).normalized();
  Local<9> u = Local<9>::Zero();
  u.segment<3>(3) = 1e-10 * across;  // φ = 2 · 1e-10 / 0.1
  EXPECT_NEAR(rod.energy(0, u), 0.5 * 3 * 4e-18, 1e-12 * 6e-18);
  EXPECT_TRUE(is_near(rod.force(0, u).segment<3>(3), 3 * 400 * 1e-10 * across, 1e-12 * 1.2e-7));
}

TEST(ElasticRod, StraightRodsBendAlikeInAllDirectionsWhateverTheRounding) {
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    const Points nodes = line(2, 0.1, random_vector(3, 1, seed)).cast<float>().cast<double>();
    const ElasticRod rod(nodes, {chain(3)}, {.stretch = 0, .bending = 0.3});
    EXPECT_TRUE(rod.force(0, Local<9>::Zero()).isZero(0));
    const Vector eigenvalues = symmetric_eigenvalues(rod.stiffness(0, Local<9>::Zero()));
    const double k = 3 * 100 * 6;  // E I / l³ (1, −2, 1)²
    EXPECT_LT(eigenvalues.head<7>().cwiseAbs().maxCoeff(), 1e-5 * k);
    EXPECT_TRUE(is_near(eigenvalues.tail<2>(), Vector::Constant(2, k), 1e-5 * k));
  }
}

TEST(ElasticRod, RigidMotionsCostNothing) {
  const ElasticRod rods = BentRods::make();
  const FullSystem system(rods, Vector::Ones(rods.num_nodes()));
  const Vector u = affine_displacement(rods.rest_positions(), random_rotation(3), {0.3, -2, 1});
  const double K = system.rest_stiffness().norm();
  EXPECT_NEAR(system.energy(u), 0, rounding * K * 0.01);
  EXPECT_TRUE(is_near(system.force(u), Vector::Zero(u.size()), rounding * K * 0.1));
}

TEST(ElasticRod, ForcesHaveNoResultantAndNoMoment) {
  const ElasticRod rods = BentRods::make();
  const FullSystem system(rods, Vector::Ones(rods.num_nodes()));
  const Vector u = random_vector(system.dim(), 0.02, 6);
  const Vector f = system.force(u);
  Point resultant = Point::Zero(), moment = Point::Zero();
  for (Index v = 0; v < rods.num_nodes(); ++v) {
    resultant += f.segment<3>(3 * v);
    const Point x = rods.rest_positions().row(v).transpose() + u.segment<3>(3 * v);
    moment += x.cross(Point(f.segment<3>(3 * v)));
  }
  EXPECT_TRUE(is_near(resultant, Point::Zero(), rounding * f.norm()));
  EXPECT_TRUE(is_near(moment, Point::Zero(), rounding * f.norm()));
}

TEST(ElasticRod, EveryEdgeIsStretchedOnce) {
  const double growth = 0.01;
  for (const ElasticRod& rods : {StraightRod::make(), BentRods::make()}) {
    const Vector u = affine_displacement(rods.rest_positions(), (1 + growth) * Mat3::Identity());
    const FullSystem system(rods, Vector::Ones(rods.num_nodes()));
    const bool is_straight = rods.num_components() == 5;
    const auto length = [&](Index from, Index to) {
      return (rods.rest_positions().row(to) - rods.rest_positions().row(from)).norm();
    };
    double expected = 0;  // ½ E A ε² a length
    for (Index v = 0; v + 1 < (is_straight ? 7 : 6); ++v) expected += balanced(0.1).stretch * length(v, v + 1);
    if (!is_straight)
      for (Index v = 5; v < 11; ++v) expected += balanced(0.08).stretch * length(v, v == 10 ? 5 : v + 1);
    expected *= 0.5 * growth * growth;
    EXPECT_NEAR(system.energy(u), expected, 1e-10 * expected);  // angles do not change, κ − κ̄ is 1e-16
  }
}

/// Bending energy of a straight rod of length 1 and E I = 2 bent to a circle, over that of the smooth circle
/// on the part of the rod that bends: without half an edge at either end.
double circle_energy_ratio(Index n) {
  const double l = 1.0 / static_cast<double>(n), angle = 2 * pi * l;
  const ElasticRod rod(line(n, l), {chain(n + 1)}, {.stretch = 100, .bending = 2});
  Vector u(3 * (n + 1));
  Point now = Point::Zero();
  for (Index v = 0; v <= n; ++v) {
    u.segment<3>(3 * v) = now - rod.rest_positions().row(v).transpose();
    const double direction = angle * static_cast<double>(v);
    now += l * Point(0, std::cos(direction), std::sin(direction));
  }
  const double energy = FullSystem(rod, Vector::Ones(n + 1)).energy(u);
  const double exact = 0.5 * (2 / l) * 4 * std::pow(std::tan(angle / 2), 2) * static_cast<double>(n - 1);
  EXPECT_NEAR(energy, exact, 1e-11 * exact) << n << " edges";
  return energy / (0.5 * 2 * 4 * pi * pi * (1 - l));
}

TEST(ElasticRod, CirclesHaveTheirBendingEnergyToSecondOrder) {
  const double coarse = circle_energy_ratio(24) - 1, fine = circle_energy_ratio(48) - 1;
  EXPECT_NEAR(coarse, std::pow(2 * pi / 24, 2) / 6, 1e-3);  // (tan(φ/2) / (φ/2))²
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.03);
}

/// A cantilever of E I = 1 that stretches hardly: clamped by its first edge, loaded across at its tip. The
/// clamp of the beam that it stands for is amid that edge, so `length` is that of the other edges and a half.
struct Cantilever {
  Index n;  // free edges
  double length = 1, l = length / (static_cast<double>(n) + 0.5);
  FullSystem<ElasticRod> system{
      ElasticRod(line(n + 1, l), {chain(n + 2)}, {.stretch = 1e6, .bending = 1}), Vector::Ones(n + 2), {0, 1}};

  Vector tip_load(double P) const {
    Vector f = Vector::Zero(system.dim());
    f[system.dim() - 2] = P;
    return f;
  }
};

TEST(ElasticRod, SmallDeflectionsAreThoseOfEulerAndBernoulli) {
  std::array<double, 2> errors;
  for (int k = 0; k < 2; ++k) {
    const Cantilever beam{.n = 10 << k};
    SpdSolver<SparseMatrix> solver;
    ASSERT_TRUE(solver.factorize(beam.system.rest_stiffness()));
    const double tip = solver.solve(beam.tip_load(1))[beam.system.dim() - 2];
    const double N = static_cast<double>(beam.n);
    // every inner node turns by moment · l / E I
    EXPECT_NEAR(tip, std::pow(beam.l, 3) * N * (N + 1) * (2 * N + 1) / 6, 1e-8);
    errors[k] = std::abs(tip - 1.0 / 3);  // P L³ / (3 E I)
  }
  EXPECT_LT(errors[1], 1e-3);
  EXPECT_NEAR(std::log2(errors[0] / errors[1]), 2, 0.1);
}

// P L² / (E I) = 5, tip 0.3876283607 back and 0.7137915236 across: θ'' = −5 cos θ, θ(0) = 0, θ'(1) = 0, by
// Runge and Kutta with 1000 steps and bisection for θ'(0); Mattiasson 1981 has 0.38763 and 0.71379.
TEST(ElasticRod, LargeDeflectionsAreThoseOfTheElastica) {
  const Cantilever beam{.n = 60};
  Equilibrium problem(beam.system, SystemLoad<SparseMatrix>{Vector::Zero(beam.system.dim()), {}});
  SpdSolver<SparseMatrix> solver;
  Vector u = Vector::Zero(beam.system.dim());
  for (const double P : {0.5, 1.5, 3.0, 5.0}) {
    Equilibrium loaded(beam.system, SystemLoad<SparseMatrix>{beam.tip_load(P), {}});
    ASSERT_EQ(Newton{}(loaded, solver, u, {.tolerance = 1e-8, .max_iterations = 200}).status, Status::Converged);
  }
  const Point tip = u.tail<3>();
  EXPECT_TRUE(is_near(tip, Point(-0.3876283607, 0.7137915236, 0), 2e-4));  // 1 / n² times a half
}

TEST(ElasticRod, RefusesRodsThatCannotBe) {
  const Points four = line(3, 0.1);
  const RodMaterial material{.stretch = 1, .bending = 1};
  EXPECT_NO_THROW(ElasticRod(four, {chain(4)}, material));
  EXPECT_THROW(ElasticRod(four, {{0, 1}}, material), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {{0, 1, 0}}, material), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {{0, 1, 4}}, material), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {{0, 1, -1}}, material), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {{0, 1, 1}}, material), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {{0, 2, 1}}, material), std::invalid_argument) << "folds back";
  EXPECT_THROW(ElasticRod(four, {chain(4)}, std::vector<RodMaterial>(2, material)), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {chain(4)}, {.stretch = -1, .bending = 1}), std::invalid_argument);
  EXPECT_THROW(ElasticRod(four, {chain(4)}, RodMaterial{}), std::invalid_argument);
  EXPECT_THROW((void)RodMaterial::from(0, 1), std::invalid_argument);
  EXPECT_THROW((void)RodMaterial::from(1, 0), std::invalid_argument);
  EXPECT_NEAR(RodMaterial::from(2e5, 0.01).stretch, 2e5 * pi * 1e-4, 1e-9);
  EXPECT_NEAR(RodMaterial::from(2e5, 0.01).bending, 2e5 * pi * 1e-8 / 4, 1e-14);
}

}  // namespace

INSTANTIATE_TYPED_TEST_SUITE_P(SpringLattice, ForceModelConformance, SpringLattice);
INSTANTIATE_TYPED_TEST_SUITE_P(StraightRod, ForceModelConformance, StraightRod);
INSTANTIATE_TYPED_TEST_SUITE_P(BentRods, ForceModelConformance, BentRods);

}  // namespace supple::test
