#include <core/check.hpp>
#include <core/parallel.hpp>
#include <core/random.hpp>
#include <numerics/eigen/eigensolver.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <physics/mesh/mass.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/subspace/rigid_modes.hpp>
#include <tests/support/meshes.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <thread>
#include <vector>

namespace supple {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

SparseMatrix from_triplets(Index n, const Triplets& entries) {
  SparseMatrix A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Tridiagonal (−1, 2, −1): eigenvalues 4 sin²(k π / (2 n + 2)), k = 1 … n.
SparseMatrix laplacian(Index n) {
  Triplets entries;
  for (Index i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 2);
    if (i > 0) entries.emplace_back(i, i - 1, -1), entries.emplace_back(i - 1, i, -1);
  }
  return from_triplets(n, entries);
}

double laplacian_eigenvalue(Index n, Index k) {
  const double s = std::sin(static_cast<double>(k) * std::numbers::pi / static_cast<double>(2 * n + 2));
  return 4 * s * s;
}

/// A ⊗ I ⊗ I + I ⊗ A ⊗ I + I ⊗ I ⊗ A for the one-dimensional Laplacian A.
SparseMatrix cube_laplacian(Index n) {
  const auto index = [n](Index x, Index y, Index z) { return x + n * (y + n * z); };
  Triplets entries;
  for (Index z = 0; z < n; ++z)
    for (Index y = 0; y < n; ++y)
      for (Index x = 0; x < n; ++x) {
        const Index i = index(x, y, z);
        entries.emplace_back(i, i, 6);
        for (const Index j :
             {x > 0 ? index(x - 1, y, z) : -1, y > 0 ? index(x, y - 1, z) : -1, z > 0 ? index(x, y, z - 1) : -1})
          if (j >= 0) entries.emplace_back(i, j, -1), entries.emplace_back(j, i, -1);
      }
  return from_triplets(n * n * n, entries);
}

Vector cube_eigenvalues(Index n, Index count) {
  std::vector<double> all;
  for (Index i = 1; i <= n; ++i)
    for (Index j = 1; j <= n; ++j)
      for (Index k = 1; k <= n; ++k)
        all.push_back(laplacian_eigenvalue(n, i) + laplacian_eigenvalue(n, j) + laplacian_eigenvalue(n, k));
  std::sort(all.begin(), all.end());
  return Eigen::Map<Vector>(all.data(), count);
}

/// K repeated on the diagonal.
SparseMatrix copies(const SparseMatrix& K, Index count) {
  Triplets entries;
  for (Index c = 0; c < count; ++c)
    for (Index j = 0; j < K.cols(); ++j)
      for (SparseMatrix::InnerIterator entry(K, j); entry; ++entry)
        entries.emplace_back(c * K.rows() + entry.row(), c * K.rows() + j, entry.value());
  return from_triplets(count * K.rows(), entries);
}

/// Springs of stiffness 1 / length between nodes of a cubic lattice and their 26 neighbours: stiff in all
/// directions.
struct Lattice {
  Points nodes;
  SparseMatrix K;
  Matrix rigid;  // six columns
};

Lattice spring_lattice(const std::vector<Point>& nodes) {
  const Index n = static_cast<Index>(nodes.size());
  Lattice lattice{Points(n, 3), {}, Matrix::Zero(3 * n, 6)};
  Triplets entries;
  for (Index a = 0; a < n; ++a) {
    lattice.nodes.row(a) = nodes[a];
    const Point& x = nodes[a];
    lattice.rigid.middleRows<3>(3 * a).leftCols<3>().setIdentity();
    lattice.rigid.middleRows<3>(3 * a).rightCols<3>() << 0, x[2], -x[1], -x[2], 0, x[0], x[1], -x[0], 0;
    for (Index b = 0; b < a; ++b) {
      const Point edge = nodes[a] - nodes[b];
      if (edge.squaredNorm() > 3.01) continue;
      const Matrix3<double> k = edge * edge.transpose() / std::pow(edge.norm(), 3);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) {
          entries.emplace_back(3 * a + r, 3 * a + c, k(r, c));
          entries.emplace_back(3 * b + r, 3 * b + c, k(r, c));
          entries.emplace_back(3 * a + r, 3 * b + c, -k(r, c));
          entries.emplace_back(3 * b + r, 3 * a + c, -k(r, c));
        }
    }
  }
  lattice.K = from_triplets(3 * n, entries);
  return lattice;
}

