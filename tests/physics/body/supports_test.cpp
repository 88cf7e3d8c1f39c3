#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/body/body_system.hpp>
#include <physics/body/cell_stress.hpp>
#include <physics/body/cut.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/reactions.hpp>
#include <physics/body/surface_shares.hpp>
#include <physics/load/follower_pressure.hpp>
#include <physics/statics/static_solver.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/integrator_library.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/solids.hpp>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace supple::test {
namespace {

enum : std::uint8_t { along_x = 1, along_y = 2, along_z = 4 };

/// Holds the nodes in the planes x = 0, y = 0 and z = 0 along the normals of these.
std::vector<HeldAxes> planes_of_symmetry(const Points& nodes) {
  std::vector<HeldAxes> held;
  for (Index v = 0; v < nodes.rows(); ++v) {
    std::uint8_t axes = 0;
    for (int c = 0; c < 3; ++c)
      if (nodes(v, c) == 0) axes |= static_cast<std::uint8_t>(1 << c);
    if (axes != 0 && axes != HeldAxes::all) held.push_back({v, axes});
  }
  return held;
}
std::vector<Index> origin(const Points& nodes) {
  std::vector<Index> at;
  for (Index v = 0; v < nodes.rows(); ++v)
    if (nodes.row(v).isZero(0)) at.push_back(v);
  return at;
}

/// A bar fixed at one end, of whose nodes some slide.
struct SlidingBar {
  TetMesh mesh = bar_mesh();
  std::vector<HeldAxes> held;
  std::shared_ptr<const AnyModel<4>> model = force_model(isotropic_solid(mesh, rubber));
  FullSystem<AnyModel<4>> system;
  FullSystem<AnyModel<4>> without;  // nobody slides

  SlidingBar()
      : held{{30, along_x}, {40, along_y | along_z}, {41, along_y}, {62, along_z | along_x}},
        system(model, lumped_mass(mesh, 1000.0), bar_end(mesh), held),
        without(model, lumped_mass(mesh, 1000.0), bar_end(mesh)) {}

