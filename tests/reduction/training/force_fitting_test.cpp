#include <reduction/basis/modal_basis.hpp>
#include <reduction/training/force_fitting.hpp>
#include <testing/near.hpp>
#include <testing/random_vectors.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/spring_network.hpp>

#include <gmock/gmock.h>

namespace supple::test {
namespace {

/// A small fitting problem next to A and b as Eq. 5 writes them: each column from the forces of one component
/// at all nodes, times Uᵀ, pose by pose.
template <typename AnyModel, typename Basis>
struct Explicit {
  using Fitting = ForceFitting<AnyModel, Basis>;

  Explicit(AnyModel the_model, Basis the_basis, const Matrix& metric, Matrix the_poses)
      : model(std::make_shared<const AnyModel>(std::move(the_model))),
        basis(std::make_shared<const Basis>(std::move(the_basis))),
        Q(std::move(the_poses)),
        fitting(model, basis, metric, Q),
        A(fitting.rows(), fitting.cols()),
        b(fitting.rows()) {
    const Matrix U = basis->dense();
    const Index d = U.cols(), m = model->num_components();
    for (Index t = 0; t < Q.cols(); ++t) {
      const Vector u = U * Q.col(t);
      Matrix forces = Matrix::Zero(u.size(), m);
      for (Index i = 0; i < m; ++i) {
        Local<AnyModel::local_dofs> u_i;
        const auto nodes = model->stencil(i);
        for (int k = 0; k < AnyModel::local_dofs; ++k) u_i[k] = u[nodes[k / 3] * 3 + k % 3];
        const auto f_i = model->force(i, u_i);
        for (int k = 0; k < AnyModel::local_dofs; ++k) forces(nodes[k / 3] * 3 + k % 3, i) += f_i[k];
      }
      const Matrix reduced = metric * (U.transpose() * forces);
      const Vector sum = reduced.rowwise().sum();
      A.middleRows(t * d, d) = reduced / sum.norm();
      b.segment(t * d, d) = sum / sum.norm();
    }
  }