std::vector<Point> block_of_points(Index nx, Index ny, Index nz) {
  std::vector<Point> nodes;
  for (Index x = 0; x < nx; ++x)
    for (Index y = 0; y < ny; ++y)
      for (Index z = 0; z < nz; ++z)
        nodes.emplace_back(static_cast<double>(x), static_cast<double>(y), static_cast<double>(z));
  return nodes;
}

Vector random_masses(Index n, std::uint64_t seed) {
  Random random(seed);
  return Vector::NullaryExpr(n, [&](Index) { return 0.5 + random.uniform(); });
}

/// What the docstring promises of every result.
void expect_eigenpairs(const SparseMatrix& K, const Vector& M, const Matrix& rigid, const EigenPairs& pairs,
                       double tolerance = 1e-8) {
  EXPECT_EQ(pairs.report.status, Status::Converged);
  const Matrix gram = pairs.vectors.transpose() * M.asDiagonal() * pairs.vectors;
  EXPECT_LE((gram - Matrix::Identity(gram.rows(), gram.cols())).norm(), 1e-12);
  if (rigid.cols() > 0) {
    EXPECT_LE((rigid.transpose() * M.asDiagonal() * pairs.vectors).norm(), 1e-11 * (M.asDiagonal() * rigid).norm());
  }
  for (Index j = 0; j < pairs.omega_squared.size(); ++j) {
    EXPECT_GE(pairs.omega_squared[j], pairs.omega_squared[std::max<Index>(j - 1, 0)]);
    const Vector phi = pairs.vectors.col(j);
    const Vector force = K * phi - pairs.omega_squared[j] * M.cwiseProduct(phi);
    const double norm = std::sqrt(force.dot(force.cwiseQuotient(M)));
    EXPECT_LE(norm, std::max(tolerance * (pairs.omega_squared[j] + pairs.shift), 1e-13 * K.coeffs().maxCoeff())) << j;
    EXPECT_LE(phi.cwiseAbs().maxCoeff(), (1 + 1e-6) * phi.maxCoeff()) << j;  // the largest entry is positive
  }
}

TEST(Eigensolver, FindsTheFrequenciesOfAChain) {
  for (const Index n : {6, 40, 1000}) {  // dense and sparse
    const SparseMatrix K = laplacian(n);
    const Vector M = Vector::Constant(n, 0.25);
    EigenOptions options;
    options.num_modes = std::min<Index>(n, 12);
    const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(n, 0), options);
    expect_eigenpairs(K, M, Matrix(n, 0), pairs);
    ASSERT_EQ(pairs.omega_squared.size(), options.num_modes);
    for (Index k = 0; k < options.num_modes; ++k) {
      const double expected = 4 * laplacian_eigenvalue(n, k + 1);
      // A Rayleigh quotient errs by rounding relative to the largest eigenvalue, 16.
      EXPECT_NEAR(pairs.omega_squared[k], expected, 1e-9 * expected + 1e-14) << "n = " << n << ", mode " << k;
    }
    EXPECT_EQ(pairs.missed, 0);
    EXPECT_EQ(pairs.extra_zero_modes, 0);
  }
}

TEST(Eigensolver, AgreesWithADenseSolverForUnequalMasses) {
  const SparseMatrix K = cube_laplacian(9);
  const Vector M = random_masses(K.rows(), 4);
  EigenOptions options;
  options.num_modes = 20;
  const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
  expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs);
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> dense{Matrix(K), Matrix(M.asDiagonal())};
  EXPECT_LE((pairs.omega_squared - dense.eigenvalues().head(20)).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_GT(pairs.shift, 0);
}