  std::vector<Index> free() const {
    std::vector<Index> result;
    const std::vector<Index>& held_unknowns = system.numbering().held_unknowns();
    for (Index i = 0; i < system.dim(); ++i)
      if (!std::ranges::binary_search(held_unknowns, i)) result.push_back(i);
    return result;
  }
  Vector slid(double size, unsigned seed) const {
    Vector u = random_vector(system.dim(), size, seed);
    for (const Index i : system.numbering().held_unknowns()) u[i] = 0;
    return u;
  }
};

TEST(HeldAxes, LeaveForcesAndTangentsOfWhatIsFree) {
  const SlidingBar bar;
  ASSERT_EQ(bar.system.numbering().held_unknowns().size(), 6u);
  const std::vector<Index> free = bar.free();
  const Vector u = bar.slid(0.01, 1);
  EXPECT_EQ(Vector(bar.system.force(u)(free)), Vector(bar.without.force(u)(free)));
  EXPECT_EQ(bar.system.energy(u), bar.without.energy(u));
  const Matrix K = bar.system.stiffness(u), K_0 = bar.without.stiffness(u);
  EXPECT_EQ(Matrix(K(free, free)), Matrix(K_0(free, free)));
  for (const Index i : bar.system.numbering().held_unknowns()) {
    EXPECT_EQ(bar.system.force(u)[i], 0);
    EXPECT_GT(K(i, i), 0);
    EXPECT_EQ(K.col(i).cwiseAbs().sum(), K(i, i));
    EXPECT_EQ(K.row(i).cwiseAbs().sum(), K(i, i));
  }
  const Vector all = bar.system.expand(u);
  EXPECT_EQ(all[3 * 40 + 1], 0);
  EXPECT_EQ(all[3 * 40 + 2], 0);
  EXPECT_EQ(bar.system.restrict(all), u);
}

TEST(HeldAxes, KeepForceAndTangentTheDerivativesOfTheEnergyEverywhere) {
  const SlidingBar bar;
  const Vector u = random_vector(bar.system.dim(), 0.01, 2), way = random_vector(bar.system.dim(), 1, 3);
  const double h = 1e-6;
  const auto slope = (bar.system.energy(u + h * way) - bar.system.energy(u - h * way)) / (2 * h);
  EXPECT_NEAR(bar.system.force(u).dot(way), slope, 1e-7 * std::abs(slope));
  const Vector change = (bar.system.force(u + h * way) - bar.system.force(u - h * way)) / (2 * h);
  EXPECT_TRUE(is_near(bar.system.stiffness(u) * way, change, 1e-6 * change.norm()));
  // what goes through many states at once agrees
  Matrix states(u.size(), 3), forces(u.size(), 3);
  states << u, -u, way * 1e-3;
  Vector energies(3);
  bar.system.forces(states, forces, energies);
  for (Index k = 0; k < 3; ++k) {
    EXPECT_TRUE(is_near(forces.col(k), bar.system.force(states.col(k)), 1e-12 * forces.norm()));
    EXPECT_NEAR(energies[k], bar.system.energy(states.col(k)), 1e-12 * energies.cwiseAbs().maxCoeff());
  }
  // the mean force does the work of the energy, and its derivative is the mean tangent
  Vector mean(u.size());
  const Vector v = u + 1e-3 * way;
  bar.system.mean_force(u, v, mean);
  EXPECT_NEAR(mean.dot(v - u), bar.system.energy(v) - bar.system.energy(u), 1e-9 * std::abs(bar.system.energy(v)));
  SparseMatrix K;
  bar.system.mean_stiffness(u, v, K);
  Vector before(u.size()), after(u.size());
  bar.system.mean_force(u, v - h * way, before);
  bar.system.mean_force(u, v + h * way, after);
  EXPECT_TRUE(is_near(K * way, (after - before) / (2 * h), 1e-6 * (K * way).norm()));
}

// However soft what is held, no frequency of a held unknown is among those of the object.
TEST(HeldAxes, AreFasterThanTheObject) {
  const SlidingBar bar;
  const Vector root = bar.system.mass().cwiseSqrt().cwiseInverse();
  const Matrix scaled = root.asDiagonal() * Matrix(bar.system.rest_stiffness()) * root.asDiagonal();
  const std::vector<Index> free = bar.free();
  const Vector of_free = symmetric_eigenvalues(Matrix(scaled(free, free)));
  for (const Index i : bar.system.numbering().held_unknowns()) EXPECT_GE(scaled(i, i), of_free[of_free.size() - 1]);
}

TEST(HeldAxes, TakeNoLoad) {
  const SlidingBar bar;
  Loads loads{.gravity = {1, 2, 3}, .forces = {{40, {5, 5, 5}}, {41, {5, 5, 5}}}, .springs = {{40, 100, {1, 1, 1}}}};
  loads.others.push_back(FollowerPressure(bar.mesh.nodes, boundary_faces(bar.mesh), {.pressure = 10}));
  const SystemLoad<SparseMatrix> load = bar.system.project(loads);
  const Vector u = bar.slid(0.01, 4);
  const Vector acting = load.at(u), elsewhere = bar.without.project(loads).at(u);
  for (const Index i : bar.system.numbering().held_unknowns()) EXPECT_EQ(acting[i], 0);
  const std::vector<Index> free = bar.free();
  EXPECT_TRUE(is_near(Vector(acting(free)), Vector(elsewhere(free)), 1e-12 * elsewhere.norm()));
}

TEST(HeldAxes, AreRefusedWhereThereIsNoSuchNodeOrAxis) {
  EXPECT_THROW(NodeNumbering(5, {}, {{5, along_x}}), std::invalid_argument);
  EXPECT_THROW(NodeNumbering(5, {}, {{0, 8}}), std::invalid_argument);
  EXPECT_THROW(NodeNumbering(5, {}, {{0, 0}}), std::invalid_argument);
  EXPECT_THROW(NodeNumbering(2, {0}, {{1, HeldAxes::all}}), std::invalid_argument);
}

// Half of a bar on its plane of symmetry moves as the whole one does, in large deformation, too.
TEST(HeldAxes, MakeHalfOfABarMoveAsTheWholeOne) {
  const HexMesh whole = hex_box(6, 2, 4, {0.6, 0.2, 0.4}), half = hex_box(6, 2, 2, {0.6, 0.2, 0.2});
  const auto end = [](const HexMesh& mesh) { return nodes_where(mesh, [](const Point& x) { return x[0] == 0; }); };
  HexSolid upper = isotropic_solid(half, rubber, end(half));  // z = 0 … 0.2 of the whole one's z = 0.2 … 0.4
  for (Index v = 0; v < half.num_nodes(); ++v)
    if (half.nodes(v, 2) == 0 && half.nodes(v, 0) > 0) upper.held_axes.push_back({v, along_z});
  const HexSolid both = isotropic_solid(whole, rubber, end(whole));
  const Loads weight{.gravity = {0, -30, 0}};
  const auto settled = [&](const Body& body) {
    const AnySystem<SparseMatrix> system = full_system(body);
    StaticSolver<AnySystem<SparseMatrix>> solver(system, {.tolerance = 1e-11});
    Vector u = Vector::Zero(system.dim());
    EXPECT_EQ(solver.solve(system.project(weight), u).status, Status::Converged);
    return system.expand(u);
  };
  const Vector u = settled(upper), expected = settled(both);
  for (Index v = 0; v < half.num_nodes(); ++v)
    for (Index w = 0; w < whole.num_nodes(); ++w)
      if ((whole.nodes.row(w) - half.nodes.row(v) - Eigen::RowVector3d(0, 0, 0.2)).norm() < 1e-9)
        EXPECT_TRUE(is_near(u.segment<3>(3 * v), expected.segment<3>(3 * w), 1e-9 * expected.norm()));
  EXPECT_GT(expected.cwiseAbs().maxCoeff(), 0.1);
}

// In motion: what the symmetric whole does.
TEST(HeldAxes, StayWhereTheyAreInMotionWithEveryIntegrator) {
  const SlidingBar bar;
  Solid solid = isotropic_solid(bar.mesh, rubber, bar_end(bar.mesh));
  solid.held_axes = bar.held;
  const AnySystem<SparseMatrix> system = full_system(solid);
  const Loads weight{.gravity = {3, -20, 8}};
  for (const std::string& name : integrators().names()) {
    auto integrator = make_integrator(Choice{name}, system, 0.01, {.solver = WarpedBfgs{}});
    State state = integrator.at_rest();
    const SystemLoad<SparseMatrix> load = system.project(weight);
    integrator.balance(load, state);
    for (int k = 0; k < 10; ++k) EXPECT_EQ(integrator.step(load, state).status, Status::Converged) << name;
    const Vector u = system.expand(state.u);
    EXPECT_GT(u.cwiseAbs().maxCoeff(), 1e-3) << name;
    for (const auto& [v, axes] : bar.held)
      for (int c = 0; c < 3; ++c) EXPECT_EQ(u[3 * v + c] == 0, (axes >> c & 1) == 1) << name << ", " << v;
  }
}

TEST(Reactions, BalanceTheLoadsInEquilibrium) {
  const SlidingBar bar;
  Solid solid = isotropic_solid(bar.mesh, rubber, bar_end(bar.mesh), "neo-hookean");
  solid.held_axes = bar.held;
  Loads loads{
      .gravity = {2, -9, 1}, .forces = {{50, {0.5, 1, -2}}, {40, {1, 1, 1}}}, .springs = {{60, 40, {0, 0.1, 0}}}};
  loads.others.push_back(FollowerPressure(bar.mesh.nodes, boundary_faces(bar.mesh), {.pressure = 200}));
  const AnySystem<SparseMatrix> system = full_system(solid);
  StaticSolver<AnySystem<SparseMatrix>> solver(system, {.tolerance = 1e-11});
  Vector u = Vector::Zero(system.dim());
  ASSERT_EQ(solver.solve(system.project(loads), u).status, Status::Converged);
  const Vector all = system.expand(u);
  const Reactions reactions{Body(solid)};
  const Points r = reactions(all, loads);
  const Points x = bar.mesh.nodes + Eigen::Map<const Points>(all.data(), bar.mesh.num_nodes(), 3);
  const auto [force, moment] = reactions.resultant(r, x);
  // pressure on the closed surface has no resultant
  const Vector mass = lumped_mass(bar.mesh, 1000.0);
  Point load = Point::Zero(), turn = Point::Zero();
  const auto add = [&](Index v, const Point& f) {
    load += f;
    turn += Point(x.row(v)).cross(f);
  };
  for (Index v = 0; v < mass.size(); ++v) add(v, mass[v] * loads.gravity);
  for (const auto& [v, f] : loads.forces) add(v, f);
  add(60, 40 * (Point(0, 0.1, 0) - all.segment<3>(3 * 60)));
  EXPECT_TRUE(is_near(force, -load, 1e-8 * load.norm()));
  EXPECT_TRUE(is_near(moment, -turn, 1e-8 * turn.norm()));
  // nodes slide without friction
  for (Index k = 0; k < r.rows(); ++k)
    for (const auto& [v, axes] : bar.held)
      if (reactions.nodes()[static_cast<std::size_t>(k)] == v)
        for (int c = 0; c < 3; ++c) EXPECT_EQ(r(k, c) == 0, (axes >> c & 1) == 0);
}

// In motion, Σ r + Σ f_ext = d/dt Σ m v, damping by mass apart.
TEST(Reactions, ChangeTheMomentumInMotion) {
  const TetMesh mesh = bar_mesh();
  Solid solid = isotropic_solid(mesh, rubber, bar_end(mesh));
  solid.damping = {0, 2e-3};
  const AnySystem<SparseMatrix> system = full_system(solid);
  const Loads weight{.gravity = {0, -9.81, 0}};
  const double h = 1e-4;
  auto integrator =
      make_integrator(Choice{"newmark"}, system, h, {.damping = solid.damping, .solver = Newton{}, .tolerance = 1e-11});
  State state = integrator.at_rest();
  const SystemLoad<SparseMatrix> load = system.project(weight);
  integrator.balance(load, state);
  const Reactions reactions{Body(solid)};
  const Vector mass = lumped_mass(mesh, 1000.0);
  const auto momentum = [&] {
    const Vector v = system.expand(state.v);
    Point sum = Point::Zero();
    for (Index k = 0; k < mass.size(); ++k) sum += mass[k] * v.segment<3>(3 * k);
    return sum;
  };
  for (int k = 0; k < 50; ++k) ASSERT_EQ(integrator.step(load, state).status, Status::Converged);
  const Point before = momentum();
  ASSERT_EQ(integrator.step(load, state).status, Status::Converged);
  const Points r = reactions(system.expand(state.u), weight, system.expand(state.v), solid.damping);
  ASSERT_EQ(integrator.step(load, state).status, Status::Converged);
  const Point change = (momentum() - before) / (2 * h), total = mass.sum() * weight.gravity;
  EXPECT_TRUE(is_near(r.colwise().sum().transpose(), change - total, 1e-4 * total.norm()));
}

template <typename Element>
CellMesh<Element::num_nodes> patch() {
  // nodes inside moved, faces plane, sides straight
  const auto moved = [](auto mesh) {
    const Vector way = random_vector(mesh.nodes.size(), 0.04, 8);
    const BoundingBox box = bounding_box(mesh.nodes);
    for (Index v = 0; v < mesh.num_nodes(); ++v)
      for (int c = 0; c < 3; ++c)
        if (mesh.nodes(v, c) > box.lower[c] + 1e-9 && mesh.nodes(v, c) < box.upper[c] - 1e-9)
          mesh.nodes(v, c) += way[3 * v + c];
    return mesh;
  };
  if constexpr (std::same_as<Element, QuadraticTet>)
    return quadratic_mesh(moved(kuhn_box(2, 2, 2, 0.5)));
  else if constexpr (std::same_as<Element, TrilinearHex>)
    return moved(hex_box(3, 3, 3, {1, 1, 1}));
  else
    return moved(kuhn_box(3, 3, 3, 1.0 / 3));
}

template <typename Element>
class UniformStress : public testing::Test {};
using PatchElements = testing::Types<LinearTet, TrilinearHex, QuadraticTet>;
TYPED_TEST_SUITE(UniformStress, PatchElements);

// A cube on three planes of symmetry, pulled by a traction: StVK stretches by a with a (a² − 1) / 2 = t / Y.
TYPED_TEST(UniformStress, OfAPulledCubeIsThatOfTheClosedForm) {
  const auto mesh = patch<TypeParam>();
  const IsotropicModuli moduli{.young = 1e5, .poisson = 0.3};
  auto solid = isotropic_solid(mesh, moduli, origin(mesh.nodes));
  solid.held_axes = planes_of_symmetry(mesh.nodes);
  const double t = 2e4;
  Loads loads;
  const std::vector<Index> end = nodes_where(mesh, [](const Point& x) { return x[0] > 1 - 1e-9; });
  double area = 0;
  for (const SurfaceShare& share : surface_shares(Body(solid), end)) {
    area += share.area;
    loads.forces.push_back({share.node, t * share.normal});
  }
  EXPECT_NEAR(area, 1, 1e-12);
  const AnySystem<SparseMatrix> system = full_system(Body(solid));
  StaticSolver<AnySystem<SparseMatrix>> solver(system, {.tolerance = 1e-12});
  Vector u = Vector::Zero(system.dim());
  ASSERT_EQ(solver.solve(system.project(loads), u).status, Status::Converged);
  const Vector all = system.expand(u);
  double a = 1;
  for (int k = 0; k < 50; ++k) a -= (a * (a * a - 1) / 2 - t / moduli.young) / ((3 * a * a - 1) / 2);
  const double b = std::sqrt(1 - moduli.poisson * (a * a - 1));
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    const Point expected = Point(a - 1, b - 1, b - 1).cwiseProduct(Point(mesh.nodes.row(v)));
    EXPECT_TRUE(is_near(all.segment<3>(3 * v), expected, 1e-9));
  }
  const CellStress stress = cell_stress(Body(solid), all);
  const double sigma = t / (b * b), strain = (a * a - 1) / 2;
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    EXPECT_NEAR(stress.cauchy(e, 0), sigma, 1e-7 * sigma);
    EXPECT_LT(stress.cauchy.row(e).tail(5).cwiseAbs().maxCoeff(), 1e-7 * sigma);
    EXPECT_NEAR(stress.von_mises[e], sigma, 1e-7 * sigma);
    EXPECT_NEAR(stress.strain(e, 0), strain, 1e-8);
    EXPECT_NEAR(stress.energy[e], 0.5 * moduli.young * strain * strain, 1e-7 * moduli.young);
    EXPECT_NEAR(stress.rest_volume[e], cell_volume(mesh, e), 1e-12);
  }
  EXPECT_NEAR(stress.energy.dot(stress.rest_volume), system.energy(u), 1e-9 * system.energy(u));
  const Vector at = at_nodes(Body(solid), stress.von_mises, stress.rest_volume);
  EXPECT_TRUE(is_near(at, Vector::Constant(at.size(), sigma), 1e-6 * sigma));
  // each plane of symmetry bears its part
  const Reactions reactions{Body(solid)};
  const Points r = reactions(all, loads);
  EXPECT_TRUE(is_near(r.colwise().sum().transpose(), Point(-t, 0, 0), 1e-7 * t));
}

