#include <physics/time/newmark.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/system/reduced_system.hpp>
#include <testing/dynamical_system_conformance.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/spring_network.hpp>

#include <Eigen/Geometry>

#include <numbers>

namespace supple::test {

template <typename AnyModel, typename Basis>
ReducedSystem<AnyModel, Basis> reduced_system(const FullSystem<AnyModel>& system, const Basis& basis,
                                              const std::vector<Index>& indices, VectorIn weights) {
  return {
      system.shared_model(), std::make_shared<const Basis>(basis), indices, weights, project_stiffness(basis, system),
      system.nodal_mass()};
}
/// All components at weight one.
template <typename AnyModel, typename Basis>
ReducedSystem<AnyModel, Basis> unselected(const FullSystem<AnyModel>& system, const Basis& basis) {
  const Index m = system.model().num_components();
  return reduced_system(system, basis, all_components(m), Vector::Ones(m));
}

/// The reduced system of a clamped bar with all components, so that K(0) = UᵀKU (a suite promise).
template <typename AnyBuilder>
struct ReducedBar {
  using Basis = std::invoke_result_t<AnyBuilder, const StvkBar&>;
  using System = ReducedSystem<TetElasticity<StVenantKirchhoff>, Basis>;
  static System make() {
    const StvkBar system = clamped_bar();
    return unselected(system, AnyBuilder{.num_modes = 3}(system));
  }
  static Vector deformed(const System& system, std::uint64_t seed) { return random_vector(system.dim(), 0.1, seed); }
  static Vector displacements(const System& system, VectorIn q) { return system.subspace().reconstruct(q); }
  static Vector nodal_mass(const System&) { return clamped_bar().nodal_mass(); }
};
using ReducedBars = testing::Types<ReducedBar<ExtendedModalBasis>, ReducedBar<ModalBasis>>;
INSTANTIATE_TYPED_TEST_SUITE_P(ReducedTets, DynamicalSystemConformance, ReducedBars);

namespace {

/// U = M^{−1/2} over the free nodes: the whole space, no reduction.
NodalBasis whole_space(const StvkBar& system) {
  NodalBasis basis{RowMatrix::Zero(system.num_nodes(), system.numbering().num_free()), {}};
  for (Index f = 0; f < system.numbering().num_free(); ++f) {
    const Index v = system.numbering().free_nodes()[f];
    basis.W(v, f) = 1 / std::sqrt(system.nodal_mass()[v]);
  }
  return basis;
}
DenseBasis as_dense(const NodalBasis& basis) {
  return {basis.dense(), basis.report};
}

/// Energy, force and tangent of all components against Uᵀf(Uq) and so on.
template <typename AnyModel, typename Basis>
void expect_projection(const FullSystem<AnyModel>& system, const Basis& basis, double amplitude) {
  const auto reduced = unselected(system, basis);
  ASSERT_EQ(reduced.dim(), basis.dim());
  Matrix U(system.dim(), basis.dim());
  const Matrix full = basis.dense();
  for (Index j = 0; j < U.cols(); ++j) U.col(j) = system.restrict(full.col(j));
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Vector q = (seed == 0 ? 0.0 : 1.0) * random_vector(basis.dim(), amplitude, seed);
    const Vector u = U * q;
    const Matrix K = U.transpose() * (system.stiffness(u) * U);
    const Vector f = U.transpose() * system.force(u);
    const double force_scale = K.norm() * (amplitude + q.norm());
    EXPECT_NEAR(reduced.energy(q), system.energy(u), 1e-12 * force_scale * (amplitude + q.norm()));
    EXPECT_TRUE(is_near(reduced.force(q), f, 1e-12 * force_scale));
    EXPECT_TRUE(is_near(reduced.stiffness(q), K, 1e-12 * K.norm()));
  }
}

TEST(ReducedSystem, WithAllComponentsIsTheProjectedFullSystem) {
  for (const StvkBar& system : {clamped_bar(), free_bar()}) {
    const NodalBasis basis = ExtendedModalBasis{.num_modes = 8}(system);
    expect_projection(system, basis, 0.1);
    expect_projection(system, as_dense(basis), 0.1);
  }
  // terms that feel translations and come without packs
  const FullSystem<DuffingOscillators> oscillators(DuffingOscillators(21, 40, 900), Vector::LinSpaced(21, 0.5, 2.5),
                                                   {4, 9});
  NodalBasis basis{random_matrix(21, 4, 1, 3), {}};
  for (const Index v : {4, 9}) basis.W.row(v).setZero();
  expect_projection(oscillators, basis, 0.2);
}

TEST(ReducedSystem, SumsWeightedComponents) {
  const StvkBar system = clamped_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 3}(system);
  const Vector q = random_vector(basis.dim(), 0.1, 1);
  for (const std::size_t count : {1u, 8u, 11u, 75u}) {  // less than a pack, one, more, several batches
    std::vector<Index> indices;
    for (std::size_t k = 0; k < count; ++k) indices.push_back(static_cast<Index>(143 - (k * 7) % 144));
    const Vector w = random_vector(static_cast<Index>(count), 2, 5).cwiseAbs();
    double energy = 0;
    Vector force = Vector::Zero(basis.dim());
    Matrix stiffness = Matrix::Zero(basis.dim(), basis.dim());
    const Matrix U = basis.dense();
    const Vector u = U * q;
    for (std::size_t k = 0; k < count; ++k) {
      Matrix rows(12, basis.dim());
      for (int a = 0; a < 4; ++a)
        rows.middleRows(3 * a, 3) = U.middleRows(3 * system.model().stencil(indices[k])[a], 3);
      const Local<12> u_i = rows * q;
      energy += w[k] * system.model().energy(indices[k], u_i);
      force += w[k] * rows.transpose() * system.model().force(indices[k], u_i);
      stiffness += w[k] * rows.transpose() * system.model().stiffness(indices[k], u_i) * rows;
    }
    const auto reduced = reduced_system(system, basis, indices, w);
    EXPECT_NEAR(reduced.energy(q), energy, 1e-12 * energy);
    EXPECT_TRUE(is_near(reduced.force(q), force, 1e-12 * stiffness.norm() * q.norm()));
    EXPECT_TRUE(is_near(reduced.stiffness(q), stiffness, 1e-12 * stiffness.norm()));
  }
}

