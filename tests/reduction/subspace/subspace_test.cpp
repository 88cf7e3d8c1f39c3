#include <physics/mesh/mass.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/training/training_poses.hpp>
#include <testing/subspace_builder_conformance.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/outside.hpp>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include <numbers>

namespace supple::test {

template <typename AnyBuilder, StvkBar system(), Index num_modes>
struct BarCase {
  static StvkBar make() { return system(); }
  static AnyBuilder builder() { return {.num_modes = num_modes}; }
};
using ModalCases = testing::Types<BarCase<ModalBasis, clamped_bar, 10>, BarCase<ModalBasis, free_bar, 10>>;
using ExtendedModalCases =
    testing::Types<BarCase<ExtendedModalBasis, clamped_bar, 6>, BarCase<ExtendedModalBasis, free_bar, 10>,
                   BarCase<ExtendedModalBasis, clamped_and_free_bars, 12>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Modal, SubspaceBuilderConformance, ModalCases);
INSTANTIATE_TYPED_TEST_SUITE_P(ExtendedModal, SubspaceBuilderConformance, ExtendedModalCases);

namespace {

/// B_kl u: at every node, component k is component l of u.
Vector under_linear_map(const Vector& u, int k, int l) {
  Vector result = Vector::Zero(u.size());
  for (Index v = 0; v < u.size() / 3; ++v) result[3 * v + k] = u[3 * v + l];
  return result;
}

TEST(ExtendedModalBasis, ContainsEveryModeUnderEveryLinearMap) {
  for (const bool held : {true, false}) {
    const StvkBar system = held ? clamped_bar() : free_bar();
    const Index r = held ? 6 : 10, rigid = held ? 0 : 6;
    const VibrationModes modes = vibration_modes(system, {.num_modes = r});
    ASSERT_EQ(modes.num_rigid, rigid);
    const NodalBasis basis = extend_modes(modes, system.model().rest_positions(), system.nodal_mass());
    for (Index i = 0; i < r; ++i)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l < 3; ++l)
          EXPECT_LT(outside(basis, system, under_linear_map(modes.vectors.col(i), k, l)), 1e-10)
              << "B_" << k << l << " of mode " << i;
    // and nothing that it does not promise: a random vector is far outside
    EXPECT_GT(outside(basis, system, system.expand(random_vector(system.dim(), 1, 1))), 0.1);
  }
}

TEST(ExtendedModalBasis, OfAFreeObjectContainsAllAffineMotions) {
  const StvkBar system = free_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 8}(system);
  const Points& x = system.model().rest_positions();
  for (int k = 0; k < 3; ++k) {
    EXPECT_LT(outside(basis, system, affine_displacement(x, Matrix3<double>::Identity(), Point::Unit(k))), 1e-12);
    for (int l = 0; l < 3; ++l) {
      Matrix3<double> F = Matrix3<double>::Identity();
      F(k, l) += 1;
      EXPECT_LT(outside(basis, system, affine_displacement(x, F)), 1e-12) << k << l;
    }
  }
}

TEST(ExtendedModalBasis, OfAHeldObjectContainsNoRigidMotion) {
  const StvkBar system = clamped_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 8}(system);
  const Vector shift =
      affine_displacement(system.model().rest_positions(), Matrix3<double>::Identity(), Point(1, 2, 3));
  EXPECT_GT(outside(basis, system, shift), 0.1);
}

TEST(ExtendedModalBasis, HasTheDimensionsOfThePaper) {
  EXPECT_EQ(ExtendedModalBasis{.num_modes = 15}(clamped_bar()).dim(), 9 * 15);
  EXPECT_EQ(ExtendedModalBasis{.num_modes = 15}(free_bar()).dim(), 93);  // 9 (15 − 6) + 12
  const NodalBasis both = ExtendedModalBasis{.num_modes = 15}(clamped_and_free_bars());
  EXPECT_EQ(both.dim(), 93);  // one of two parts is free
  EXPECT_EQ(both.report.rigid_modes, 6);
}