TYPED_TEST(UniformStress, UnderPressureAllAroundIsThatPressure) {
  const auto mesh = patch<TypeParam>();
  auto solid = isotropic_solid(mesh, {.young = 1e5, .poisson = 0.3}, origin(mesh.nodes), "neo-hookean");
  solid.held_axes = planes_of_symmetry(mesh.nodes);
  Loads loads;
  std::vector<Index> all_nodes;
  for (Index v = 0; v < mesh.num_nodes(); ++v) all_nodes.push_back(v);
  const double p = 1;  // small: the surface at rest is that under load
  double area = 0;
  for (const SurfaceShare& share : surface_shares(Body(solid), all_nodes)) {
    area += share.area;
    loads.forces.push_back({share.node, -p * share.normal});
  }
  EXPECT_NEAR(area, 6, 1e-11);
  const AnySystem<SparseMatrix> system = full_system(Body(solid));
  StaticSolver<AnySystem<SparseMatrix>> solver(system, {.tolerance = 1e-8});
  Vector u = Vector::Zero(system.dim());
  ASSERT_EQ(solver.solve(system.project(loads), u).status, Status::Converged);
  const CellStress stress = cell_stress(Body(solid), system.expand(u));
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    EXPECT_TRUE(is_near(stress.cauchy.row(e).head(3).transpose(), Point::Constant(-p), 1e-4 * p));
    EXPECT_LT(stress.von_mises[e], 1e-4 * p);
  }
}

