#include <reduction/basis/modal_basis.hpp>
#include <reduction/basis/pca_basis.hpp>
#include <reduction/system/galerkin_system.hpp>
#include <reduction/system/reduced_system.hpp>
#include <reduction/training/force_fitting.hpp>
#include <reduction/training/training_poses.hpp>
#include <sparse/selectors/nn_htp.hpp>
#include <sparse/selectors/nn_omp.hpp>
#include <sparse/selectors/nn_sp.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/heat.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

namespace supple::test {
namespace {

using Reduced = ReducedSystem<Conduction, DenseBasis>;

std::vector<Index> all_tets(const HeatedBar& bar) {
  std::vector<Index> all(bar.mesh.num_cells());
  std::iota(all.begin(), all.end(), Index{0});
  return all;
}
Reduced reduced_system(const HeatedBar& bar, const std::shared_ptr<const DenseBasis>& basis,
                       const std::vector<Index>& indices, VectorIn weights) {
  return {bar.system->shared_model(), basis, indices, weights, project_stiffness(*basis, *bar.system),
          bar.system->nodal_mass()};
}

/// Steps of heating with two burners; `phase` tells training from what is held out.
constexpr Index num_steps = 60;
constexpr double h = 100;
Vector burners(const HeatedBar& bar, double t, double phase) {
  return bar.end_flow(900 * (1 + std::sin(2e-3 * t + phase)) / 2) +
         bar.side_flow(700 * (1 + std::cos(3e-3 * t + 2 * phase)) / 2);
}
Matrix full_motion(const HeatedBar& bar, double phase) {
  return heat_up(
      *bar.system, h, num_steps, {.tolerance = 1e-8}, [&](double t) { return burners(bar, t, phase); },
      [&](VectorIn u) { return bar.system->expand(u); });
}

/// Everything from snapshots to selection, at a size for tests.
struct TrainedBar {
  HeatedBar bar;
  Matrix snapshots = full_motion(bar, 0), held_out = full_motion(bar, 1);
  std::shared_ptr<const DenseBasis> basis =
      std::make_shared<const DenseBasis>(PcaBasis{.snapshots = snapshots, .dimension = 6}(*bar.system));
  ReducedModes modes = reduced_modes(project_stiffness(*basis, *bar.system));