  std::shared_ptr<const AnyModel> model;
  std::shared_ptr<const Basis> basis;
  Matrix Q;
  Fitting fitting;
  Matrix A;
  Vector b;
};

void expect_same_columns(const auto& block, MatrixIn A_C, std::uint64_t seed, double rounding) {
  ASSERT_EQ(block.size(), A_C.cols());
  const Vector w = random_vector(A_C.cols(), 1, seed), r = random_vector(A_C.rows(), 1, seed + 1);
  const double norm = A_C.norm();
  EXPECT_TRUE(is_near(block.times(w), A_C * w, rounding * norm * w.norm()));
  EXPECT_TRUE(is_near(block.transpose_times(r), A_C.transpose() * r, rounding * norm * r.norm()));
  const Matrix G = block.gram(block);
  EXPECT_TRUE(is_near(G, A_C.transpose() * A_C, rounding * norm * norm));
  EXPECT_TRUE(is_same(G, G.transpose()));
  EXPECT_TRUE(is_near(block.squared_norms(), A_C.colwise().squaredNorm().transpose(), rounding * norm * norm));
}

/// All that a fitting problem offers against the explicit A and b.
template <typename E>
void expect_consistent(const E& e) {
  const auto& fitting = e.fitting;
  const double rounding = 1e-12;  // sums of some hundred terms in another order
  const Index T = e.Q.cols(), d = e.basis->dim(), m = fitting.cols();
  ASSERT_EQ(fitting.rows(), d * T);
  ASSERT_EQ(m, e.model->num_components());
  EXPECT_EQ(fitting.num_poses(), T);
  EXPECT_TRUE(is_near(fitting.rhs(), e.b, rounding));
  for (Index t = 0; t < T; ++t) EXPECT_NEAR(fitting.rhs().segment(t * d, d).norm(), 1, 1e-14) << "pose " << t;

  for (const Index j : {Index{0}, m / 2, m - 1}) {
    Vector column(fitting.rows());
    fitting.column(j, column);
    EXPECT_TRUE(is_near(column, e.A.col(j), rounding * e.A.col(j).norm())) << "column " << j;
  }

  std::vector<Index> js{3, m - 1, 0, 7, 5};                                                // in any order
  for (Index j = 8; j < m && static_cast<Index>(js.size()) < 61; j += 2) js.push_back(j);  // several tiles
  auto block = fitting.columns(js);
  for (Index k = 0; k < block.size(); ++k) EXPECT_EQ(block.index(k), js[k]);
  expect_same_columns(block, e.A(Eigen::all, js), 1, rounding);

  const std::vector<Index> others{1, 3, m - 2};
  const auto other = fitting.columns(others);
  const Matrix cross = e.A(Eigen::all, js).transpose() * e.A(Eigen::all, others);
  EXPECT_TRUE(is_near(block.gram(other), cross, rounding * cross.norm()));

  const std::vector<Index> positions{4, 1, 2}, picked{js[4], js[1], js[2]};
  auto subset = block.subset(positions);
  expect_same_columns(subset, e.A(Eigen::all, picked), 2, rounding);
  subset.append(fitting.columns(std::vector<Index>{2, 1}));
  expect_same_columns(subset, e.A(Eigen::all, std::vector<Index>{js[4], js[1], js[2], 2, 1}), 3, rounding);

  const Vector r = random_vector(fitting.rows(), 1, 4);
  EXPECT_TRUE(is_near(fitting.transpose_times(r), e.A.transpose() * r, rounding * e.A.norm() * r.norm()));
  const Vector squared = e.A.colwise().squaredNorm();
  EXPECT_TRUE(is_near(fitting.squared_norms(), squared, rounding * squared.maxCoeff()));

  const Vector w = random_vector(static_cast<Index>(js.size()), 1, 5).cwiseAbs();
  EXPECT_NEAR(fitting.error(js, w), (e.A(Eigen::all, js) * w - e.b).norm() / e.b.norm(), rounding);
  EXPECT_LT(fitting.error(all_components(m), Vector::Ones(m)), rounding) << "all components at weight one";

  const std::vector<Index> poses{T - 1, 0, 2};
  const auto some = fitting.restricted_to(poses);
  Matrix A_some(3 * d, m);
  for (Index k = 0; k < 3; ++k) A_some.middleRows(k * d, d) = e.A.middleRows(poses[k] * d, d);
  ASSERT_EQ(some.rows(), 3 * d);
  expect_same_columns(some.columns(js), A_some(Eigen::all, js), 6, rounding);
  EXPECT_TRUE(is_near(some.rhs(), A_some.rowwise().sum(), rounding));
  const Vector r_some = random_vector(some.rows(), 1, 7);
  EXPECT_TRUE(
      is_near(some.transpose_times(r_some), A_some.transpose() * r_some, rounding * A_some.norm() * r_some.norm()));

  EXPECT_THROW((void)block.times(Vector::Zero(2)), std::invalid_argument);
  EXPECT_THROW((void)block.transpose_times(Vector::Zero(2)), std::invalid_argument);
  EXPECT_THROW((void)fitting.transpose_times(Vector::Zero(2)), std::invalid_argument);
}

/// Poses of a size at which tets stretch by tens of percent.
Matrix poses(Index d, Index count) {
  return random_matrix(d, count, 0.12, 31);
}

template <int block>
KroneckerBasis<block> random_basis(Index rows, Index cols) {
  return {random_matrix(rows, cols, 1, 17), {}};
}

TEST(ForceFitting, AgreesWithTheExplicitMatrixForTetsInAnExtendedBasis) {
  const StvkBar system = clamped_bar();
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 4}(system);
  const ReducedModes modes = reduced_modes(project_stiffness(basis, system));
  for (const ForceNorm norm : {ForceNorm::Mass, ForceNorm::Stiffness})
    for (const Index T : {11, 16})  // with and without free lanes
      expect_consistent(Explicit(TetElasticity<StVenantKirchhoff>(system.model()), NodalBasis(basis),
                                 force_metric(norm, modes), poses(basis.dim(), T)));
}

TEST(ForceFitting, AgreesWithTheExplicitMatrixForTetsInADenseBasis) {
  const StvkBar system = free_bar();
  const DenseBasis basis = ModalBasis{.num_modes = 11}(system);
  const ReducedModes modes = reduced_modes(project_stiffness(basis, system));
  expect_consistent(Explicit(TetElasticity<StVenantKirchhoff>(system.model()), DenseBasis(basis),
                             force_metric(ForceNorm::Stiffness, modes), poses(basis.dim(), 5)));
}

TEST(ForceFitting, AgreesWithTheExplicitMatrixForSpringsWithoutPacks) {
  const SpringNetwork springs = edge_springs(bar_mesh(), 200);
  expect_consistent(Explicit(SpringNetwork(springs), random_basis<3>(springs.num_nodes(), 5),
                             random_matrix(15, 15, 1, 2), random_matrix(15, 10, 0.01, 3)));
}

TEST(ForceFitting, AgreesWithTheExplicitMatrixForTermsThatFeelTranslations) {
  expect_consistent(Explicit(DuffingOscillators(70, 40, 900), random_basis<3>(70, 4), random_matrix(12, 12, 1, 2),
                             random_matrix(12, 9, 0.3, 3)));
}

TEST(ForceFitting, DoesNotDependOnTheNumberOfThreads) {
  const StvkBar system = clamped_bar();
  const auto basis = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 4}(system));
  const Matrix Q = poses(basis->dim(), 20), L = Matrix::Identity(basis->dim(), basis->dim());
  const auto evaluate = [&](int threads) {
    set_num_threads(threads);
    const ForceFitting fitting(system.shared_model(), basis, L, Q);
    const auto block = fitting.columns(all_components(fitting.cols()));
    const Vector r = random_vector(fitting.rows(), 1, 1);
    Vector all(3 * fitting.cols() + 2 * fitting.rows() + 1);
    all << fitting.transpose_times(r), block.transpose_times(r), fitting.squared_norms(), fitting.rhs(),
        block.times(Vector::Ones(fitting.cols())), block.gram(block).sum();
    return all;
  };
  const Vector one = evaluate(1);
  EXPECT_TRUE(is_same(evaluate(2), one));
  EXPECT_TRUE(is_same(evaluate(3), one));
  set_num_threads(0);
}

