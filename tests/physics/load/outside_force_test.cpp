#include <physics/load/follower_pressure.hpp>
#include <physics/load/outside_force_library.hpp>
#include <physics/load/penalty_floor.hpp>
#include <physics/statics/static_solver.hpp>
#include <physics/time/newmark.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/system/galerkin_system.hpp>
#include <reduction/system/reduced_system.hpp>
#include <testing/near.hpp>
#include <testing/outside_force_conformance.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

namespace supple::test {

/// A floor amid the bar, so that some nodes are below it.
struct FloorAmidABar {
  static PenaltyFloor make() {
    const TetMesh mesh = bar_mesh();
    return {mesh.nodes,
            bar_end(mesh),
            Vector::LinSpaced(static_cast<Index>(bar_end(mesh).size()), 0.1, 0.3),
            {.axis = FloorAxis::Z, .height = 0.1, .stiffness = 500}};
  }
  static double reach() { return 0.3; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Floor, OutsideForceConformance, FloorAmidABar);

/// On an open part of a surface.
struct PressureOnABar {
  static FollowerPressure make() {
    std::vector<Triangle> triangles = boundary_faces(bar_mesh());
    triangles.resize(20);
    return {bar_mesh().nodes, triangles, {.pressure = 300}};
  }
  static double reach() { return 0.05; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Pressure, OutsideForceConformance, PressureOnABar);

/// Springs between two nodes and points in space, coupled by one more between the nodes: as a user would write it.
struct Springs {
  std::vector<Index> touched{40, 50};
  double to_space = 30, between = 20;
  Points targets = (Points(2, 3) << 0.1, 0, 0, 0, 0.05, -0.02).finished();