TEST(Eigensolver, FindsEveryCopyOfTheRepeatedFrequenciesOfACube) {
  const SparseMatrix K = cube_laplacian(11);
  const Vector M = Vector::Ones(K.rows());
  const Vector expected = cube_eigenvalues(11, 30);
  for (const Index block_size : {0, 1, 3})
    for (const Index num_modes : {4, 11, 30}) {
      EigenOptions options;
      options.num_modes = num_modes;
      options.block_size = block_size;
      const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
      expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs);
      ASSERT_EQ(pairs.omega_squared.size(), num_modes);
      EXPECT_LE((pairs.omega_squared - expected.head(num_modes)).cwiseAbs().maxCoeff(), 1e-10)
          << "block size " << block_size << ", found " << pairs.omega_squared.transpose() << ", missed "
          << pairs.missed;
    }
}

TEST(Eigensolver, FindsEveryCopyOfDisconnectedParts) {
  const SparseMatrix part = cube_laplacian(6);
  for (const Index count : {2, 7}) {
    const SparseMatrix K = copies(part, count);
    const Vector M = Vector::Ones(K.rows());
    EigenOptions options;
    options.num_modes = 4 * count + 1;
    options.block_size = 2;  // fewer than there are copies
    const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
    expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs);
    const Vector once = cube_eigenvalues(6, 5);
    for (Index k = 0; k < options.num_modes; ++k)
      EXPECT_NEAR(pairs.omega_squared[k], once[k / count], 1e-10) << count << " copies, mode " << k;
  }
}

TEST(Eigensolver, LooksForCopiesThatTheFirstSearchPassedOver) {
  const Index n = 400;
  const SparseMatrix K = copies(laplacian(n), 2);
  const Vector M = Vector::Ones(K.rows());
  EigenOptions options;
  options.num_modes = 4;
  options.block_size = 1;
  options.tolerance = 1e-2;  // a single vector stops long before rounding brings up the copies
  options.check_completeness = false;
  const EigenPairs hasty = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
  ASSERT_GT(hasty.omega_squared[1], 2 * laplacian_eigenvalue(n, 1));
  options.check_completeness = true;
  const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
  expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs, options.tolerance);
  EXPECT_EQ(pairs.missed, 2);
  for (Index k = 0; k < 4; ++k) {
    const double expected = laplacian_eigenvalue(n, 1 + k / 2);
    EXPECT_NEAR(pairs.omega_squared[k], expected, 1e-4 * expected) << k;  // the residual enters squared
  }
}

