#include <physics/heat/surface_heat_loss.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/heat.hpp>
#include <tests/support/rounding.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <numeric>

namespace supple::test {
namespace {

/// ∫ k ∇θ·∇x = Σ_v f_v x_v for each coordinate x. For a linear k its integral is exact.
TEST(HeatConduction, AffineTemperaturesHaveTheirExactFlux) {
  const TetMesh mesh = perturbed(kuhn_box(3, 3, 3, 0.1), 0.01, 21);
  const double k0 = 30, beta = 0.01;
  const FullSystem<Conduction> system(Conduction(mesh, LinearConductivity<double>::from(k0, beta)),
                                      lumped_heat_capacity(mesh, 2700, 900));
  const Point g(200, -100, 50);
  const Vector theta = mesh.nodes * g;
  const Vector f = system.force(theta);
  double integral = 0;
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    double mean = 0;
    for (const Index v : mesh.cells[e]) mean += theta[v] / 4;
    integral += tet_volume(mesh, e) * k0 * (1 + beta * mean);
  }
  EXPECT_TRUE(is_near(mesh.nodes.transpose() * f, integral * g, rounding * integral * g.norm()));
  EXPECT_NEAR(f.sum(), 0, rounding * f.lpNorm<1>()) << "what leaves a node arrives at others";
}

TEST(HeatConduction, AffineTemperaturesLeaveTheInteriorInBalanceIfTheConductivityIsConstant) {
  const TetMesh mesh = perturbed(kuhn_box(3, 3, 3, 0.1), 0.01, 21);
  const FullSystem<Conduction> system(Conduction(mesh, LinearConductivity<double>::from(30, 0)),
                                      lumped_heat_capacity(mesh, 2700, 900));
  const Vector f = system.force(mesh.nodes * Point(200, -100, 50));
  const NodeNumbering interior(mesh.num_nodes(), boundary_nodes(mesh));
  ASSERT_EQ(interior.num_free(), 8);
  for (const Index v : interior.free_nodes()) EXPECT_NEAR(f[v], 0, rounding * f.norm()) << "node " << v;
}

TEST(HeatConduction, UniformTemperaturesFeelNothing) {
  const HeatedBar bar(false);
  const Vector some = random_vector(bar.mesh.num_nodes(), 100, 3);
  for (const double theta : {-300.0, 1.0, 150.0, 5000.0})
    EXPECT_LT(bar.system->force(Vector::Constant(bar.mesh.num_nodes(), theta)).norm(),
              rounding * bar.system->force(some).norm() * std::abs(theta));
}

// θᵀ f = Σ V k |∇θ|²: also where k₀ (1 + β θ) would be negative.
TEST(HeatConduction, HeatFlowsFromWarmToColdHoweverWildTheState) {
  const HeatedBar bar(false);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const Vector theta = random_vector(bar.mesh.num_nodes(), 2000, seed);
    double dissipation = 0;
    for (Index e = 0; e < bar.mesh.num_cells(); ++e) {
      Local<4> corners;
      for (int a = 0; a < 4; ++a) corners[a] = theta[bar.mesh.cells[e][a]];
      const auto& term = bar.system->model().term(e);
      const double k = std::max(40 * (1 + 0.005 * corners.mean()), 2.0);  // the floor is a twentieth
      dissipation += k * tet_volume(bar.mesh, e) * term.gradient(corners).squaredNorm();
    }
    EXPECT_NEAR(theta.dot(bar.system->force(theta)), dissipation, rounding * dissipation);
  }
}

TEST(LinearConductivity, StaysAtItsFloorAndIsFlatThere) {
  const auto k = LinearConductivity<double>::from(20, -0.01, 0.1);
  EXPECT_DOUBLE_EQ(k.value(0), 20);
  EXPECT_DOUBLE_EQ(k.value(50), 10);
  EXPECT_DOUBLE_EQ(k.derivative(50), -0.2);
  EXPECT_DOUBLE_EQ(k.value(90), 2);
  EXPECT_DOUBLE_EQ(k.value(1000), 2);
  EXPECT_EQ(k.derivative(1000), 0);
}

/// ‖θ − exact‖ / ‖exact‖ at the nodes of a rod of n cubes a metre: θ = 0 at x = 0, flux q at x = 1. By Kirchhoff's
/// transform k₀ (θ + ½ β θ²) = q x.
double rod_error(Index n, double beta) {
  const double h = 1 / static_cast<double>(n), k0 = 50, q = 5000;
  const TetMesh mesh = kuhn_box(n, n / 4, n / 4, h);
  const auto at = [](double where) { return [where](const Point& x) { return std::abs(x[0] - where) < 1e-9; }; };
  const FullSystem<Conduction> system(Conduction(mesh, LinearConductivity<double>::from(k0, beta)),
                                      lumped_heat_capacity(mesh, 2700, 900), nodes_where(mesh, at(0)));
  Vector flow = Vector::Zero(mesh.num_nodes());
  for (const Triangle& face : boundary_faces(mesh))
    if (std::ranges::all_of(face, [&](Index v) { return mesh.nodes(v, 0) > 1 - 1e-9; }))
      for (const Index v : face) flow[v] += q * h * h / 6;
  Vector theta = Vector::Zero(system.dim());
  const Report report = solve_steady(system, system.project(flow), theta, {.tolerance = 1e-11, .max_iterations = 30});
  EXPECT_EQ(report.status, Status::Converged) << report.residual;
  const Vector exact = mesh.nodes.col(0).unaryExpr(
      [&](double x) { return beta == 0 ? q * x / k0 : (std::sqrt(1 + 2 * beta * q * x / k0) - 1) / beta; });
  return (system.expand(theta) - exact).norm() / exact.norm();
}