  ForceFitting<Conduction, DenseBasis> fitting(const Matrix& temperatures, ForceNorm norm) const {
    return {bar.system->shared_model(), basis, force_metric(norm, modes),
            poses_in_subspace(*basis, bar.system->nodal_mass(), temperatures)};
  }
};

TEST(HeatSubspaces, PrincipalComponentsOfTemperaturesAreOrthonormalInTheCapacities) {
  const TrainedBar trained;
  const HeatedBar& bar = trained.bar;
  const Matrix U = trained.basis->dense();
  ASSERT_EQ(U.rows(), bar.mesh.num_nodes());
  EXPECT_TRUE(is_near(U.transpose() * bar.system->nodal_mass().asDiagonal() * U, Matrix::Identity(6, 6), 1e-12));
  for (const Index v : bar.system->numbering().fixed_nodes()) EXPECT_TRUE(U.row(v).isZero(0));
  // what they leave out of the snapshots are the remaining singular values
  const Matrix Q = poses_in_subspace(*trained.basis, bar.system->nodal_mass(), trained.snapshots);
  const Matrix rest = bar.system->nodal_mass().cwiseSqrt().asDiagonal() * (trained.snapshots - U * Q);
  const Vector& sigma = trained.basis->report.singular_values;
  EXPECT_NEAR(rest.norm(), sigma.tail(sigma.size() - 6).norm(), 1e-9 * sigma[0]);
}

// A rod, insulated but for one end, cools at rates ((j − ½) π / L)² k / (ρ c); linear elements and lumped capacities
// err at second order, here by (½ π / 24)² / 12 and less than 1 % at the third.
TEST(HeatSubspaces, ModesDecayAtTheRatesOfARod) {
  const TetMesh mesh = kuhn_box(24, 1, 1, 1.0 / 24);
  const FullSystem<Conduction> system(Conduction(mesh, LinearConductivity<double>::from(40, 0.005)),
                                      lumped_heat_capacity(mesh, 2700, 900),
                                      nodes_where(mesh, [](const Point& x) { return x[0] < 1e-9; }));
  const DenseBasis basis = ModalBasis{.num_modes = 3}(system);
  for (int j = 0; j < 3; ++j) {
    const double rate = std::pow((j + 0.5) * std::numbers::pi, 2) * 40 / (2700 * 900);
    EXPECT_NEAR(std::pow(basis.report.omega[j], 2), rate, 0.01 * rate) << "mode " << j;
  }
}

TEST(HeatSystems, ReducedTangentsAreProjectionsThoughTheyAreNotSymmetric) {
  const HeatedBar bar;
  auto basis = std::make_shared<DenseBasis>(DenseBasis{random_matrix(bar.mesh.num_nodes(), 5, 1, 3), {}});
  for (const Index v : bar.system->numbering().fixed_nodes()) basis->W.row(v).setZero();
  const GalerkinSystem<Conduction, DenseBasis> galerkin(bar.system, basis);
  const Reduced reduced = reduced_system(bar, basis, all_tets(bar), Vector::Ones(bar.mesh.num_cells()));
  Matrix U(bar.system->dim(), 5);
  for (Index j = 0; j < 5; ++j) U.col(j) = bar.system->restrict(basis->W.col(j));
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Vector q = (seed == 0 ? 0 : 40.0) * random_vector(5, 1, seed);
    const Matrix K = U.transpose() * (bar.system->stiffness(U * q) * U);
    const Vector f = U.transpose() * bar.system->force(U * q);
    if (seed > 0) {
      ASSERT_GT((K - K.transpose()).norm(), 0.02 * K.norm());
    }
    Matrix K_galerkin, K_reduced;
    galerkin.stiffness(q, K_galerkin);
    reduced.stiffness(q, K_reduced);
    EXPECT_TRUE(is_near(K_galerkin, K, 1e-12 * K.norm()));
    EXPECT_TRUE(is_near(K_reduced, K, 1e-12 * K.norm()));
    Vector f_galerkin(5);
    galerkin.force(q, f_galerkin);
    EXPECT_TRUE(is_near(f_galerkin, f, 1e-12 * K.norm() * (1 + q.norm())));
    EXPECT_TRUE(is_near(reduced.force(q), f, 1e-12 * K.norm() * (1 + q.norm())));
  }
  const Vector flow = random_vector(bar.mesh.num_nodes(), 10, 9), loads = basis->W.transpose() * flow;
  EXPECT_TRUE(is_near(galerkin.project(flow).force, loads, 1e-12 * loads.norm()));
  EXPECT_TRUE(is_near(reduced.project(flow).force, loads, 1e-12 * loads.norm()));
  EXPECT_FALSE(reduced.project(flow).has_stiffness());
}

/// Independent nodes in ℝ³ that are held and pushed sideways: f = k u + c |u|² a × u. No potential.
class Whirl {
 public:
  static constexpr int stencil_size = 1, node_dim = 3, local_dofs = 3;
  static constexpr bool symmetric_tangent = false;

  explicit Whirl(Index count) : nodes_(count) { std::iota(nodes_.begin(), nodes_.end(), Index{0}); }
  Index num_nodes() const { return num_components(); }
  Index num_components() const { return static_cast<Index>(nodes_.size()); }
  std::span<const Index, 1> stencil(Index i) const { return std::span<const Index, 1>(&nodes_[i], 1); }
  Local<3> force(Index, const Local<3>& u) const { return k * u + c * u.squaredNorm() * axis * u; }
  LocalMatrix<3> stiffness(Index, const Local<3>& u) const {
    return k * LocalMatrix<3>::Identity() + c * (u.squaredNorm() * axis + 2 * axis * u * u.transpose());
  }

