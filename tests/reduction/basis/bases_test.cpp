#include <numerics/linear/tall_qr.hpp>
#include <physics/model/spring_model.hpp>
#include <reduction/basis/affine_basis.hpp>
#include <reduction/basis/joined_basis.hpp>
#include <reduction/basis/pca_basis.hpp>
#include <reduction/basis/skinning_modes.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <testing/subspace_builder_conformance.hpp>
#include <tests/support/bars.hpp>
#include <tests/support/outside.hpp>
#include <tests/support/plates.hpp>

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <numbers>

namespace supple::test {

/// Random displacements of all nodes, zero at fixed ones.
template <typename System>
Matrix random_snapshots(const System& system, Index rank, Index count) {
  const RestState rest = system.rest_state();
  return rest.expand(random_matrix(system.dim(), rank, 0.1, 8)) * random_matrix(rank, count, 1, 9);
}

template <auto system>
struct PcaCase {
  static auto make() { return system(); }
  static PcaBasis builder() { return {.snapshots = random_snapshots(make(), 7, 20), .dimension = 5}; }
};
using PcaCases = testing::Types<PcaCase<clamped_bar>, PcaCase<free_bar>, PcaCase<free_bars>, PcaCase<held_plate>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Pca, SubspaceBuilderConformance, PcaCases);

template <auto system, Index num_weights>
struct SkinningCase {
  static auto make() { return system(); }
  static SkinningModes builder() { return {.num_weights = num_weights}; }
};
using SkinningCases =
    testing::Types<SkinningCase<clamped_bar, 4>, SkinningCase<free_bar, 4>, SkinningCase<free_bars, 5>,
                   SkinningCase<clamped_and_free_bars, 3>, SkinningCase<held_plate, 3>, SkinningCase<free_plate, 3>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Skinning, SubspaceBuilderConformance, SkinningCases);

template <auto system>
struct AffineCase {
  static auto make() { return system(); }
  static AffineBasis builder() { return {}; }
};
using AffineCases = testing::Types<AffineCase<free_bar>, AffineCase<free_bars>, AffineCase<clamped_and_free_bars>,
                                   AffineCase<free_plate>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Affine, SubspaceBuilderConformance, AffineCases);

template <auto system, Index num_modes>
struct JoinedCase {
  static auto make() { return system(); }
  static auto builder() {
    return JoinedBasis{SkinningModes{.num_weights = 3}, ExtendedModalBasis{.num_modes = num_modes}};
  }
};
template <auto system, Index num_modes>
struct JoinedDenseCase {
  static auto make() { return system(); }
  static auto builder() { return JoinedBasis{ModalBasis{.num_modes = num_modes}, SkinningModes{.num_weights = 3}}; }
};
using JoinedCases = testing::Types<JoinedCase<clamped_bar, 4>, JoinedCase<free_bar, 9>, JoinedCase<free_bars, 15>,
                                   JoinedCase<held_plate, 4>, JoinedDenseCase<clamped_bar, 5>,
                                   JoinedDenseCase<free_bar, 9>, JoinedDenseCase<free_plate, 9>>;
INSTANTIATE_TYPED_TEST_SUITE_P(Joined, SubspaceBuilderConformance, JoinedCases);

namespace {

template <typename Call>
std::string message(const Call& call) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no exception";
}

/// Σ_t ‖u_t − U Uᵀ M u_t‖²_M.
double squared_error(const DenseBasis& basis, const StvkBar& system, const Matrix& snapshots) {
  const Vector mass = system.rest_state().mass_of_rows();
  const Matrix U = basis.dense();
  const Matrix rest = snapshots - U * (U.transpose() * (mass.asDiagonal() * snapshots));
  return (mass.cwiseSqrt().asDiagonal() * rest).squaredNorm();
}