TEST(ExtendedModalBasis, FindsTheRotationsOfAFreeObjectExactly) {
  const StvkBar system = free_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 12}(system);
  const Matrix3<double> R =
      Eigen::AngleAxisd(70 * std::numbers::pi / 180, Point(1, -2, 0.5).normalized()).toRotationMatrix();
  EXPECT_LT(outside(basis, system, affine_displacement(system.model().rest_positions(), R, {0.1, 0, -2})), 1e-12);
  // the linear modes alone do not: they only know infinitesimal rotations
  const DenseBasis modal = ModalBasis{.num_modes = 12}(system);
  EXPECT_GT(outside(modal, system, affine_displacement(system.model().rest_positions(), R)), 1e-2);
}

TEST(ModalBasis, SaysWhichNumbersOfModesAreImpossible) {
  const auto message = [](auto&& call) -> std::string {
    try {
      call();
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no exception";
  };
  EXPECT_THAT(message([] { ModalBasis{.num_modes = 0}(clamped_bar()); }), testing::HasSubstr("number of modes is 0"));
  EXPECT_THAT(message([] { ModalBasis{.num_modes = 6}(free_bar()); }), testing::HasSubstr("6 rigid motions"));
  EXPECT_THAT(message([] { ModalBasis{.num_modes = 100000}(clamped_bar()); }),
              testing::HasSubstr("number of modes is 100000"));
}

TEST(MassOrthonormalize, DropsWhatDependsOnEarlierColumns) {
  RowMatrix W = random_matrix(30, 8, 1, 5);
  W.col(2) = 2 * W.col(0) - W.col(1);
  W.col(5).setZero();
  W.col(6) = W.col(3) + 1e-9 * W.col(7);
  const Vector mass = random_vector(30, 0.4, 6).array() + 0.5;
  const Orthonormalized result = mass_orthonormalize(W, mass);
  EXPECT_EQ(result.dropped, 3);
  ASSERT_EQ(result.W.cols(), 5);
  EXPECT_TRUE(is_near(result.W.transpose() * mass.asDiagonal() * result.W, Matrix::Identity(5, 5), 1e-14));
  const Matrix rest = W - result.W * (result.W.transpose() * mass.asDiagonal() * W);
  EXPECT_LT(rest.norm(), 1e-7 * W.norm());
  // a barely independent column is kept, and orthogonal as any other
  W.col(6) = W.col(3) + 1e-5 * W.col(7);
  const Orthonormalized more = mass_orthonormalize(W, mass);
  EXPECT_EQ(more.dropped, 3);  // now column 7 follows from 3 and 6
  EXPECT_TRUE(is_near(more.W.transpose() * mass.asDiagonal() * more.W, Matrix::Identity(5, 5), 1e-14));
}

TEST(ProjectStiffness, EqualsTheTripleProduct) {
  const auto check = [](const auto& basis, const StvkBar& system) {
    Matrix U(system.dim(), basis.dim());
    const Matrix full = basis.dense();
    for (Index j = 0; j < U.cols(); ++j) U.col(j) = system.restrict(full.col(j));
    const Matrix K = U.transpose() * (system.rest_stiffness() * U);
    const Matrix projected = project_stiffness(basis, system);
    EXPECT_TRUE(is_near(projected, K, 1e-12 * K.norm()));
    EXPECT_TRUE(is_same(projected, projected.transpose()));
    set_num_threads(1);
    EXPECT_TRUE(is_same(project_stiffness(basis, system), projected));
    set_num_threads(0);
  };
  for (const StvkBar& system : {clamped_bar(), free_bar(), clamped_and_free_bars()}) {
    check(ExtendedModalBasis{.num_modes = 9}(system), system);
    check(ModalBasis{.num_modes = 9}(system), system);
  }
}

TEST(ReducedModes, DiagonalizeTheReducedStiffness) {
  const StvkBar system = free_bar();
  const Matrix K = project_stiffness(ExtendedModalBasis{.num_modes = 9}(system), system);
  const ReducedModes modes = reduced_modes(K);
  EXPECT_EQ(modes.num_zero, 6);
  const Index d = K.rows();
  EXPECT_TRUE(is_near(modes.Phi.transpose() * modes.Phi, Matrix::Identity(d, d), 1e-12));
  const Matrix expected = modes.Phi * modes.omega.cwiseAbs2().asDiagonal() * modes.Phi.transpose();
  EXPECT_TRUE(is_near(expected, K, 1e-12 * K.norm()));
  const Vector positive = modes.positive_omega();
  EXPECT_TRUE(is_same(positive.head(6), Vector::Constant(6, modes.omega[6])));
  EXPECT_TRUE(is_same(positive.tail(d - 6), modes.omega.tail(d - 6)));
  EXPECT_EQ(modes.softest_stiffness(), positive[0] * positive[0]);
  EXPECT_THROW((void)reduced_modes(Matrix::Zero(3, 3)).positive_omega(), std::invalid_argument);
  EXPECT_THROW((void)reduced_modes(Matrix::Zero(3, 3)).softest_stiffness(), std::invalid_argument);
}

TEST(ReducedModes, TellMotionsWithoutEnergyFromASoftPartBesideAStiffOne) {
  const auto zero = [](std::vector<double> eigenvalues, std::optional<Index> known = {}) {
    return reduced_modes(Eigen::Map<const Vector>(eigenvalues.data(), 5).asDiagonal(), known).num_zero;
  };
  EXPECT_EQ(zero({46, 51, 1.4e4, 1e9, 1e13}), 0);  // a rubber bar on steel
  EXPECT_EQ(zero({-1e-4, 3e-4, 50, 1e6, 1e11}), 2);
  EXPECT_EQ(zero({1e-4, 3e-4, 50, 1e6, 1e11}, 0), 0);  // if the caller knows
  EXPECT_EQ(zero({0, 0, 0, 0, 0}), 5);
  EXPECT_THROW((void)reduced_modes(Vector::Zero(2).asDiagonal(), 0).positive_omega(), std::invalid_argument);
  EXPECT_THROW((void)reduced_modes(Matrix(0, 0)), std::invalid_argument);
}

TEST(VibrationModes, OfACantileverFallTowardsTheBeamUnderRefinement) {
  // Linear tets lock in bending, so frequencies come from above; lumping pulls them down by far less. The
  // coarsest meshes are not asymptotic: expected is a monotone fall that slows down.
  const double L = 0.6, side = 0.2, E = 1e6, rho = 1000;
  const double beam = 1.8751 * 1.8751 / (L * L) * std::sqrt(E * side * side / 12 / rho);  // Euler–Bernoulli
  std::vector<double> error;
  for (const Index refine : {1, 2, 4}) {
    const TetMesh mesh = kuhn_box(3 * refine, refine, refine, side / static_cast<double>(refine));
    const FullSystem<TetElasticity<StVenantKirchhoff>> system(
        TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = E, .poisson = 0})),
        lumped_mass(mesh, rho), nodes_where(mesh, [](const Point& x) { return x[0] < 1e-9; }));
    const VibrationModes modes = vibration_modes(system, {.num_modes = 2});
    error.push_back(modes.omega[0] / beam - 1);
  }
  // A beam of length three times its side shears and turns, too: Timoshenko's frequency is some 7 % lower.
  EXPECT_GT(error[0], error[1]);
  EXPECT_GT(error[1], error[2]);
  EXPECT_GT((error[0] - error[1]) / (error[1] - error[2]), 1.8);
  EXPECT_GT(error[2], -0.08);
  EXPECT_LT(error[2], 0.08);
}