TEST(ReducedSystem, WithRoundedRowsIsThatOfABasisCloseBy) {
  const StvkBar system = clamped_bar();
  const Index m = system.model().num_components();
  const auto basis = std::make_shared<const DenseBasis>(ModalBasis{.num_modes = 12}(system));
  const auto with = [&](RowPrecision precision) {
    return ReducedSystem(system.shared_model(), basis, all_components(m), Vector::Ones(m),
                         project_stiffness(*basis, system), system.nodal_mass(), precision);
  };
  const auto exact = with(RowPrecision::Double), rounded = with(RowPrecision::Single);
  const double epsilon = 1e-4;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    const Vector q = random_vector(basis->dim(), 0.1, seed), d = random_vector(basis->dim(), 0.1, seed + 100);
    const Vector f = rounded.force(q);
    const Matrix K = rounded.stiffness(q);
    EXPECT_TRUE(is_near(f, exact.force(q), 1e-6 * K.norm() * q.norm()));
    EXPECT_FALSE(is_near(f, exact.force(q), 1e-12 * K.norm() * q.norm()));  // it does round
    EXPECT_NEAR(rounded.energy(q), exact.energy(q), 1e-6 * exact.energy(q));
    EXPECT_TRUE(is_near(K, exact.stiffness(q), 1e-6 * K.norm()));
    // its own derivatives far below the rounding of the rows: central differences err by ε² and 1e-16 / ε
    const double slope = (rounded.energy(q + epsilon * d) - rounded.energy(q - epsilon * d)) / (2 * epsilon);
    EXPECT_NEAR(f.dot(d), slope, 3e-8 * f.norm() * d.norm());
    const Vector change = (rounded.force(q + epsilon * d) - rounded.force(q - epsilon * d)) / (2 * epsilon);
    EXPECT_TRUE(is_near(K * d, change, 3e-8 * K.norm() * d.norm()));
  }
}