TEST(PcaBasis, ReproducesSnapshotsOfLowRank) {
  const StvkBar system = clamped_bar();
  const Matrix snapshots = random_snapshots(system, 6, 30);
  const DenseBasis basis = PcaBasis{.snapshots = snapshots}(system);
  EXPECT_EQ(basis.dim(), 6);
  EXPECT_EQ(basis.report.dropped, 24);
  EXPECT_LT(outside(basis, system, snapshots), 1e-10);
  // components a hundred million times smaller than others keep their digits
  Matrix graded = snapshots.leftCols(6);
  for (Index j = 0; j < 6; ++j) graded.col(j) *= std::pow(100.0, -j);
  const DenseBasis all = PcaBasis{.snapshots = graded}(system);
  EXPECT_EQ(all.dim(), 6);
  EXPECT_LT(outside(all, system, Matrix(graded.leftCols(4))), 1e-8);
}

TEST(PcaBasis, LeavesOutExactlyTheDiscardedSingularValues) {
  const StvkBar system = clamped_bar();
  const Matrix snapshots = random_snapshots(system, 12, 12);
  const Vector sigma = PcaBasis{.snapshots = snapshots}(system).report.singular_values;
  ASSERT_EQ(sigma.size(), 12);
  const double total = sigma.squaredNorm();
  for (const Index d : {1, 4, 11}) {
    const DenseBasis basis = PcaBasis{.snapshots = snapshots, .dimension = d}(system);
    ASSERT_EQ(basis.dim(), d);
    EXPECT_NEAR(squared_error(basis, system, snapshots), sigma.tail(12 - d).squaredNorm(), 1e-12 * total);
    const double share = sigma.head(d).squaredNorm() / total;
    EXPECT_EQ((PcaBasis{.snapshots = snapshots, .energy = share - 1e-9}(system).dim()), d);
    EXPECT_EQ((PcaBasis{.snapshots = snapshots, .energy = share + 1e-9}(system).dim()), d + 1);
    // no other subspace of this dimension does better
    const DenseBasis other = PcaBasis{.snapshots = snapshots.leftCols(d)}(system);
    EXPECT_GT(squared_error(other, system, snapshots), sigma.tail(12 - d).squaredNorm());
  }
}

/// The largest distance of a snapshot from the span, over the largest snapshot, in the mass norm.
double distance(const DenseBasis& basis, const StvkBar& system, const Matrix& snapshots) {
  const Vector mass = system.rest_state().mass_of_rows(), root = mass.cwiseSqrt();
  const Matrix U = basis.dense();
  const Matrix rest = snapshots - U * (U.transpose() * (mass.asDiagonal() * snapshots));
  return (root.asDiagonal() * rest).colwise().norm().maxCoeff() /
         (root.asDiagonal() * snapshots).colwise().norm().maxCoeff();
}

/// UᵀMU = I to 1e-10, every snapshot in the span up to `tolerance` of the largest, and what was dropped counted.
void expect_spans(const DenseBasis& basis, const StvkBar& system, const Matrix& snapshots, double tolerance) {
  const Vector mass = system.rest_state().mass_of_rows();
  const Matrix U = basis.dense();
  EXPECT_TRUE(is_near(U.transpose() * mass.asDiagonal() * U, Matrix::Identity(U.cols(), U.cols()), 1e-10));
  EXPECT_LE(distance(basis, system, snapshots), tolerance);
  EXPECT_EQ(basis.report.dropped, snapshots.cols() - basis.dim());
}

TEST(PcaBasis, BearsSnapshotsThatHardlyDiffer) {
  const StvkBar system = clamped_bar();
  const Matrix all = random_snapshots(system, 10, 10), one = all.leftCols(1), others = all.rightCols(9);
  for (const double difference : {1e-2, 1e-6, 1e-10, 1e-14, 0.0}) {
    SCOPED_TRACE(difference);
    Matrix snapshots = one.replicate(1, 10);
    snapshots.rightCols(9) += difference * (one.norm() / others.norm()) * others;
    const DenseBasis basis = PcaBasis{.snapshots = snapshots}(system);
    expect_spans(basis, system, snapshots, 1e-11);
    if (difference >= 1e-10) {
      EXPECT_EQ(basis.dim(), 10);
      EXPECT_LE(distance(basis, system, Matrix(snapshots.rightCols(9).colwise() - snapshots.col(0))),
                1e-13 / difference);
    }
    if (difference <= 1e-14) {
      EXPECT_EQ(basis.dim(), 1);
    }
    EXPECT_TRUE(basis.report.notes.empty());
  }
}