TEST(ForceMetric, MeasuresForcesByTheDisplacementsTheyCause) {
  const StvkBar system = clamped_bar();
  const Matrix K = project_stiffness(ModalBasis{.num_modes = 6}(system), system);
  const ReducedModes modes = reduced_modes(K);
  const Matrix L = force_metric(ForceNorm::Stiffness, modes);
  EXPECT_TRUE(is_near(L.transpose() * L * K, Matrix::Identity(6, 6), 1e-10));
  EXPECT_TRUE(is_same(force_metric(ForceNorm::Mass, modes), Matrix::Identity(6, 6)));
}

/// What an exception of this type says.
template <typename Error, typename Call>
std::string message(Call&& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no exception";
}

TEST(ForceFitting, RefusesPosesThatItCannotUse) {
  const StvkBar system = clamped_bar();
  const auto basis = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 2}(system));
  const Index d = basis->dim();
  const Matrix L = Matrix::Identity(d, d);
  const auto fit = [&](const Matrix& metric, const Matrix& Q) {
    return [&] { ForceFitting fitting(system.shared_model(), basis, metric, Q); };
  };
  Matrix Q = poses(d, 12);
  Q(4, 9) = std::nan("");
  EXPECT_THAT(message<InputError>(fit(L, Q)), testing::HasSubstr("pose 9: the force is not finite"));
  Q.col(9).setZero();
  EXPECT_THAT(message<InputError>(fit(L, Q)), testing::HasSubstr("pose 9: there is no force"));
  Q.col(9) = 1e-12 * Q.col(8);  // what rounding leaves of a rigid motion is no larger
  EXPECT_THAT(message<InputError>(fit(L, Q)), testing::HasSubstr("pose 9: there is no force"));
  EXPECT_THAT(message<std::invalid_argument>(fit(L, Matrix(d, 0))), testing::HasSubstr("no training poses"));
  EXPECT_THAT(message<std::invalid_argument>(fit(L, poses(d + 3, 4))), testing::HasSubstr("Q.rows()"));
  EXPECT_THAT(message<std::invalid_argument>(fit(Matrix::Identity(d - 1, d - 1), poses(d, 4))),
              testing::HasSubstr("metric"));
}

}  // namespace
}  // namespace supple::test