TEST(ReducedSystem, GivesInvertedMooneyRivlinInfiniteEnergyNotNaN) {
  const TetMesh mesh = bar_mesh();
  const FullSystem<TetElasticity<MooneyRivlin>> system(
      TetElasticity<MooneyRivlin>(mesh, MooneyRivlin<double>::from({.young = 1e5, .poisson = 0.35})),
      lumped_mass(mesh, 1000.0), bar_end(mesh));
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 3}(system);
  const Vector q = random_vector(basis.dim(), 100, 1);
  for (const Index count : {1, 7, 8, 9}) {
    const auto reduced = reduced_system(system, basis, all_components(count), Vector::Ones(count));
    EXPECT_EQ(reduced.energy(q), std::numeric_limits<double>::infinity()) << count << " components";
  }
}

TEST(ReducedSystem, RefusesWhatDoesNotFit) {
  const StvkBar system = clamped_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 2}(system);
  EXPECT_THROW((void)reduced_system(system, basis, {1, 2}, Vector::Ones(3)), std::invalid_argument);
  EXPECT_THROW((void)reduced_system(system, basis, {}, Vector(0)), std::invalid_argument);
  EXPECT_THROW((void)reduced_system(system, basis, {1, 144}, Vector::Ones(2)), std::invalid_argument);
  EXPECT_THROW((void)reduced_system(system, basis, {-1}, Vector::Ones(1)), std::invalid_argument);
}

// W ⊗ I₃ with the fields 1, X, Y, Z turns with the object: (I ⊗ R) q are the coordinates of the rotated
// positions.
struct Rotation : testing::Test {
  const StvkBar system = free_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 8}(system);
  const Matrix3<double> R =
      Eigen::AngleAxisd(70 * std::numbers::pi / 180, Point(1, -2, 0.5).normalized()).toRotationMatrix();

  Vector coordinates(const Vector& u) const {
    Vector weighted = u;
    for (Index i = 0; i < u.size(); ++i) weighted[i] *= system.nodal_mass()[i / 3];
    return basis.project(weighted);
  }
  Vector turned(const Vector& q) const {
    Vector result(q.size());
    for (Index a = 0; a < q.size() / 3; ++a) result.segment<3>(3 * a) = R * q.segment<3>(3 * a);
    return result;
  }
  /// Coordinates of the rest positions moved by R.
  Vector rotation() const { return coordinates(affine_displacement(system.model().rest_positions(), R)); }

  ReducedSystem<TetElasticity<StVenantKirchhoff>, NodalBasis> some_selection() const {
    return reduced_system(system, basis, {3, 17, 40, 41, 77, 90, 111, 120, 142}, random_vector(9, 3, 4).cwiseAbs());
  }
};

TEST_F(Rotation, CostsNoEnergyAndNoForceWhateverTheSelection) {
  const Vector q = rotation();
  const Vector u = affine_displacement(system.model().rest_positions(), R);
  EXPECT_TRUE(is_near(basis.reconstruct(q), u, 1e-12));
  const Vector other = q.norm() * random_vector(q.size(), 1, 2).normalized();
  EXPECT_LT(system.energy(u), 1e-12 * system.energy(basis.reconstruct(other)));
  for (const auto& reduced : {unselected(system, basis), some_selection()}) {
    EXPECT_LT(reduced.energy(q), 1e-12 * reduced.energy(other));
    EXPECT_LT(reduced.force(q).norm(), 1e-12 * reduced.force(other).norm());
  }
}

TEST_F(Rotation, TurnsForcesAndLeavesEnergiesAlone) {
  const Vector q = random_vector(basis.dim(), 0.15, 8), q_turned = rotation() + turned(q);
  for (const auto& reduced : {unselected(system, basis), some_selection()}) {
    const Vector f = reduced.force(q);
    EXPECT_TRUE(is_near(reduced.force(q_turned), turned(f), 1e-10 * f.norm()));
    EXPECT_NEAR(reduced.energy(q_turned), reduced.energy(q), 1e-10 * reduced.energy(q));
  }
}