 private:
  static constexpr double k = 40, c = 900;
  const Matrix3<double> axis = (Matrix3<double>() << 0, -0.5, 2, 0.5, 0, -1, -2, 1, 0).finished();  // a × for (1, 2, ½)
  std::vector<Index> nodes_;
};
static_assert(ForceModel<Whirl> && !PotentialModel<Whirl>);

// The same for W ⊗ I₃, where tangents are summed by pairs of axes.
TEST(ReducedSystems, TangentsOfBlocksNeedNotBeSymmetricEither) {
  const auto system =
      std::make_shared<const FullSystem<Whirl>>(Whirl(21), Vector::LinSpaced(21, 0.5, 2.5), std::vector<Index>{4, 9});
  auto basis = std::make_shared<NodalBasis>(NodalBasis{random_matrix(21, 4, 1, 3), {}});
  for (const Index v : {4, 9}) basis->W.row(v).setZero();
  const GalerkinSystem<Whirl, NodalBasis> galerkin(system, basis);
  std::vector<Index> all(21);
  std::iota(all.begin(), all.end(), Index{0});
  const ReducedSystem<Whirl, NodalBasis> reduced(system->shared_model(), basis, all, Vector::Ones(21),
                                                 project_stiffness(*basis, *system), system->nodal_mass());
  const Matrix full = basis->dense();
  Matrix U(system->dim(), 12);
  for (Index j = 0; j < 12; ++j) U.col(j) = system->restrict(full.col(j));
  const Vector q = random_vector(12, 0.2, 6);
  const Matrix K = U.transpose() * (system->stiffness(U * q) * U);
  ASSERT_GT((K - K.transpose()).norm(), 0.1 * K.norm());
  Matrix K_galerkin;
  galerkin.stiffness(q, K_galerkin);
  EXPECT_TRUE(is_near(K_galerkin, K, 1e-12 * K.norm()));
  EXPECT_TRUE(is_near(reduced.stiffness(q), K, 1e-12 * K.norm()));
  EXPECT_TRUE(is_near(reduced.force(q), U.transpose() * system->force(U * q), 1e-12 * K.norm()));
}

TEST(HeatSystems, SumsWeightedTets) {
  const HeatedBar bar;
  const auto basis = std::make_shared<const DenseBasis>(DenseBasis{random_matrix(bar.mesh.num_nodes(), 4, 1, 3), {}});
  const std::vector<Index> indices{3, 14, 15, 60, 61, 77, 100, 101, 130};
  const Vector w = random_vector(9, 2, 5).cwiseAbs(), q = random_vector(4, 40, 6);
  Vector f = Vector::Zero(4);
  Matrix K = Matrix::Zero(4, 4);
  for (std::size_t k = 0; k < indices.size(); ++k) {
    Matrix rows(4, 4);
    for (int a = 0; a < 4; ++a) rows.row(a) = basis->W.row(bar.mesh.cells[indices[k]][a]);
    f += w[k] * rows.transpose() * bar.system->model().force(indices[k], rows * q);
    K += w[k] * rows.transpose() * bar.system->model().stiffness(indices[k], rows * q) * rows;
  }
  const Reduced reduced = reduced_system(bar, basis, indices, w);
  EXPECT_TRUE(is_near(reduced.force(q), f, 1e-12 * f.norm()));
  EXPECT_TRUE(is_near(reduced.stiffness(q), K, 1e-12 * K.norm()));
}

// With U = C^{−1/2} and all weights 1 nothing is left of the reduction but its machinery.
TEST(HeatSystems, WithoutReductionTheReducedTrajectoryIsTheFullOne) {
  const HeatedBar bar;
  const NodeNumbering& numbering = bar.system->numbering();
  auto basis =
      std::make_shared<DenseBasis>(DenseBasis{RowMatrix::Zero(bar.mesh.num_nodes(), numbering.num_free()), {}});
  for (Index f = 0; f < numbering.num_free(); ++f)
    basis->W(numbering.free_nodes()[f], f) = 1 / std::sqrt(bar.system->nodal_mass()[numbering.free_nodes()[f]]);
  const Reduced reduced = reduced_system(bar, basis, all_tets(bar), Vector::Ones(bar.mesh.num_cells()));
  const auto flows = [&](double t) { return burners(bar, t, 0); };
  for (const FirstOrderMethod method : {FirstOrderMethod::BackwardEuler, FirstOrderMethod::Bdf2}) {
    const FirstOrderOptions options{.method = method, .tolerance = 1e-10};
    const Matrix full = heat_up(*bar.system, h, 15, options, flows, [&](VectorIn u) { return bar.system->expand(u); });
    EXPECT_GT(full.maxCoeff(), 50) << "the conductivity is to vary";
    EXPECT_TRUE(is_near(heat_up(reduced, h, 15, options, flows, [&](VectorIn q) { return basis->reconstruct(q); }),
                        full, 1e-7 * full.maxCoeff()));
  }
}

TEST(HeatFitting, ColumnsAreTheProjectedFlowsOfTets) {
  const TrainedBar trained;
  for (const ForceNorm norm : {ForceNorm::Mass, ForceNorm::Stiffness}) {
    const auto fitting = trained.fitting(trained.snapshots.leftCols(20), norm);
    const Matrix L = force_metric(norm, trained.modes);
    EXPECT_NEAR(fitting.error(all_tets(trained.bar), Vector::Ones(trained.bar.mesh.num_cells())), 0, 1e-12);
    const Index j = 77;
    Vector column(fitting.rows());
    fitting.column(j, column);
    Matrix rows(4, 6);
    for (int a = 0; a < 4; ++a) rows.row(a) = trained.basis->W.row(trained.bar.mesh.cells[j][a]);
    for (Index t = 0; t < 20; ++t) {
      const Vector expected = L * rows.transpose() *
                              trained.bar.system->model().force(j, rows * fitting.poses().col(t)) /
                              (L * fitting.forces().col(t)).norm();
      EXPECT_TRUE(is_near(column.segment(6 * t, 6), expected, 1e-12));
    }
  }
}

/// What every selector is judged by, as for elasticity.
template <typename Selector>
void expect_a_good_reduction(const TrainedBar& trained, const Selector& select) {
  constexpr Index s = 40;
  const auto fitting = trained.fitting(trained.snapshots, ForceNorm::Stiffness);
  const Selection selection = select(fitting, s);
  ASSERT_LE(selection.size(), s);
  ASSERT_GT(selection.weights.minCoeff(), 0);
  EXPECT_NEAR(selection.report.training_error, fitting.error(selection.indices, selection.weights), 1e-8);
  EXPECT_LT(selection.report.training_error, 0.01);
  EXPECT_LT(trained.fitting(trained.held_out, ForceNorm::Stiffness).error(selection.indices, selection.weights), 0.03);

  const Reduced reduced = reduced_system(trained.bar, trained.basis, selection.indices, selection.weights);
  const Matrix theta = heat_up(
      reduced, h, num_steps, {.tolerance = 1e-8}, [&](double t) { return burners(trained.bar, t, 1); },
      [&](VectorIn q) { return trained.basis->reconstruct(q); });
  EXPECT_LT((theta - trained.held_out).norm(), 0.03 * trained.held_out.norm());
}

struct HeatSelection : testing::Test {
  static void SetUpTestSuite() { trained = std::make_unique<TrainedBar>(); }
  static void TearDownTestSuite() { trained.reset(); }
  static inline std::unique_ptr<TrainedBar> trained;
};

TEST_F(HeatSelection, ByNnOmpServesTrainingHeldOutStatesAndTrajectories) {
  expect_a_good_reduction(*trained, NnOmp{});
}
TEST_F(HeatSelection, ByNnHtpServesTrainingHeldOutStatesAndTrajectories) {
  expect_a_good_reduction(*trained, NnHtp{});
}
TEST_F(HeatSelection, ByNnSpServesTrainingHeldOutStatesAndTrajectories) {
  expect_a_good_reduction(*trained, NnSp{});
}

}  // namespace
}  // namespace supple::test