TEST(VibrationModes, OfAFreeBarFindTheAxialWaveAtSecondOrder) {
  // ν = 0 leaves axial waves alone: ω = π/L √(E/ρ) between free ends. The mode is told from bending and
  // torsion by its shape cos(πx/L). Tets that meet at the boundary carry different masses, so the wave is not
  // quite plane: errors fall by about four, not exactly.
  const double L = 0.4, E = 1e6, rho = 1000;
  const double exact = std::numbers::pi / L * std::sqrt(E / rho);
  std::vector<double> error;
  for (const Index refine : {1, 2, 4}) {
    const TetMesh mesh = kuhn_box(2 * refine, refine, refine, L / static_cast<double>(2 * refine));
    const FullSystem<TetElasticity<StVenantKirchhoff>> system(
        TetElasticity<StVenantKirchhoff>(mesh, StVenantKirchhoff<double>::from({.young = E, .poisson = 0})),
        lumped_mass(mesh, rho), {});
    const VibrationModes modes = vibration_modes(system, {.num_modes = refine == 1 ? 20 : 26});
    Vector wave = Vector::Zero(3 * mesh.num_nodes());
    for (Index v = 0; v < mesh.num_nodes(); ++v)
      wave[3 * v] = system.nodal_mass()[v] * std::cos(std::numbers::pi * mesh.nodes(v, 0) / L);
    Index axial = 0;
    (modes.vectors.transpose() * wave).cwiseAbs().maxCoeff(&axial);
    error.push_back(std::abs(modes.omega[axial] / exact - 1));
  }
  EXPECT_LT(error[2], 0.02);
  EXPECT_GT(std::log2(error[1] / error[2]), 1.6);
}