TEST(PcaBasis, BearsCopiesAndZeros) {
  const StvkBar system = clamped_bar();
  const Matrix some = random_snapshots(system, 3, 3);
  Matrix snapshots = Matrix::Zero(some.rows(), 20);
  for (const Index t : {0, 2, 3, 4, 9, 12, 13, 19}) snapshots.col(t) = some.col(t % 3);
  const DenseBasis basis = PcaBasis{.snapshots = snapshots}(system);
  EXPECT_EQ(basis.dim(), 3);
  expect_spans(basis, system, snapshots, 1e-13);
  EXPECT_TRUE(basis.report.notes.empty());
}

TEST(PcaBasis, SaysWhichSnapshotsAreTooSmallBesideOthers) {
  const StvkBar system = clamped_bar();
  Matrix snapshots = random_snapshots(system, 8, 8);
  snapshots.col(6).setZero();
  for (const Index t : {1, 4}) snapshots.col(t) *= 1e-8;
  for (const Index t : {0, 2, 5}) snapshots.col(t) *= 1e8;
  const DenseBasis basis = PcaBasis{.snapshots = snapshots}(system);
  EXPECT_EQ(basis.dim(), 5);
  Matrix all_but_small = snapshots;
  all_but_small.col(1).setZero(), all_but_small.col(4).setZero();
  expect_spans(basis, system, all_but_small, 1e-14);
  EXPECT_THAT(basis.report.notes, testing::ElementsAre(testing::HasSubstr("2 of 8 snapshots are left out")));
}

TEST(PcaBasis, MindsNoUnits) {
  const StvkBar system = clamped_bar();
  const Matrix snapshots = random_snapshots(system, 6, 9);
  const DenseBasis plain = PcaBasis{.snapshots = snapshots, .energy = 0.8}(system);
  EXPECT_LT(plain.dim(), 6);
  for (const double unit : {1e-200, 1e-30, 1e30, 1e200}) {
    const DenseBasis basis = PcaBasis{.snapshots = unit * snapshots, .energy = 0.8}(system);
    ASSERT_EQ(basis.dim(), plain.dim()) << unit;
    EXPECT_TRUE(is_near(basis.report.singular_values / unit, plain.report.singular_values, 1e-12));
    const Matrix overlap = basis.dense().transpose() * system.rest_state().mass_of_rows().asDiagonal() * plain.dense();
    EXPECT_TRUE(is_near(overlap.cwiseAbs(), Matrix::Identity(plain.dim(), plain.dim()), 1e-10)) << unit;
  }
}

TEST(PcaBasis, RefusesSnapshotsThatDoNotFit) {
  const StvkBar system = clamped_bar();
  const Matrix good = random_snapshots(system, 3, 4);
  const auto refusal = [&](const PcaBasis& build) { return message([&] { (void)build(system); }); };
  EXPECT_THAT(refusal({.snapshots = good.topRows(9)}), testing::HasSubstr("snapshots.rows()"));
  EXPECT_THAT(refusal({.snapshots = Matrix(good.rows(), 0)}), testing::HasSubstr("no snapshots"));
  EXPECT_THAT(refusal({.snapshots = Matrix::Zero(good.rows(), 2)}), testing::HasSubstr("zero"));
  Matrix bad = good;
  bad(5, 1) = std::nan("");
  EXPECT_THAT(refusal({.snapshots = bad}), testing::HasSubstr("not finite"));
  bad = good;
  const Index fixed = system.numbering().fixed_nodes()[2];
  bad(3 * fixed + 1, 3) = 1e-3;
  EXPECT_THAT(refusal({.snapshots = bad}), testing::HasSubstr("node " + std::to_string(fixed) + ", which is fixed"));
  EXPECT_THAT(refusal({.snapshots = good, .dimension = -1}), testing::HasSubstr("dimension"));
  for (const double share : {0.0, 1.5, std::nan("")})
    EXPECT_THAT(refusal({.snapshots = good, .energy = share}), testing::HasSubstr("share"));
}