// What bends a cantilever through any cut: the loads beyond it.
TEST(CutForce, IsThatOfTheLoadsBeyondTheCut) {
  const HexMesh mesh = hex_box(8, 2, 2, {0.8, 0.2, 0.2});
  const auto end = nodes_where(mesh, [](const Point& x) { return x[0] == 0; });
  const Body body = isotropic_solid(mesh, rubber, end);
  Loads loads;
  const std::vector<Index> tip = nodes_where(mesh, [](const Point& x) { return x[0] > 0.8 - 1e-9; });
  Point load = Point::Zero();
  for (const SurfaceShare& share : surface_shares(body, tip)) {
    loads.forces.push_back({share.node, Point(0, 500, 100) * share.area});
    load += loads.forces.back().force;
  }
  const AnySystem<SparseMatrix> system = full_system(body);
  StaticSolver<AnySystem<SparseMatrix>> solver(system, {.tolerance = 1e-12});
  Vector u = Vector::Zero(system.dim());
  ASSERT_EQ(solver.solve(system.project(loads), u).status, Status::Converged);
  const Vector all = system.expand(u);
  const Point about(0.1, 0.2, 0.3);
  Point moment = Point::Zero();
  for (const auto& [v, f] : loads.forces) moment += (Point(mesh.nodes.row(v)) + all.segment<3>(3 * v) - about).cross(f);
  for (const double at : {0.15, 0.4, 0.71}) {
    const CutForce through = cut_force(body, all, {0, at}, about);
    EXPECT_TRUE(is_near(through.force, load, 1e-8 * load.norm())) << at;
    EXPECT_TRUE(is_near(through.moment, moment, 1e-8 * moment.norm())) << at;
    EXPECT_EQ(through.components, 4) << at;
  }
  EXPECT_THROW(cut_force(body, all, {0, 0.9}), std::invalid_argument);
  EXPECT_THROW(cut_force(body, all, {3, 0.1}), std::invalid_argument);
}