TEST(ReducedSystem, TranslationsOfAFreeObjectFeelNothing) {
  const StvkBar system = free_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 8}(system);
  const auto reduced = reduced_system(system, basis, {5, 60, 100}, Vector::Constant(3, 48.0));
  const Vector q = random_vector(basis.dim(), 0.15, 8);
  const double mass = system.nodal_mass().sum();
  const Vector shift = reduced.project({.gravity = {3, -1, 2}, .forces = {}, .springs = {}}).force;
  EXPECT_NEAR(shift.norm(), std::sqrt(14 * mass), 1e-10 * std::sqrt(14 * mass));  // UᵀM of an affine field
  EXPECT_TRUE(is_near(reduced.force(q + shift), reduced.force(q), 1e-10 * reduced.force(q).norm()));
}

/// What a swinging bar does in 20 steps: gravity, forces, springs, damping, displacements of a third of its
/// length.
struct Swing {
  static constexpr Index steps = 20;
  static constexpr double h = 0.02;
  static Loads loads() {
    return {.gravity = {0, 0, -9.81},
            .forces = {{55, {4, 0, 12}}},
            .springs = {{41, 60, {-0.1, 0.15, 0.1}}, {20, 150, {0, 0.1, 0}}}};
  }
  static StepOptions options(NonlinearSolver solver) {
    StepOptions options{.tolerance = 1e-9, .max_iterations = 200};
    options.damping = {.alpha = 0.3, .beta = 2e-3};
    options.solver = solver;
    return options;
  }
  /// Displacements of all nodes after each step.
  template <typename System, typename ToNodes>
  static Matrix run(const System& system, NonlinearSolver solver, const ToNodes& to_nodes) {
    Newmark newmark(system, h, options(solver));
    const auto load = system.project(loads());
    State state = State::at_rest(system.dim());
    newmark.balance(load, state);
    Matrix result(to_nodes(state.u).size(), steps);
    for (Index k = 0; k < steps; ++k) {
      const StepReport report = newmark.step(load, state);
      EXPECT_EQ(to_string(report.status), "converged") << "step " << k << ": " << report.residual;
      result.col(k) = to_nodes(state.u);
    }
    return result;
  }
};

// With U = M^{−1/2} and all weights 1, nothing is left of the reduction but its machinery, and the reduced
// trajectory is the full one. Residuals of 1e-9 leave relative errors near 1e-9 in each of 20 steps.
TEST(Collapse, WithoutReductionTheReducedTrajectoryIsTheFullOne) {
  const StvkBar system = clamped_bar();
  const NodalBasis basis = whole_space(system);
  const auto nodal = unselected(system, basis);
  const auto dense = unselected(system, as_dense(basis));
  const Matrix full = Swing::run(system, NonlinearSolver(Newton{}), [&](VectorIn u) { return system.expand(u); });
  const double size = full.lpNorm<Eigen::Infinity>();
  ASSERT_GT(size, 0.1) << "the motion is to be nonlinear";
  ASSERT_GT((full.col(19) - full.col(9)).lpNorm<Eigen::Infinity>(), 0.01) << "and to move";
  for (const NonlinearSolver& solver :
       {NonlinearSolver(Newton{}), NonlinearSolver(Bfgs{}), NonlinearSolver(Broyden{})}) {
    SCOPED_TRACE(solver.index());
    EXPECT_TRUE(
        is_near(Swing::run(nodal, solver, [&](VectorIn q) { return basis.reconstruct(q); }), full, 1e-6 * size));
  }
  EXPECT_TRUE(
      is_near(Swing::run(dense, Newton{}, [&](VectorIn q) { return basis.reconstruct(q); }), full, 1e-6 * size));
}

}  // namespace
}  // namespace supple::test