TEST(SkinningModes, HaveAscendingEnergies) {
  for (const StvkBar& system : {clamped_bar(), free_bar(), free_bars()}) {
    const RestState rest = system.rest_state();
    const Index num_free =
        static_cast<Index>(find_free_components(rest.stencils, rest.stencil_size, rest.numbering).free.size());
    const SkinningWeights weights = SkinningModes{.num_weights = 8}.weights(rest);
    const Matrix gram = weights.W.transpose() * rest.nodal_mass.asDiagonal() * weights.W;
    EXPECT_TRUE(is_near(gram, Matrix::Identity(8, 8), 1e-12));
    for (Index k = 0; k < 8; ++k) {
      if (k < num_free)
        EXPECT_EQ(weights.lambda[k], 0);
      else
        EXPECT_GT(weights.lambda[k], 1e-3);
      if (k > 0) {
        EXPECT_GE(weights.lambda[k], weights.lambda[k - 1] * (1 - 1e-9));
      }
      // the energies of w along each axis add up to λ
      double energy = 0;
      for (int x = 0; x < 3; ++x) {
        Vector u = Vector::Zero(3 * system.num_nodes());
        u(Eigen::seqN(x, system.num_nodes(), 3)) = weights.W.col(k);
        const Vector free = system.restrict(u);
        energy += free.dot(rest.K * free);
      }
      EXPECT_NEAR(energy, weights.lambda[k], 1e-8 * weights.lambda[7]);
    }
  }
}

TEST(SkinningModes, HaveTwelveDimensionsAWeightAndAreNested) {
  for (const StvkBar& system : {clamped_bar(), free_bar(), clamped_and_free_bars()}) {
    const NodalBasis few = SkinningModes{.num_weights = 3}(system), more = SkinningModes{.num_weights = 6}(system);
    EXPECT_EQ(few.dim(), 36);
    EXPECT_EQ(more.dim(), 72);
    EXPECT_LT(outside(more, system, few.dense()), 1e-6);
  }
  EXPECT_EQ(SkinningModes{.num_weights = 3}(free_plate()).dim(), 27) << "a flat object has no Z";
}

TEST(SkinningModes, OfFreeObjectsContainAllAffineMotions) {
  for (const StvkBar& system : {free_bar(), free_bars()}) {
    const NodalBasis basis = SkinningModes{.num_weights = 2}(system);
    for (std::uint64_t seed : {1, 2, 3})
      EXPECT_LT(outside(basis, system,
                        affine_displacement(system.model().rest_positions(), random_matrix(3, 3, 2, seed), {1, 2, 3})),
                1e-12);
    EXPECT_LT(outside(basis, system, AffineBasis{}(system).dense()), 1e-12) << "of each part";
  }
}

TEST(SkinningModes, SayWhichNumbersOfWeightsAreImpossible) {
  EXPECT_THAT(message([] { (void)SkinningModes{.num_weights = 1}(free_bars()); }), testing::HasSubstr("at least 2"));
  EXPECT_THAT(message([] { (void)SkinningModes{.num_weights = 0}(clamped_bar()); }), testing::HasSubstr("at least 1"));
  EXPECT_THAT(message([] { (void)SkinningModes{.num_weights = 1000}(clamped_bar()); }),
              testing::HasSubstr("number of weights is 1000"));
}