TEST(SurfaceShares, AddUpToTheAreaOfCurvedFacesAndToNothingAroundABody) {
  const QuadraticTetMesh mesh = irregular_box<QuadraticTet>({2, 1, 1}, 0.2);
  std::vector<Index> nodes;
  for (Index v = 0; v < mesh.num_nodes(); ++v) nodes.push_back(v);
  const std::vector<SurfaceShare> shares = surface_shares(Body(isotropic_solid(mesh, rubber)), nodes);
  Point normal = Point::Zero();
  double flux = 0, volume = 0;  // ∮ x · n / 3 is the volume; N interpolates x, so nodes' shares tell it
  for (const SurfaceShare& share : shares) {
    normal += share.normal;
    flux += share.normal.dot(Point(mesh.nodes.row(share.node))) / 3;
  }
  for (Index e = 0; e < mesh.num_cells(); ++e) volume += cell_volume(mesh, e);
  EXPECT_LT(normal.norm(), 1e-13);
  EXPECT_NEAR(flux, volume, 1e-12);
}

// Faces of a group are loaded, others between the same nodes are not.
TEST(SurfaceShares, OfAGroupAreThoseOfItsFaces) {
  HexMesh mesh = hex_box(2, 2, 1, {2, 2, 1});
  NodeGroup group;  // top and bottom: all nodes, for there is one layer of cells
  for (Index v = 0; v < mesh.num_nodes(); ++v) group.nodes.push_back(v);
  for (const auto& cell : mesh.cells) {
    group.faces.push_back(face_corners(std::array{cell[0], cell[1], cell[2], cell[3]}));
    group.faces.push_back(face_corners(std::array{cell[4], cell[5], cell[6], cell[7]}));
  }
  std::ranges::sort(group.faces);
  const Body body = isotropic_solid(mesh, rubber);
  const auto area = [&](const NodeGroup& part) {
    double sum = 0;
    for (const SurfaceShare& share : surface_shares(body, part)) sum += share.area;
    return sum;
  };
  EXPECT_NEAR(area(group), 8, 1e-12);
  EXPECT_NEAR(area({group.nodes, {}}), 16, 1e-12);
  EXPECT_EQ(surface_triangles(body, group).size(), 16u);
  EXPECT_EQ(surface_triangles(body, {group.nodes, {}}).size(), 32u);
}