  std::span<const Index> nodes() const { return touched; }
  void force(const Points& u, Points& f) const {
    f = to_space * (targets - u);
    const Eigen::RowVector3d pull = between * (u.row(1) - u.row(0));
    f.row(0) += pull;
    f.row(1) -= pull;
  }
  double potential(const Points& u) const {
    return 0.5 * to_space * (u - targets).squaredNorm() + 0.5 * between * (u.row(1) - u.row(0)).squaredNorm();
  }
  void stiffness(const Points&, ForceGradient& K) const {
    const Matrix3<double> I = Matrix3<double>::Identity();
    for (const Index a : {0, 1}) {
      K.add(a, a, (to_space + between) * I);
      K.add(a, 1 - a, -between * I);
    }
  }
};
struct SpringsOfOnesOwn {
  static Springs make() { return {}; }
  static double reach() { return 0.2; }
};
INSTANTIATE_TYPED_TEST_SUITE_P(Springs, OutsideForceConformance, SpringsOfOnesOwn);

namespace {

// A closed surface under pressure: no force, no moment, and −p times the volume is the potential.
TEST(FollowerPressure, IsTheGradientOfPressureTimesTheVolume) {
  const TetMesh mesh = bar_mesh();
  const double p = 250;
  const FollowerPressure pressure(mesh.nodes, boundary_faces(mesh), {.pressure = p});
  const Index k = static_cast<Index>(pressure.nodes().size());
  const Vector flat = random_vector(3 * k, 0.02, 3);
  const Points u = Eigen::Map<const Points>(flat.data(), k, 3);
  Points f;
  pressure.force(u, f);
  const Points x = mesh.nodes(std::vector<Index>(pressure.nodes().begin(), pressure.nodes().end()), Eigen::all) + u;
  Point moment = Point::Zero();
  for (Index a = 0; a < k; ++a) moment += Point(x.row(a)).cross(Point(f.row(a)));
  EXPECT_LT(f.colwise().sum().norm(), 1e-12 * f.rowwise().norm().sum());
  EXPECT_LT(moment.norm(), 1e-12 * f.rowwise().norm().sum());
  const auto volume = [&](const Points& displacements) {
    TetMesh moved = mesh;
    for (Index a = 0; a < k; ++a)
      moved.nodes.row(pressure.nodes()[static_cast<std::size_t>(a)]) += displacements.row(a);
    double sum = 0;
    for (Index e = 0; e < moved.num_cells(); ++e) sum += cell_volume(moved, e);
    return sum;
  };
  const Vector flat_way = random_vector(3 * k, 1, 4);
  const Points way = Eigen::Map<const Points>(flat_way.data(), k, 3);
  const double h = 1e-5;
  EXPECT_NEAR(f.cwiseProduct(way).sum(), -p * (volume(u + h * way) - volume(u - h * way)) / (2 * h), 1e-7 * p);
}

TEST(FollowerPressure, RefusesNoSurfaceAndWhatIsNotANumber) {
  const TetMesh mesh = bar_mesh();
  EXPECT_THROW(FollowerPressure(mesh.nodes, {}, {.pressure = 1}), std::invalid_argument);
  EXPECT_THROW(FollowerPressure(mesh.nodes, {{0, 1, 1000}}, {.pressure = 1}), std::invalid_argument);
  EXPECT_THROW(FollowerPressure(mesh.nodes, boundary_faces(mesh), {.pressure = std::nan("")}), std::invalid_argument);
}

using testing::HasSubstr;
using testing::ThrowsMessage;

/// A drag towards a wind that turns about z: no potential, no derivative.
struct Whirl {
  std::vector<Index> touched;
  double strength = 0;
  std::span<const Index> nodes() const { return touched; }
  void force(const Points& u, Points& f) const {
    f.resize(u.rows(), 3);
    for (Index a = 0; a < u.rows(); ++a) f.row(a) << -strength * (0.2 + u(a, 1)), strength * (0.2 + u(a, 0)), 0.0;
  }
};
static_assert(OutsideForce<Whirl> && !PotentialOutsideForce<Whirl> && !StiffOutsideForce<Whirl>);

/// The bar in full, and reduced with few components in a Kronecker and a dense basis.
struct Bars {
  std::shared_ptr<const StvkBar> full = std::make_shared<const StvkBar>(clamped_bar());
  template <typename Basis>
  auto reduced(Basis basis) const {
    const std::vector<Index> few{0, 7, 30};
    const Index d = basis.dim();
    return ReducedSystem(full->shared_model(), std::make_shared<const Basis>(std::move(basis)), few,
                         Vector::Constant(3, 5.0), Matrix::Identity(d, d), full->nodal_mass());
  }
};

TEST(OutsideForce, IsTheSameInFullAndOnTheRowsOfABasisWhateverIsSelected) {
  const Bars bars;
  const Loads loads{.others = {Springs{}}};
  const auto full = bars.full->project(loads);
  const auto check = [&](const auto& basis) {
    const auto load = bars.reduced(basis).project(loads);
    const Vector q = random_vector(basis.dim(), 0.05, 3), u = bars.full->restrict(basis.reconstruct(q));
    ASSERT_TRUE(load.has_pull() && load.has_potential());
    EXPECT_NEAR(load.pull_energy(q), full.pull_energy(u), 1e-12 * full.pull_energy(u));
    const Vector expected = basis.project(bars.full->expand(full.at(u)));
    EXPECT_TRUE(is_near(load.at(q), expected, 1e-12 * expected.norm()));
    Matrix K = Matrix::Zero(basis.dim(), basis.dim()), differences = K;
    load.add_stiffness(q, K);
    for (Index j = 0; j < K.cols(); ++j) {
      const Vector h = 1e-6 * Vector::Unit(K.cols(), j);
      differences.col(j) = -(load.at(q + h) - load.at(q - h)) / 2e-6;
    }
    EXPECT_TRUE(is_near(K, differences, 1e-7 * K.norm()));
  };
  check(ExtendedModalBasis{.num_modes = 3}(*bars.full));
  check(ModalBasis{.num_modes = 5}(*bars.full));
}

// Springs that end at fixed points are a load of our own, too: so the general way has to agree with the short one.
TEST(OutsideForce, AgreesWithSpringsThatAreProjectedOnce) {
  const Bars bars;
  Springs springs;
  springs.between = 0;
  Loads own{.others = {springs}}, affine;
  for (const Index a : {0, 1})
    affine.springs.push_back({springs.touched[a], springs.to_space, springs.targets.row(a).transpose()});
  const auto one = bars.full->project(own), other = bars.full->project(affine);
  const Vector u = random_vector(bars.full->dim(), 0.05, 5);
  EXPECT_TRUE(is_near(one.at(u), other.at(u), 1e-13 * one.at(u).norm()));
  SparseMatrix A = bars.full->rest_stiffness(), B = A;
  one.add_stiffness(u, A);
  other.add_stiffness(u, B);
  EXPECT_TRUE(is_near(Matrix(A), Matrix(B), 1e-13 * Matrix(A).norm()));
  // and statics end at the same place
  StaticSolver a(*bars.full, {.tolerance = 1e-10}), b(*bars.full, {.tolerance = 1e-10});
  Vector x = Vector::Zero(u.size()), y = x;
  ASSERT_EQ(a.solve(one, x).status, Status::Converged);
  ASSERT_EQ(b.solve(other, y).status, Status::Converged);
  EXPECT_TRUE(is_near(x, y, 1e-8 * y.norm()));
}

TEST(OutsideForce, MayCoupleNodesThatNoElementCouples) {
  const Bars bars;
  const std::vector<Index>& free = bars.full->numbering().free_nodes();
  Springs springs;
  springs.touched = {free.front(), free.back()};
  ASSERT_EQ(bars.full->rest_stiffness().coeff(0, bars.full->dim() - 3), 0) << "far from one another";
  const auto load = bars.full->project(Loads{.others = {springs}});
  SparseMatrix K = bars.full->rest_stiffness();
  load.add_stiffness(Vector::Zero(K.rows()), K);
  EXPECT_EQ(K.coeff(0, K.cols() - 3), -springs.between);
  StaticSolver solver(*bars.full, {.tolerance = 1e-10});
  Vector u = Vector::Zero(bars.full->dim());
  EXPECT_EQ(solver.solve(load, u).status, Status::Converged);
  Vector f(u.size());
  bars.full->force(u, f);
  EXPECT_TRUE(is_near(f, load.at(u), 1e-8 * f.norm()));
}

TEST(PenaltyFloor, BearsTheWeightOfABodyThatRestsOnIt) {
  const TetMesh mesh = kuhn_box(6, 2, 2, 0.1);
  const StvkBar bar(
      TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.3})),
      lumped_mass(mesh, 1000.0));
  const double weight = 9.81 * bar.nodal_mass().sum();
  const std::vector<Index> below = nodes_where(mesh, [](const Point& x) { return x[2] < 0.01; });
  const Index count = static_cast<Index>(below.size());
  const PenaltyFloor floor(mesh.nodes, below, Vector::Constant(count, 1.0 / static_cast<double>(count)),
                           {.axis = FloorAxis::Z, .height = 1e-3, .stiffness = 1e5});
  // springs too soft to matter keep it from sliding and turning
  Loads loads{.gravity = {0, 0, -9.81}, .others = {floor}};
  for (const Index v : {below.front(), below.back()}) loads.springs.push_back({v, 1e-2, Point::Zero()});
  StaticSolver solver(bar, {.tolerance = 1e-9, .max_iterations = 500});
  Vector u = Vector::Zero(bar.dim());
  ASSERT_EQ(solver.solve(bar.project(loads), u).status, Status::Converged);
  Points at_nodes(count, 3), f;
  for (Index a = 0; a < count; ++a) at_nodes.row(a) = u.segment<3>(3 * below[a]).transpose();
  floor.force(at_nodes, f);
  EXPECT_NEAR(f.col(2).sum(), weight, 1e-3 * weight);
  EXPECT_GT(f.col(2).minCoeff(), 0) << "it stands on all of its nodes";
}

TEST(PenaltyFloor, TakesPartInTheEnergyOfABounce) {
  const TetMesh mesh = bar_mesh();
  const StvkBar bar = free_bar();
  const Vector shares = bar.nodal_mass() / bar.nodal_mass().sum();
  std::vector<Index> all(static_cast<std::size_t>(mesh.num_nodes()));
  for (std::size_t v = 0; v < all.size(); ++v) all[v] = static_cast<Index>(v);
  const double height = mesh.nodes.col(2).minCoeff() - 0.02;
  const Loads loads{
      .gravity = {0, 0, -9.81},
      .others = {PenaltyFloor(mesh.nodes, all, shares, {.axis = FloorAxis::Z, .height = height, .stiffness = 2e4})}};
  const auto load = bar.project(loads);
  Newmark newmark(bar, 2e-4, {.tolerance = 1e-10});
  State state = newmark.at_rest();
  newmark.balance(load, state);
  const auto energy = [&] { return newmark.energy(state) - load.force.dot(state.u) + load.pull_energy(state.u); };
  const double start = energy();
  double deepest = 0, scale = 0;
  for (int k = 0; k < 700; ++k) {
    ASSERT_EQ(newmark.step(load, state).status, Status::Converged);
    deepest = std::max(deepest, load.pull_energy(state.u));
    scale = std::max(scale, newmark.kinetic_energy(state));
    ASSERT_NEAR(energy(), start, 0.01 * scale + 1e-9) << k;
  }
  EXPECT_GT(deepest, 0.1 * scale) << "it has met the floor";
}

TEST(OutsideForce, WithoutAPotentialIsSolvedByNewtonAndRefusedByMinimisers) {
  const Bars bars;
  const auto load = bars.full->project(Loads{.others = {Whirl{{40, 50}, 2.0}}});
  EXPECT_FALSE(load.has_potential());
  Vector u = Vector::Zero(bars.full->dim());
  StaticSolver newton(*bars.full, {.tolerance = 1e-8});
  EXPECT_EQ(newton.solve(load, u).status, Status::Converged);
  Vector f(u.size());
  bars.full->force(u, f);
  EXPECT_TRUE(is_near(f, load.at(u), 1e-7 * f.norm()));
  StaticSolver bfgs(*bars.full, {.solver = LineSearchBfgs{}});
  EXPECT_THAT([&] { (void)bfgs.solve(load, u); }, ThrowsMessage<std::invalid_argument>(HasSubstr("no potential")));
  // in time, too
  Newmark newmark(*bars.full, 0.01, {.solver = Bfgs{}, .tolerance = 1e-8});
  State state = newmark.at_rest();
  newmark.balance(load, state);
  for (int k = 0; k < 20; ++k) ASSERT_EQ(newmark.step(load, state).status, Status::Converged);
  EXPECT_GT(state.u.norm(), 0);
}

TEST(OutsideForce, OnAFixedNodeIsBorneByTheSupport) {
  const Bars bars;
  Springs springs;
  springs.touched = {bars.full->numbering().fixed_nodes()[0], 50};
  const auto load = bars.full->project(Loads{.others = {springs}});
  const Vector f = load.at(Vector::Zero(bars.full->dim()));
  EXPECT_EQ((f.array() != 0).count(), 3 - (springs.targets.row(1).array() == 0).count());
}

TEST(OutsideForce, MistakesAreNamed) {
  const Bars bars;
  Springs springs;
  springs.touched = {40, 40};
  EXPECT_THAT([&] { (void)bars.full->project(Loads{.others = {springs}}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("outside force 0 touches a node twice")));
  springs.touched = {40, 4000};
  EXPECT_THAT(
      [&] {
        (void)bars.full->project(Loads{.others = {Springs{}, springs}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("outside force 1 is at node 4000")));
  EXPECT_THROW(PenaltyFloor(bar_mesh().nodes, {0}, Vector::Ones(1), {.stiffness = -1}), std::invalid_argument);
  EXPECT_THROW(PenaltyFloor(bar_mesh().nodes, {0, 1}, Vector::Ones(1), {}), std::invalid_argument);
  const Points nodes = bar_mesh().nodes;
  EXPECT_THROW((void)outside_forces().at("floor").make({nodes, {0}, Vector::Ones(1)}, {{"axis", "w"}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