TEST(AffineBasis, SpansTwelveMotionsOfEachFreePart) {
  EXPECT_EQ(AffineBasis{}(free_bar()).dim(), 12);
  EXPECT_EQ(AffineBasis{}(free_bars()).dim(), 24);
  EXPECT_EQ(AffineBasis{}(clamped_and_free_bars()).dim(), 12);
  EXPECT_EQ(AffineBasis{}(free_plate()).dim(), 9);
  EXPECT_THAT(message([] { (void)AffineBasis{}(clamped_bar()); }), testing::HasSubstr("held"));
}

TEST(JoinedBasis, ContainsBoth) {
  const StvkBar system = free_bar();
  const auto check = [&](const auto& first, const auto& second, Index dependent) {
    const auto joined = JoinedBasis{first, second}(system);
    const auto a = first(system);
    const auto b = second(system);
    EXPECT_EQ(joined.dim(), a.dim() + b.dim() - dependent);
    EXPECT_EQ(joined.report.dropped, a.report.dropped + b.report.dropped + dependent);
    EXPECT_LT(outside(joined, system, a.dense()), 1e-10);
    EXPECT_LT(outside(joined, system, b.dense()), 1e-10);
    EXPECT_TRUE(is_near(joined.dense().leftCols(a.dim()), a.dense(), 1e-11 * a.dense().cwiseAbs().maxCoeff()));
    return joined;
  };
  const SkinningModes skinning{.num_weights = 3};
  const ModalBasis modal{.num_modes = 9};
  const NodalBasis nodal = check(skinning, ExtendedModalBasis{.num_modes = 8}, 12);  // affine motions in both
  EXPECT_EQ(nodal.report.omega.size(), 8);
  EXPECT_EQ(nodal.report.rigid_modes, 6);
  const DenseBasis dense = check(modal, AffineBasis{}, 6);  // rigid ones in both
  EXPECT_EQ(dense.dim(), 15);
  check(modal, modal, 9);
  check(modal, ModalBasis{.num_modes = 11}, 9);
  check(PcaBasis{.snapshots = random_snapshots(system, 3, 3)}, skinning, 0);
  check(AffineBasis{}, JoinedBasis{modal, skinning}, 12);
}

TEST(JoinedBasis, OfPartsThatNearlyCoincideIsOrthonormal) {
  const StvkBar system = clamped_bar();
  const Vector mass = system.rest_state().mass_of_rows();
  const DenseBasis first = PcaBasis{.snapshots = random_snapshots(system, 6, 6)}(system);
  const Matrix away = random_snapshots(system, 12, 6);
  for (const double difference : {1e-1, 1e-4, 1e-8, 1e-12, 0.0}) {
    const Matrix moved = first.dense() + difference * away / away.norm() * first.dense().norm();
    const DenseBasis second = PcaBasis{.snapshots = moved}(system);
    const auto joined = join(first, second, system.rest_state().nodal_mass);
    const Matrix U = joined.dense();
    EXPECT_EQ(joined.dim(), difference >= 1e-4 ? 12 : 6) << difference;
    EXPECT_EQ(joined.report.dropped, 12 - joined.dim());
    EXPECT_TRUE(is_near(U.transpose() * mass.asDiagonal() * U, Matrix::Identity(U.cols(), U.cols()), 1e-10));
    EXPECT_LT(outside(joined, system, first.dense()), 1e-10);
    EXPECT_LT(outside(joined, system, second.dense()), 1e-5);
  }
}