TEST(Eigensolver, LeavesRigidMotionsOutOfAFreeObject) {
  const Lattice free = spring_lattice(block_of_points(9, 5, 4));
  const Index n = free.K.rows();
  const Vector M = random_masses(n / 3, 2).replicate(1, 3).transpose().reshaped();
  EigenOptions options;
  options.num_modes = 9;
  const EigenPairs deflated = smallest_eigenpairs(free.K, M, free.rigid, options);
  expect_eigenpairs(free.K, M, free.rigid, deflated);
  EXPECT_EQ(deflated.extra_zero_modes, 0);
  EXPECT_GT(deflated.shift, 0);
  EXPECT_LE(deflated.rigid_residual, 1e-14);

  options.num_modes = 15;
  const EigenPairs all = smallest_eigenpairs(free.K, M, Matrix(n, 0), options);
  expect_eigenpairs(free.K, M, Matrix(n, 0), all);
  EXPECT_EQ(all.extra_zero_modes, 6);
  EXPECT_LE((all.omega_squared.tail(9) - deflated.omega_squared).cwiseAbs().maxCoeff(), 1e-10);

  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> dense{Matrix(free.K), Matrix(M.asDiagonal())};
  EXPECT_LE((deflated.omega_squared - dense.eigenvalues().segment(6, 9)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Eigensolver, DropsDependentRigidFields) {
  const Lattice free = spring_lattice(block_of_points(6, 5, 4));
  const Vector M = Vector::Ones(free.K.rows());
  Matrix redundant(free.K.rows(), 8);
  redundant << free.rigid, free.rigid.col(0) - 2 * free.rigid.col(4), Vector::Zero(free.K.rows());
  EigenOptions options;
  options.num_modes = 5;
  const Vector expected = smallest_eigenpairs(free.K, M, free.rigid, options).omega_squared;
  const EigenPairs pairs = smallest_eigenpairs(free.K, M, redundant, options);
  expect_eigenpairs(free.K, M, redundant, pairs);
  EXPECT_LE((pairs.omega_squared - expected).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Eigensolver, TakesASoftPartBesideAStiffOneForNoHinge) {
  const auto zero_modes = [](const std::vector<double>& eigenvalues) {
    const auto n = static_cast<Index>(eigenvalues.size());
    Random random(3);
    const Matrix Q =
        Eigen::HouseholderQR<Matrix>(Matrix::NullaryExpr(n, n, [&] { return random.normal(); })).householderQ();
    const Matrix K = Q * Eigen::Map<const Vector>(eigenvalues.data(), n).asDiagonal() * Q.transpose();
    const SparseMatrix symmetric = (0.5 * (K + K.transpose())).sparseView();
    return smallest_eigenpairs(symmetric, Vector::Ones(n), Matrix(n, 0), {.num_modes = 5, .progress = {}})
        .extra_zero_modes;
  };
  EXPECT_EQ(zero_modes({0.1, 0.12, 1.2, 4, 16, 200, 2e5, 2e9, 2e13}), 0);
  EXPECT_EQ(zero_modes({1e-5, 2e-5, 60, 200, 800, 1e4, 1e7, 1e9, 2e13}), 2);
}

// What rounding leaves of zero is measured where a mode moves: a soft part that no stiff one touches has digits of its own.
TEST(Eigensolver, MeasuresRoundingWhereAModeMoves) {
  SparseMatrix K(9, 9);
  const std::vector<double> stiffnesses{1e-3, 2e-3, 60, 200, 800, 1e4, 1e7, 1e11, 1e15};
  for (Index i = 0; i < 9; ++i) K.insert(i, i) = stiffnesses[i];
  const EigenPairs pairs = smallest_eigenpairs(K, Vector::Ones(9), Matrix(9, 0), {.num_modes = 5, .progress = {}});
  EXPECT_EQ(pairs.extra_zero_modes, 0);
  EXPECT_EQ(pairs.report.status, Status::Converged);
}

// A node of almost no mass at the end of a spring as stiff as that is light, which is what a flat tet makes: the modes are
// those without it, to what rounding of the spring does to the energy of the node it hangs on.
TEST(Eigensolver, KeepsTheDigitsOfSoftModesBesideNodesOfAlmostNoMass) {
  for (const Index side : {6, 9}) {  // few enough for a dense solver, and more
    const SparseMatrix cube = cube_laplacian(side);
    const Index n = cube.rows(), places = 3;
    const Vector expected = cube_eigenvalues(side, 8);
    for (const double flat : {1e-4, 1e-6, 1e-8, 1e-10}) {
      Triplets entries;
      for (Index j = 0; j < n; ++j)
        for (SparseMatrix::InnerIterator entry(cube, j); entry; ++entry)
          entries.emplace_back(entry.row(), j, entry.value());
      Vector M = Vector::Ones(n + places);
      for (Index k = 0; k < places; ++k) {
        const Index light = n + k, at = (20 + 50 * k) % n;
        M[light] = flat;
        entries.emplace_back(light, light, 1 / flat);
        entries.emplace_back(at, at, 1 / flat);
        entries.emplace_back(light, at, -1 / flat);
        entries.emplace_back(at, light, -1 / flat);
      }
      const EigenPairs pairs = smallest_eigenpairs(from_triplets(n + places, entries), M, Matrix(n + places, 0),
                                                   {.num_modes = 8, .progress = {}});
      EXPECT_EQ(pairs.report.status, Status::Converged) << side << ", " << flat;
      EXPECT_EQ(pairs.extra_zero_modes, 0) << side << ", " << flat;
      ASSERT_EQ(pairs.omega_squared.size(), 8);
      // the nodes' mass, and ε / flat of three of n nodes
      const double tolerance = 2 * flat + 4e-16 / flat + 1e-12;
      EXPECT_LE((pairs.omega_squared - expected).cwiseAbs().maxCoeff(), tolerance) << side << ", " << flat;
      const Matrix gram = pairs.vectors.transpose() * M.asDiagonal() * pairs.vectors;
      EXPECT_LE((gram - Matrix::Identity(8, 8)).cwiseAbs().maxCoeff(), 1e-10);
    }
  }
}

TEST(Eigensolver, KeepsTheDigitsOfASoftPartBesideAStiffOne) {
  for (const double contrast : {1e2, 1e4, 1e8, 1e12})
    for (const Index side : {5, 8}) {
      const SparseMatrix soft = cube_laplacian(side);
      const Index n = soft.rows();
      Triplets entries;
      for (Index j = 0; j < n; ++j)
        for (SparseMatrix::InnerIterator entry(soft, j); entry; ++entry) {
          entries.emplace_back(entry.row(), j, entry.value());
          entries.emplace_back(n + entry.row(), n + j, contrast * entry.value());
        }
      entries.emplace_back(0, n, -0.01);  // they touch
      entries.emplace_back(n, 0, -0.01);
      entries.emplace_back(0, 0, 0.01);
      entries.emplace_back(n, n, 0.01);
      const SparseMatrix K = from_triplets(2 * n, entries);
      const EigenPairs pairs =
          smallest_eigenpairs(K, Vector::Ones(2 * n), Matrix(2 * n, 0), {.num_modes = 6, .progress = {}});
      EXPECT_EQ(pairs.report.status, Status::Converged);
      Matrix held = soft;  // the other end hardly moves
      held(0, 0) += 0.01;
      const Vector expected = symmetric_eigenvalues(held).head(6);
      EXPECT_LE((pairs.omega_squared - expected).cwiseAbs().maxCoeff(), 1e-4 / contrast + 1e-12) << contrast;
    }
}

TEST(Eigensolver, CountsTheMotionsOfAHinge) {
  // Two blocks that share the nodes of one edge turn about it; two that share one node have three such
  // motions.
  const auto joined = [](Index shared) {
    std::vector<Point> nodes = block_of_points(5, 4, 4);
    const auto count = static_cast<Index>(nodes.size());
    for (const Point& node : block_of_points(5, 4, 4)) {
      const Point moved = node + Point(4, 3, shared == 4 ? 0 : 3);
      if (std::find(nodes.begin(), nodes.begin() + count, moved) == nodes.begin() + count) nodes.push_back(moved);
    }
    return nodes;
  };
  for (const auto& [shared, motions] : {std::pair<Index, Index>{4, 1}, {1, 3}}) {
    // Springs within each block only: nodes of different blocks may be near each other.
    const std::vector<Point> nodes = joined(shared);
    const std::vector<Point> one_block = block_of_points(5, 4, 4);
    const Lattice block = spring_lattice(one_block);
    const Index n = static_cast<Index>(nodes.size());
    ASSERT_EQ(n, 160 - shared);
    Triplets entries;
    Matrix rigid(3 * n, 6);
    for (int part = 0; part < 2; ++part) {
      std::vector<Index> node_of;
      for (const Point& node : one_block) {
        const Point moved = part == 0 ? node : Point(node + Point(4, 3, shared == 4 ? 0 : 3));
        node_of.push_back(std::find(nodes.begin(), nodes.end(), moved) - nodes.begin());
      }
      for (Index j = 0; j < block.K.cols(); ++j)
        for (SparseMatrix::InnerIterator entry(block.K, j); entry; ++entry)
          entries.emplace_back(3 * node_of[entry.row() / 3] + entry.row() % 3, 3 * node_of[j / 3] + j % 3,
                               entry.value());
    }
    const SparseMatrix K = from_triplets(3 * n, entries);
    rigid = spring_lattice(nodes).rigid;
    const Vector M = Vector::Ones(3 * n);
    EigenOptions options;
    options.num_modes = 10;
    const EigenPairs pairs = smallest_eigenpairs(K, M, rigid, options);
    expect_eigenpairs(K, M, rigid, pairs);
    EXPECT_EQ(pairs.extra_zero_modes, motions);
    EXPECT_LE((pairs.omega_squared - symmetric_eigenvalues(K).segment(6, 10)).cwiseAbs().maxCoeff(), 1e-10);
  }
}

TEST(Eigensolver, FindsMoreZeroEnergyMotionsThanAnyBlockHolds) {
  SparseMatrix chain = laplacian(40);
  chain.coeffRef(0, 0) = chain.coeffRef(39, 39) = 1;  // free ends: eigenvalues 4 sin²(k π / 80), k = 0 … 39
  const SparseMatrix K = copies(chain, 20);
  const Vector M = Vector::Ones(K.rows());
  EigenOptions options;
  options.num_modes = 25;
  const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
  expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs);
  EXPECT_EQ(pairs.extra_zero_modes, 20);
  const double first = 4 * std::pow(std::sin(std::numbers::pi / 80), 2);
  EXPECT_LE((pairs.omega_squared.tail(5).array() - first).abs().maxCoeff(), 1e-9);
}

TEST(Eigensolver, KeepsAccuracyFarBelowTheLargestEigenvalue) {
  // A chain of 3000 nodes: the lowest eigenvalue is 3e-7 of the largest.
  const Index n = 3000;
  const SparseMatrix K = laplacian(n) * 1e6;
  const Vector M = Vector::Constant(n, 1e-3);
  EigenOptions options;
  options.num_modes = 8;
  const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(n, 0), options);
  expect_eigenpairs(K, M, Matrix(n, 0), pairs);
  for (Index k = 0; k < 8; ++k) {
    const double expected = 1e9 * laplacian_eigenvalue(n, k + 1);
    EXPECT_NEAR(pairs.omega_squared[k], expected, 1e-8 * expected) << k;
  }
}

TEST(Eigensolver, SolvesSmallProblemsDensely) {
  const Lattice free = spring_lattice(block_of_points(2, 2, 2));  // 24 unknowns
  const Vector M = Vector::Ones(24);
  EigenOptions options;
  options.num_modes = 18;
  const EigenPairs pairs = smallest_eigenpairs(free.K, M, free.rigid, options);
  expect_eigenpairs(free.K, M, free.rigid, pairs);
  EXPECT_LE((pairs.omega_squared - symmetric_eigenvalues(free.K).tail(18)).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_EQ(pairs.shift, 0);
}

/// Number of eigenvalues of K φ = λ M φ below a bound, by Sylvester's law: negative ones of K − bound M.
Index count_below(const SparseMatrix& K, const Vector& M, double bound) {
  const Matrix shifted = Matrix(K) - bound * Matrix(M.asDiagonal());
  return (symmetric_eigenvalues(shifted).array() < 0).count();
}

// A bar of square section bends either way at one frequency; modes may be asked for up to the middle of a pair.
TEST(Eigensolver, FindsPairsOfASquareBarHoweverTheyAreCut) {
  const HexMesh mesh = hex_box(14, 3, 3, {1.4, 0.3, 0.3});
  const std::vector<Index> held = test::nodes_where(mesh, [](const Point& x) { return x[0] < 1e-9; });
  const FullSystem system(SolidElasticity<TrilinearHex, StVenantKirchhoff>(
                              mesh, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.3})),
                          lumped_mass<TrilinearHex>(mesh, 1000.0), held);
  const SparseMatrix& K = system.rest_stiffness();
  const Vector& M = system.mass();
  const Vector exact =
      Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(Matrix(K), Matrix(M.asDiagonal()), Eigen::EigenvaluesOnly)
          .eigenvalues();
  ASSERT_NEAR(exact[0], exact[1], 1e-9 * exact[0]) << "no pair";
  for (const Index block_size : {1, 4})
    for (Index num_modes = 1; num_modes <= 9; ++num_modes) {
      const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0),
                                                   {.num_modes = num_modes, .block_size = block_size, .progress = {}});
      expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs);
      ASSERT_EQ(pairs.omega_squared.size(), num_modes);
      for (Index k = 0; k < num_modes; ++k) EXPECT_NEAR(pairs.omega_squared[k], exact[k], 1e-8 * exact[k]) << num_modes;
      const double last = pairs.omega_squared[num_modes - 1];
      EXPECT_LT(count_below(K, M, (1 - 1e-6) * last), num_modes);
      EXPECT_GE(count_below(K, M, (1 + 1e-6) * last), num_modes);
    }
}