struct Poses : testing::Test {
  static PoseOptions some(Index count) {
    PoseOptions options;
    options.count = count;
    return options;
  }
  TrainingPoses sample(const PoseOptions& options) const {
    return sample_poses(system.shared_model(), basis, modes, total_mass, diagonal, options);
  }
  std::vector<Index> inverted(const Matrix& Q) const { return count_inverted(system.shared_model(), basis, Q); }

  const StvkBar system = free_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 9}(system);
  const ReducedModes modes = reduced_modes(project_stiffness(basis, system));
  const double total_mass = system.nodal_mass().sum();
  const double diagonal = bounding_box(system.model().rest_positions()).diagonal();
};

TEST_F(Poses, FollowTheSeedAndNothingElse) {
  PoseOptions options = some(21);
  const Matrix Q = sample(options).Q;
  set_num_threads(1);
  EXPECT_TRUE(is_same(sample(options).Q, Q));
  set_num_threads(2);
  EXPECT_TRUE(is_same(sample(options).Q, Q));
  set_num_threads(0);
  options.seed = 2;
  EXPECT_GT((sample(options).Q - Q).norm(), 0.1 * Q.norm());
}

TEST_F(Poses, HaveTheRmsDisplacementsThatWereAskedForInTurn) {
  PoseOptions options = some(3000);
  options.omega_exponent = 1;
  options.amplitudes = {0.05, 0.002, 0.01};
  const Matrix Q = sample(options).Q;
  for (Index k = 0; k < 3; ++k) {
    const Matrix part = Q(Eigen::all, Eigen::seqN(k, 1000, 3));
    // The mean of 1000 values of ‖q‖², each a sum of squares of normal numbers: at most √(2/1000) = 4.5 % off
    // (one standard deviation, all of it in one mode); the root halves that.
    const double rms = std::sqrt(part.squaredNorm() / 1000 / total_mass);
    EXPECT_NEAR(rms / diagonal, options.amplitudes[k], 0.09 * options.amplitudes[k]);
  }
  // the same from the displacements of the nodes
  const Vector u = basis.reconstruct(Q.col(0));
  double mean = 0;
  for (Index v = 0; v < system.num_nodes(); ++v)
    mean += system.nodal_mass()[v] * u.segment<3>(3 * v).squaredNorm() / total_mass;
  EXPECT_NEAR(mean, Q.col(0).squaredNorm() / total_mass, 1e-12 * mean);
}