TEST(HeatConduction, RodsHaveKirchhoffsProfileAtSecondOrder) {
  EXPECT_LT(rod_error(4, 0), 1e-10) << "a linear profile is in the space of linear tets";
  for (const double beta : {0.02, -0.003}) {
    const double coarse = rod_error(4, beta), middle = rod_error(8, beta), fine = rod_error(16, beta);
    EXPECT_GT(std::log2(coarse / middle), 1.75) << "beta " << beta;
    EXPECT_GT(std::log2(middle / fine), 1.75) << "beta " << beta;
    EXPECT_LT(fine, 2e-3) << "beta " << beta;
  }
}

// What the source gives is what the held nodes take away; full_force is the heat that arrives there.
TEST(HeatConduction, SteadyStatesPassOnAllHeat) {
  const HeatedBar bar;
  Vector theta = Vector::Zero(bar.system->dim());
  const Vector flow = bar.end_flow(300) + bar.side_flow(200);
  ASSERT_EQ(solve_steady(*bar.system, bar.system->project(flow), theta, {.tolerance = 1e-12}).status,
            Status::Converged);
  Vector f(bar.mesh.num_nodes());
  bar.system->full_force(bar.system->expand(theta), f);
  double taken = 0;
  for (const Index v : bar.system->numbering().fixed_nodes()) taken -= f[v];
  EXPECT_NEAR(taken, 500, 1e-8);
  EXPECT_GT(theta.maxCoeff(), 50) << "the conductivity is to vary";
}

TEST(HeatConduction, RefusesWhatCannotBe) {
  const TetMesh two = [] {
    TetMesh box = kuhn_box(1, 1, 1);
    box.cells.resize(2);
    return box;
  }();
  const auto k = LinearConductivity<double>::from(10, 0.01);
  using Conductivities = std::vector<LinearConductivity<double>>;
  EXPECT_NO_THROW(Conduction(two, Conductivities(2, k)));
  EXPECT_THROW(Conduction(two, Conductivities(3, k)), std::invalid_argument);
  EXPECT_THROW(Conduction(two, Conductivities()), std::invalid_argument);
  TetMesh reversed = single_tet();
  std::swap(reversed.cells[0][0], reversed.cells[0][1]);
  EXPECT_THROW(Conduction(reversed, k), std::invalid_argument);
  TetMesh out_of_range = single_tet();
  out_of_range.cells[0][2] = 4;
  EXPECT_THROW(Conduction(out_of_range, k), std::invalid_argument);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double k0 : {0.0, -1.0, nan}) {
    EXPECT_THROW((void)LinearConductivity<double>::from(k0, 0), std::invalid_argument);
    EXPECT_THROW((void)ExponentialConductivity<double>::from(k0, 0), std::invalid_argument);
  }
  for (const double share : {0.0, -0.1, 1.1, nan})
    EXPECT_THROW((void)LinearConductivity<double>::from(1, 0, share), std::invalid_argument);
  EXPECT_THROW((void)LinearConductivity<double>::from(1, nan), std::invalid_argument);
  EXPECT_THROW((void)lumped_heat_capacity(two, 1000, 0), std::invalid_argument);
}

TEST(LumpedHeatCapacity, SumsToThatOfTheObject) {
  const TetMesh mesh = kuhn_box(4, 2, 3, 0.1);
  EXPECT_NEAR(lumped_heat_capacity(mesh, 2700, 900).sum(), 2700 * 900 * 0.024, rounding * 2700 * 900);
}

TEST(SurfaceHeatLoss, OfAUniformTemperatureIsStefanAndBoltzmannsAndNewtons) {
  const TetMesh mesh = kuhn_box(2, 1, 1, 0.1);  // ten squares
  const SurfaceHeatLoss loss(mesh.nodes, boundary_faces(mesh), {.film = 7, .emissivity = 0.6, .ambient = 290});
  const FullSystem<SurfaceHeatLoss> system(loss, Vector::Ones(mesh.num_nodes()));
  for (const double theta : {-200.0, 0.0, 80.0, 900.0}) {
    const double expected = 0.1 * (7 * theta + 0.6 * 5.670374419e-8 * (std::pow(290 + theta, 4) - std::pow(290.0, 4)));
    EXPECT_NEAR(system.force(Vector::Constant(mesh.num_nodes(), theta)).sum(), expected, 1e-10 * std::abs(expected));
  }
}

TEST(SurfaceHeatLoss, RefusesWhatCannotBe) {
  const TetMesh mesh = single_tet();
  const auto make = [&](const SurfaceExchange& exchange, std::vector<Triangle> triangles = {{0, 1, 2}}) {
    return SurfaceHeatLoss(mesh.nodes, std::move(triangles), exchange);
  };
  EXPECT_NO_THROW(make({.film = 1}));
  EXPECT_THROW(make({}), std::invalid_argument) << "no exchange";
  EXPECT_THROW(make({.film = -1}), std::invalid_argument);
  EXPECT_THROW(make({.emissivity = 1.5}), std::invalid_argument);
  EXPECT_THROW(make({.emissivity = 0.5, .ambient = 0}), std::invalid_argument);
  EXPECT_THROW(make({.film = 1}, {{0, 1, 4}}), std::invalid_argument);
  EXPECT_THROW(make({.film = 1}, {{0, 1, 1}}), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