// k equal boxes apart from each other: 6 k motions without energy, and every frequency k times.
TEST(Eigensolver, FindsTheClustersOfManyFreeParts) {
  const TetMesh part = test::perturbed(test::kuhn_box(2, 2, 2, 0.1), 0.01, 5);
  constexpr Index count = 7;
  TetMesh mesh;
  mesh.nodes.resize(count * part.num_nodes(), 3);
  for (Index c = 0; c < count; ++c) {
    mesh.nodes.middleRows(c * part.num_nodes(), part.num_nodes()) =
        part.nodes.rowwise() + Eigen::RowVector3d(static_cast<double>(c), 0, 0);
    for (Tet tet : part.cells) {
      for (Index& v : tet) v += c * part.num_nodes();
      mesh.cells.push_back(tet);
    }
  }
  const auto system_of = [](const TetMesh& some) {
    return FullSystem(
        TetElasticity<StVenantKirchhoff>(some, StVenantKirchhoff<double>::from({.young = 1e5, .poisson = 0.3})),
        lumped_mass(some, 1000.0));
  };
  const auto one = system_of(part), all = system_of(mesh);
  const Vector once =
      Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(Matrix(one.rest_stiffness()), Matrix(one.mass().asDiagonal()))
          .eigenvalues()
          .tail(one.dim() - 6);
  const RestState rest = all.rest_state();
  const Matrix rigid =
      rigid_modes(rest.positions, find_free_components(rest.stencils, rest.stencil_size, rest.numbering));
  ASSERT_EQ(rigid.cols(), 6 * count);
  for (const Index num_modes : {count - 1, count + 3, 4 * count + 2}) {
    const EigenPairs pairs = smallest_eigenpairs(rest.K, rest.mass, rigid, {.num_modes = num_modes, .progress = {}});
    expect_eigenpairs(rest.K, rest.mass, rigid, pairs);
    EXPECT_EQ(pairs.extra_zero_modes, 0);
    ASSERT_EQ(pairs.omega_squared.size(), num_modes);
    for (Index k = 0; k < num_modes; ++k)
      EXPECT_NEAR(pairs.omega_squared[k], once[k / count], 1e-8 * once[k / count]) << k << " of " << num_modes;
  }
}