TEST(SurfaceShares, OfAShellAreThirdsOfItsTriangles) {
  const TriangleMesh grid = square_grid(3, 2, 0.1);
  const Body plate = isotropic_shell(grid, rubber, 0.01);
  std::vector<Index> nodes;
  for (Index v = 0; v < grid.num_nodes(); ++v) nodes.push_back(v);
  double area = 0;
  Point normal = Point::Zero();
  for (const SurfaceShare& share : surface_shares(plate, nodes)) {
    area += share.area;
    normal += share.normal;
  }
  EXPECT_NEAR(area, 0.06, 1e-14);
  EXPECT_TRUE(is_near(normal, Point(0, 0, 0.06), 1e-14));
  EXPECT_TRUE(surface_shares(plate, {0, 5}).empty());
}

TEST(CellStress, IsRefusedForShells) {
  const Body plate = isotropic_shell(square_grid(3, 2, 0.1), rubber, 0.01);
  EXPECT_FALSE(has_cell_stress(plate));
  EXPECT_THROW(cell_stress(plate, Vector::Zero(3 * num_nodes(plate))), std::invalid_argument);
}

// A turned object has no stress; a turned stress turns along.
TEST(CellStress, TurnsWithTheObject) {
  const TetMesh mesh = bar_mesh();
  const Body body = isotropic_solid(mesh, rubber, {}, "neo-hookean");
  Matrix3<double> stretch;
  stretch << 1.1, 0.05, 0, 0, 0.95, 0.02, 0, 0, 1;
  const Matrix3<double> R = Eigen::AngleAxisd(0.7, Point(1, 2, 3).normalized()).toRotationMatrix();
  const auto displaced = [&](const Matrix3<double>& F) {
    const Points u = mesh.nodes * (F - Matrix3<double>::Identity()).transpose();
    return Vector(u.reshaped<Eigen::RowMajor>());
  };
  const auto tensor = [](const auto& six) {
    Matrix3<double> A;
    A << six[0], six[3], six[5], six[3], six[1], six[4], six[5], six[4], six[2];
    return A;
  };
  const CellStress before = cell_stress(body, displaced(stretch)), after = cell_stress(body, displaced(R * stretch)),
                   turned = cell_stress(body, displaced(R));
  const double size = before.von_mises.maxCoeff();
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    EXPECT_TRUE(is_near(tensor(after.cauchy.row(e)), R * tensor(before.cauchy.row(e)) * R.transpose(), 1e-9 * size));
    EXPECT_NEAR(after.von_mises[e], before.von_mises[e], 1e-9 * size);
    EXPECT_LT(turned.von_mises[e], 1e-9 * size);
  }
}

}  // namespace
}  // namespace supple::test