TEST(NamedSubspaces, OfPartsThatCoincideHaveTheDimensionsOfOne) {
  for (const StvkBar& system : {clamped_bar(), free_bar()}) {
    const RestState rest = system.rest_state();
    const Vector mass = rest.mass_of_rows();
    SubspaceChoice choice;
    choice.modes = 9;
    const auto built = [&](const std::string& name) {
      choice.name = name;
      return build_subspace(rest, choice, {});
    };
    const auto dense = [](const AnyBasis& basis) {
      return std::visit([](const auto& some) { return Matrix(some->dense()); }, basis);
    };
    choice.snapshots = dense(built("extended")).leftCols(7) * random_matrix(7, 12, 1, 4);
    for (const auto& [whole, sum] : {std::pair<std::string, std::string>{"extended", "extended+pca"},
                                     {"extended", "modal+extended"},
                                     {"derivatives", "derivatives+modal"}}) {
      SCOPED_TRACE(sum);
      const Matrix expected = dense(built(whole)), U = dense(built(sum));
      EXPECT_EQ(U.cols(), expected.cols());
      EXPECT_TRUE(is_near(U.transpose() * mass.asDiagonal() * U, Matrix::Identity(U.cols(), U.cols()), 1e-10));
      const Matrix overlap = U.transpose() * mass.asDiagonal() * expected;
      EXPECT_TRUE(is_near(overlap.transpose() * overlap, Matrix::Identity(expected.cols(), expected.cols()), 1e-6));
    }
  }
}

TEST(ExtendedModalBasis, OfFreeNodesOnALineLosesNoMode) {
  // A straight chain of springs: turning about its line moves nothing, and leaving the line costs nothing.
  constexpr Index count = 12;
  Points nodes = Points::Zero(count, 3);
  std::vector<std::array<Index, 2>> springs;
  for (Index v = 0; v < count; ++v) {
    nodes(v, 0) = 0.1 * static_cast<double>(v);
    if (v > 0) springs.push_back({v - 1, v});
  }
  const FullSystem system(SpringModel(nodes, springs, 100.0), Vector::Constant(count, 0.01));
  const Index free = 3 * count - (count - 1);  // motions without energy: all but those along the line
  const VibrationModes modes = vibration_modes(system.rest_state(), {.num_modes = free + 3});
  EXPECT_EQ(modes.num_rigid, 5);
  EXPECT_EQ(modes.num_zero, free);
  ASSERT_EQ(modes.omega.size(), free + 3);
  for (Index k = 0; k < 3; ++k)  // free ends: 2 sqrt(k / m) sin(j π / 2 n)
    EXPECT_NEAR(modes.omega[free + k], 200 * std::sin(static_cast<double>(k + 1) * std::numbers::pi / (2.0 * count)),
                1e-6);
  const NodalBasis basis = extend_modes(modes, nodes, Vector::Constant(count, 0.01));
  const Matrix U = basis.dense();
  EXPECT_TRUE(is_near(0.01 * U.transpose() * U, Matrix::Identity(U.cols(), U.cols()), 1e-10));
  EXPECT_LT((modes.vectors - 0.01 * U * (U.transpose() * modes.vectors)).norm(), 1e-5);
}

TEST(TallQr, FactorizesAnyShape) {
  for (const auto& [rows, cols] :
       {std::pair<Index, Index>{9000, 7}, {5000, 1500}, {5, 9}, {9, 9}, {30, 1}, {4096, 2}}) {
    Matrix A = random_matrix(rows, cols, 1, 3);
    if (cols > 3) A.col(3) = A.col(0) + 1e-13 * A.col(1);
    const ThinQr qr = tall_qr(A);
    const Index k = std::min(rows, cols);
    ASSERT_EQ(qr.Q.cols(), k);
    ASSERT_EQ(qr.R.rows(), k);
    EXPECT_TRUE(is_near(qr.Q.transpose() * qr.Q, Matrix::Identity(k, k), 1e-13));
    EXPECT_TRUE(is_near(qr.Q * qr.R, A, 1e-12 * A.norm()));
    EXPECT_TRUE(is_same(qr.R, Matrix(qr.R.triangularView<Eigen::Upper>())));
    set_num_threads(1);
    EXPECT_TRUE(is_same(tall_qr(A).Q, qr.Q));
    set_num_threads(0);
  }
}

}  // namespace
}  // namespace supple::test