TEST(Eigensolver, GivesTheSameBitsForTheSameSeedAndAnyNumberOfThreads) {
  const Lattice free = spring_lattice(block_of_points(12, 9, 7));
  const Vector M = Vector::Ones(free.K.rows());
  EigenOptions options;
  options.num_modes = 10;
  options.seed = 77;
  set_num_threads(1);
  const EigenPairs first = smallest_eigenpairs(free.K, M, free.rigid, options);
  for (const int threads : {1, 2, 3}) {
    set_num_threads(threads);
    const EigenPairs again = smallest_eigenpairs(free.K, M, free.rigid, options);
    EXPECT_EQ(again.omega_squared, first.omega_squared) << threads << " threads";
    EXPECT_EQ(again.vectors, first.vectors) << threads << " threads";
  }
  set_num_threads(0);
  // Another seed starts elsewhere and arrives at the same modes.
  options.seed = 78;
  const EigenPairs other = smallest_eigenpairs(free.K, M, free.rigid, options);
  EXPECT_NE(other.vectors, first.vectors);
  EXPECT_LE((other.omega_squared - first.omega_squared).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(Eigensolver, RunsInSeveralThreadsAtOnce) {
  const SparseMatrix K = cube_laplacian(8);
  const Vector M = Vector::Ones(K.rows());
  std::vector<EigenPairs> results(3);
  {
    std::vector<std::jthread> callers;
    for (EigenPairs& pairs : results)
      callers.emplace_back([&] { pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0)); });
  }
  for (const EigenPairs& pairs : results) {
    expect_eigenpairs(K, M, Matrix(K.rows(), 0), pairs);
    EXPECT_EQ(pairs.vectors, results[0].vectors);
  }
}