TEST_F(Poses, SpreadAsThePowerOfTheFrequency) {
  for (const double exponent : {1.0, 2.0}) {
    PoseOptions options = some(2000);
    options.omega_exponent = exponent;
    options.amplitudes = {0.01};
    const Matrix coordinates = modes.Phi.transpose() * sample(options).Q;
    EXPECT_LT(coordinates.topRows(6).norm(), 1e-12 * coordinates.norm()) << "rigid modes are at rest";
    const Index a = 6, b = modes.omega.size() - 1;
    const double ratio = coordinates.row(a).norm() / coordinates.row(b).norm();
    EXPECT_NEAR(ratio / std::pow(modes.omega[b] / modes.omega[a], exponent), 1, 0.1);
  }
}

TEST_F(Poses, AreKeptShrunkOrDrawnAgainWhenTetsInvert) {
  PoseOptions options = some(40);
  options.omega_exponent = 1;
  options.amplitudes = {0.5, 0.001};  // every other one is far too large
  const TrainingPoses kept = sample(options);
  Index bad = 0, components = 0;
  for (const Index count : inverted(kept.Q)) bad += count > 0, components += count;
  EXPECT_GE(bad, 15);
  EXPECT_LE(bad, 20);
  EXPECT_EQ(kept.inverted, bad);
  EXPECT_EQ(kept.inverted_components, components);
  EXPECT_EQ(kept.shrunk, 0);

  options.inverted = InvertedPoses::Shrink;
  const TrainingPoses shrunk = sample(options);
  EXPECT_EQ(shrunk.inverted, bad);
  EXPECT_EQ(shrunk.shrunk, bad);
  EXPECT_EQ(shrunk.redrawn, 0);
  for (const Index count : inverted(shrunk.Q)) EXPECT_EQ(count, 0);
  const std::vector<Index> before = inverted(kept.Q);
  for (Index t = 0; t < 40; ++t) {
    const double scale = shrunk.Q.col(t).norm() / kept.Q.col(t).norm();
    EXPECT_TRUE(is_near(shrunk.Q.col(t), scale * kept.Q.col(t), 1e-12 * kept.Q.col(t).norm()));
    const double steps = std::log(scale) / std::log(0.75);
    EXPECT_NEAR(steps, std::round(steps), 1e-9);
    EXPECT_EQ(before[t] > 0, steps > 0.5);
    if (before[t] > 0) {  // no smaller than it has to be
      EXPECT_GT(inverted(shrunk.Q.col(t) / 0.75)[0], 0) << "pose " << t;
    }
  }

  options.inverted = InvertedPoses::Redraw;
  options.amplitudes = {0.15, 0.001};  // some draws have inverted tets, some do not
  const TrainingPoses redrawn = sample(options);
  EXPECT_GT(redrawn.inverted, 0);
  EXPECT_GE(redrawn.redrawn, redrawn.inverted);
  for (const Index count : inverted(redrawn.Q)) EXPECT_EQ(count, 0);
}

TEST_F(Poses, RefuseImpossibleOptions) {
  EXPECT_THROW((void)sample(some(0)), std::invalid_argument);
  PoseOptions options = some(3);
  options.amplitudes = {};
  EXPECT_THROW((void)sample(options), std::invalid_argument);
  for (const double wrong : {0.0, -1.0, std::nan("")}) {
    options.amplitudes = {0.1, wrong};
    EXPECT_THROW((void)sample(options), std::invalid_argument);
  }
  options = some(3);
  for (const double wrong : {std::nan(""), 1e4}) {
    options.omega_exponent = wrong;
    EXPECT_THROW((void)sample(options), std::invalid_argument);
  }
}

}  // namespace
}  // namespace supple::test