TEST(Eigensolver, SaysWhenItDidNotConverge) {
  const SparseMatrix K = cube_laplacian(12);
  const Vector M = Vector::Ones(K.rows());
  EigenOptions options;
  options.num_modes = 40;
  options.block_size = 1;
  options.max_restarts = 0;
  options.tolerance = 1e-15;  // out of reach of the first Krylov space
  options.check_completeness = false;
  const EigenPairs pairs = smallest_eigenpairs(K, M, Matrix(K.rows(), 0), options);
  EXPECT_EQ(pairs.report.status, Status::MaxIterations);
  EXPECT_LT(pairs.omega_squared.size(), 40);
  EXPECT_EQ(pairs.vectors.cols(), pairs.omega_squared.size());
  EXPECT_EQ(pairs.residuals.size(), pairs.omega_squared.size());
}

TEST(Eigensolver, TellsItsProgress) {
  const SparseMatrix K = cube_laplacian(8);
  std::vector<double> shares;
  EigenOptions options;
  options.progress = [&](std::string_view, double share) { shares.push_back(share); };
  static_cast<void>(smallest_eigenpairs(K, Vector::Ones(K.rows()), Matrix(K.rows(), 0), options));
  ASSERT_GT(shares.size(), 3u);
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(shares.back(), 1);
}

TEST(Eigensolver, NamesTheCallersMistake) {
  const Index n = 500;
  const SparseMatrix K = laplacian(n);
  const Vector M = Vector::Ones(n);
  const Matrix none(n, 0);
  EigenOptions options;
  const auto expect_refusal = [&](const SparseMatrix& stiffness, const Vector& masses, const Matrix& rigid,
                                  const std::string& message) {
    try {
      static_cast<void>(smallest_eigenpairs(stiffness, masses, rigid, options));
      ADD_FAILURE() << "accepted: " << message;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  };
  expect_refusal(K, Vector::Ones(n - 1), none, "M_diagonal has size 499, expected 500");
  expect_refusal(K, M, Matrix::Ones(n - 1, 1), "rows of rigid has size 499, expected 500");
  expect_refusal(K, Vector::LinSpaced(n, -1, 1), none, "M_diagonal[0] is -1");
  expect_refusal(K, M, Matrix::Ones(n, 1), "K times rigid is not zero");
  SparseMatrix lopsided = K;
  lopsided.coeffRef(7, 8) = 5;
  expect_refusal(lopsided, M, none, "not symmetric");
  lopsided.coeffRef(7, 8) = std::nan("");
  expect_refusal(lopsided, M, none, "not finite");
  expect_refusal(0 * K, M, none, "K is zero");
  options.num_modes = n + 1;
  expect_refusal(K, M, none, "num_modes is 501, expected 1 … 500");
  options.num_modes = 0;
  expect_refusal(K, M, none, "num_modes is 0");
  options.num_modes = 5;
  options.tolerance = 0;
  expect_refusal(K, M, none, "tolerance");
  options = {};
  SparseMatrix indefinite = K;
  indefinite.coeffRef(250, 250) = -100;
  EXPECT_THROW(static_cast<void>(smallest_eigenpairs(indefinite, M, none, options)), SolverError);
}

TEST(Eigensolver, RefusesUnitsThatLeaveTheRangeOfNumbers) {
  const SparseMatrix K = laplacian(500);
  for (const double mass : {1e-308, 1e-200, 1e200}) try {
      static_cast<void>(smallest_eigenpairs(K, Vector::Constant(500, mass), Matrix(500, 0)));
      ADD_FAILURE() << "accepted: " << mass;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("units"), std::string::npos) << error.what();
    }
  for (const double mass : {1e-50, 1e50})
    EXPECT_NEAR(smallest_eigenpairs(K, Vector::Constant(500, mass), Matrix(500, 0)).omega_squared[0] * mass,
                smallest_eigenpairs(K, Vector::Ones(500), Matrix(500, 0)).omega_squared[0], 1e-10);
}

}  // namespace
}  // namespace supple
