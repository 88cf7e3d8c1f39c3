#include <sparse/nnls/nlopt_nnls.hpp>
#include <sparse/nnls/nnls.hpp>
#include <tests/sparse/nnls/reference_nnls.hpp>
#include <tests/sparse/problems.hpp>

#include <Eigen/QR>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

namespace supple {
namespace {

using test::gaussian;
using test::uniform;

struct Case {
  std::string name;
  Matrix A;
  Vector b;
};

Matrix orthonormal(Index rows, Index cols, std::uint64_t seed) {
  return Eigen::HouseholderQR<Matrix>(gaussian(rows, cols, seed)).householderQ() * Matrix::Identity(rows, cols);
}

Matrix conditioned(Index rows, Index cols, double condition, std::uint64_t seed) {
  const Vector sigma = Vector::NullaryExpr(
      cols, [&](Index i) { return std::pow(condition, -static_cast<double>(i) / static_cast<double>(cols - 1)); });
  return orthonormal(rows, cols, seed) * sigma.asDiagonal() * orthonormal(cols, cols, seed + 1).transpose();
}

std::vector<Case> cases() {
  std::vector<Case> all;
  const auto add = [&](std::string name, Matrix A, Vector b) {
    all.push_back({std::move(name), std::move(A), std::move(b)});
  };
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const std::string s = " " + std::to_string(seed);
    add("gaussian" + s, gaussian(20, 10, seed), gaussian(20, 1, 50 + seed));
    add("positive" + s, uniform(20, 10, seed), gaussian(20, 1, 50 + seed) + Vector::Ones(20));
    add("nearly parallel" + s, Matrix::Ones(20, 10) + 1e-6 * gaussian(20, 10, seed), uniform(20, 1, 60 + seed));
    add("wide" + s, gaussian(6, 12, seed), gaussian(6, 1, 70 + seed));
    const auto few_bits = [](double x) { return std::round(16 * x) / 16; };  // so that the product is exact
    add("rank 4 of 10" + s, gaussian(20, 4, seed).unaryExpr(few_bits) * gaussian(4, 10, 80 + seed).unaryExpr(few_bits),
        gaussian(20, 1, 90 + seed));
    Matrix A(20, 12);
    A << gaussian(20, 4, seed), gaussian(20, 4, seed), gaussian(20, 4, seed);
    add("copies" + s, A, gaussian(20, 1, 100 + seed));
    A.col(5).setZero();
    for (Index j = 0; j < 12; ++j) A.col(j) *= std::pow(10.0, 8 * (j % 3) - 8);
    add("copies of different scale, and a zero" + s, A, gaussian(20, 1, 100 + seed));
    Matrix opposite(20, 10);
    opposite << gaussian(20, 5, seed), -gaussian(20, 5, seed);
    add("opposite pairs" + s, opposite, gaussian(20, 1, 110 + seed));
    for (const double apart : {1e-4, 1e-9, 1e-13}) {
      Matrix near(20, 12);
      near << gaussian(20, 4, seed), gaussian(20, 4, seed) + apart * gaussian(20, 4, 170 + seed),
          gaussian(20, 4, seed) - apart * gaussian(20, 4, 180 + seed);
      add("copies that are hardly apart" + s, near, gaussian(20, 1, 190 + seed));
    }
    Matrix ranged = uniform(20, 10, seed);
    for (Index j = 0; j < 10; ++j) ranged.col(j) *= std::pow(10.0, j - 4);
    add("norms from 1e-4 to 1e5" + s, ranged, gaussian(20, 1, 200 + seed) + Vector::Ones(20));
    const Matrix D = uniform(20, 10, seed);
    add("b on the boundary of the cone" + s, D, D.leftCols(3).rowwise().sum());  // seven degenerate gradients
    add("condition 1e6" + s, conditioned(20, 10, 1e6, seed), gaussian(20, 1, 120 + seed));
    add("condition 1e10" + s, conditioned(20, 10, 1e10, seed), gaussian(20, 1, 130 + seed));
    const Matrix C = conditioned(20, 10, 1e8, seed);
    add("consistent, condition 1e8" + s, C, C * uniform(10, 1, 140 + seed));
    add("tiny" + s, 1e-100 * gaussian(12, 6, seed), 1e-100 * gaussian(12, 1, 150 + seed));
    add("one column" + s, gaussian(5, 1, seed), gaussian(5, 1, 160 + seed));
  }
  const Matrix hilbert =
      Matrix::NullaryExpr(12, 10, [](Index i, Index j) { return 1.0 / static_cast<double>(i + j + 1); });
  add("Hilbert", hilbert, hilbert * Vector::Ones(10));
  add("Hilbert, inconsistent", hilbert, gaussian(12, 1, 1));
  const Matrix vandermonde = Matrix::NullaryExpr(
      30, 12, [](Index i, Index j) { return std::pow(static_cast<double>(i) / 29, static_cast<double>(j)); });
  add("Vandermonde", vandermonde, vandermonde * Vector::Ones(12));
  add("Vandermonde, inconsistent", vandermonde, uniform(30, 1, 2));
  add("identity", Matrix::Identity(8, 8), gaussian(8, 1, 3));
  add("identity, ties", Matrix::Identity(8, 8), Vector::Ones(8));
  add("all columns equal", Matrix::Ones(9, 7), gaussian(9, 1, 4) + Vector::Ones(9));
  add("b orthogonal to all", (Matrix(4, 2) << 1, 1, 1, 2, 0, 0, 0, 0).finished(), Vector{{0, 0, 1, 1}});
  const Matrix Q = orthonormal(15, 7, 6);
  add("b orthogonal to all, to rounding", Q.leftCols(6) * uniform(6, 6, 7), Q.col(6));
  add("b opposite to all", uniform(15, 6, 5), -Vector::Ones(15));
  add("b zero", uniform(15, 6, 5), Vector::Zero(15));
  add("A zero", Matrix::Zero(15, 6), Vector::Ones(15));
  return all;
}

class NnlsMethods : public ::testing::TestWithParam<NnlsMethod> {};

TEST_P(NnlsMethods, AgreeWithBruteForceInExtendedPrecision) {
  for (const Case& c : cases()) {
    // What the normal equations cannot do is the reason for the others.
    if (GetParam() == NnlsMethod::NormalEquations &&
        (c.name.find("1e10") != std::string::npos || c.name.find("hardly") != std::string::npos))
      continue;
    const NnlsFit fit = Nnls{.method = GetParam()}(c.A, c.b);
    ASSERT_EQ(fit.w.size(), c.A.cols()) << c.name;
    EXPECT_TRUE((fit.w.array() >= 0).all()) << c.name;
    const double kkt = test::kkt_residual(c.A, c.b, fit.w);
    // Rounding the exact weights to double alone changes A w, and so g, by this share of b.
    const double rounding = c.b.norm() > 0 ? 2e-16 * c.A.colwise().norm().dot(fit.w) / c.b.norm() : 0;
    EXPECT_LE(kkt, 1e-10 + 4 * rounding) << c.name;
    EXPECT_NEAR(fit.report.residual, kkt, 1e-14 + 16 * rounding) << c.name;
    const auto least = static_cast<double>(test::brute_force_residual(c.A, c.b));
    // Normal equations lose digits: with cond(A) = 1e6 their error is up to 1e-16 · 1e12 of b.
    const double slack = GetParam() == NnlsMethod::NormalEquations ? 1e-6 : 1e-12;
    EXPECT_NEAR(fit.residual_norm, least, (slack + 16 * rounding) * c.b.norm()) << c.name;
    EXPECT_NEAR(fit.residual_norm, (c.b - c.A * fit.w).norm(), 1e-12 * c.b.norm()) << c.name;
  }
}

TEST_P(NnlsMethods, AgreeWithLawsonHansonInExtendedPrecision) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const Index rows = 60, cols = 25 + 5 * static_cast<Index>(seed);
    for (const Case& c : {Case{"positive", uniform(rows, cols, seed), gaussian(rows, 1, 9) + Vector::Ones(rows)},
                          Case{"gaussian", gaussian(rows, cols, seed), gaussian(rows, 1, 10)},
                          Case{"forces", test::force_fitting_on_a_cube(4, 5, cols, seed).matrix(),
                               test::force_fitting_on_a_cube(4, 5, cols, seed).rhs()}}) {
      const NnlsFit fit = Nnls{.method = GetParam()}(c.A, c.b);
      const Vector w = test::lawson_hanson(c.A, c.b).cast<double>();
      EXPECT_LE(test::kkt_residual(c.A, c.b, w), 1e-14) << "the reference itself, " << c.name;
      EXPECT_LE(test::kkt_residual(c.A, c.b, fit.w), 1e-10) << c.name;
      const double slack = GetParam() == NnlsMethod::NormalEquations ? 1e-6 : 1e-12;
      EXPECT_NEAR(fit.residual_norm, (c.b - c.A * w).norm(), slack * c.b.norm()) << c.name;
    }
  }
}

std::string method_name(const ::testing::TestParamInfo<NnlsMethod>& info) {
  const std::array<const char*, 4> names{"Automatic", "NormalEquations", "Qr", "LawsonHanson"};
  return names.at(static_cast<std::size_t>(info.param));
}

INSTANTIATE_TEST_SUITE_P(Every, NnlsMethods,
                         ::testing::Values(NnlsMethod::Automatic, NnlsMethod::NormalEquations, NnlsMethod::Qr,
                                           NnlsMethod::LawsonHanson),
                         method_name);

TEST(Nnls, LetsQrTakeOverWhereTheNormalEquationsLoseTheDigits) {
  const Matrix A = conditioned(300, 80, 3e8, 1);
  const Vector b = A * uniform(80, 1, 2);
  const double by_normal_equations = Nnls{.method = NnlsMethod::NormalEquations}(A, b).residual_norm / b.norm();
  const NnlsFit fit = Nnls{}(A, b);
  EXPECT_EQ(fit.method, NnlsMethod::Qr);
  EXPECT_LE(fit.residual_norm, 1e-13 * b.norm());
  EXPECT_GT(by_normal_equations, 10 * fit.residual_norm / b.norm());
}

TEST(Nnls, StaysWithTheNormalEquationsWhereTheyDo) {
  const NnlsFit fit = Nnls{}(uniform(5000, 40, 1), uniform(5000, 1, 2));
  EXPECT_EQ(fit.method, NnlsMethod::NormalEquations);
  EXPECT_EQ(fit.report.status, Status::Converged);
}

TEST(Nnls, ReducesManyRowsWithoutLoss) {
  const Matrix A = uniform(30000, 12, 1);
  const Vector b = gaussian(30000, 1, 2) + A.rowwise().sum();
  const NnlsFit by_qr = Nnls{.method = NnlsMethod::Qr}(A, b), fit = Nnls{}(A, b);
  EXPECT_TRUE(by_qr.w.isApprox(fit.w, 1e-11));
}

TEST(Nnls, LetsQrTakeOverWhereTheNormalEquationsTakeColumnsForCombinations) {
  // Columns that are combinations of four up to 1e-9, and a residual that they still explain.
  const Matrix A = gaussian(23, 4, 69) * gaussian(4, 10, 70) + 1e-9 * gaussian(23, 10, 71);
  const Vector b = A * uniform(10, 1, 75) + 1e-6 * A.norm() * gaussian(23, 1, 77);
  const NnlsFit fit = Nnls{}(A, b), reference = Nnls{.method = NnlsMethod::LawsonHanson}(A, b);
  EXPECT_GT((Nnls{.method = NnlsMethod::NormalEquations}(A, b).residual_norm), 1.2 * reference.residual_norm);
  EXPECT_LE(fit.residual_norm, reference.residual_norm * (1 + 1e-6));
}

TEST_P(NnlsMethods, DoNotDependOnUnits) {
  const Matrix A = gaussian(60, 40, 3);
  const Vector b = gaussian(60, 1, 4);
  const NnlsFit plain = Nnls{.method = GetParam()}(A, b);
  ASSERT_EQ(plain.report.status, Status::Converged);
  const auto unit = [](int exponent) { return std::ldexp(1.0, exponent); };  // so that not a bit may differ
  for (const auto& [of_A, of_b] :
       {std::pair{560, 560}, {-560, -560}, {0, -560}, {-300, 600}, {1000, 1000}, {-900, 0}}) {
    const NnlsFit fit = Nnls{.method = GetParam()}(unit(of_A) * A, unit(of_b) * b);
    EXPECT_EQ(fit.report.status, Status::Converged) << of_A << ", " << of_b;
    EXPECT_EQ(fit.passive, plain.passive);
    for (Index j = 0; j < 40; ++j) EXPECT_EQ(fit.w[j], std::ldexp(plain.w[j], of_b - of_A));
    EXPECT_EQ(fit.residual_norm, std::ldexp(plain.residual_norm, of_b));
    EXPECT_EQ(fit.report.residual, plain.report.residual);
  }
  Matrix tiny = A;
  tiny.col(7) *= 1e-310;  // not normal numbers any more
  const NnlsFit fit = Nnls{.method = GetParam()}(tiny, b);
  EXPECT_TRUE(fit.report.status == Status::NotFinite || fit.w.allFinite());
}

TEST(Nnls, RefusesWeightsThatAreBeyondAllNumbers) {
  const Matrix A = gaussian(30, 10, 3);
  const Vector b = A * Vector::Ones(10) + gaussian(30, 1, 4);
  for (const auto& [of_A, of_b] : {std::pair{1e-200, 1e200}, {1e200, 1e-200}}) {
    const NnlsFit fit = Nnls{}(of_A * A, of_b * b);
    EXPECT_EQ(fit.report.status, Status::NotFinite);
    EXPECT_TRUE((fit.w.array() == 0).all());
    EXPECT_TRUE(fit.passive.empty());
    EXPECT_NEAR(fit.residual_norm, of_b * b.norm(), 1e-12 * of_b * b.norm());
    EXPECT_EQ((QuasiNewtonNnls{}(of_A * A, of_b * b).report.status), Status::NotFinite);
  }
}

TEST(Nnls, StartsFromAnyPassiveSet) {
  const Matrix A = uniform(60, 30, 6);
  const Vector b = gaussian(60, 1, 7) + Vector::Ones(60);
  const Vector w = Nnls{}(A, b).w;
  for (NnlsMethod method : {NnlsMethod::NormalEquations, NnlsMethod::Qr})
    for (std::uint64_t seed = 1; seed <= 10; ++seed)
      EXPECT_TRUE(Nnls{.method = method}(A, b, test::random_subset(30, static_cast<Index>(3 * seed), seed))
                      .w.isApprox(w, 1e-9));
}

TEST(Nnls, AnswersWithinItsLimitOfIterations) {
  const Matrix A = gaussian(60, 40, 6);
  const Vector b = gaussian(60, 1, 7);
  for (NnlsMethod method :
       {NnlsMethod::Automatic, NnlsMethod::NormalEquations, NnlsMethod::Qr, NnlsMethod::LawsonHanson}) {
    const NnlsFit fit = Nnls{.method = method, .max_iterations = 1}(A, b);
    EXPECT_EQ(fit.report.status, Status::MaxIterations);
    EXPECT_TRUE((fit.w.array() >= 0).all());
    EXPECT_LT(fit.residual_norm, b.norm());
  }
}

TEST(Nnls, SaysSoWhereNumbersAreNotFinite) {
  Matrix A = gaussian(6, 4, 1);
  Vector b = gaussian(6, 1, 2);
  b[3] = std::nan("");
  EXPECT_EQ(Nnls{}(A, b).report.status, Status::NotFinite);
  EXPECT_EQ(QuasiNewtonNnls{}(A, b).report.status, Status::NotFinite);
  b[3] = 0;
  A(2, 2) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Nnls{}(A, b).report.status, Status::NotFinite);
  EXPECT_THROW(Nnls{}(A, gaussian(5, 1, 2)), std::invalid_argument);
  EXPECT_THROW(Nnls{}(A, b, std::vector<Index>{4}), std::invalid_argument);
}

TEST(QuasiNewtonNnls, ComesCloseOnBenignProblems) {
  const Matrix A = gaussian(100, 20, 1);
  const Vector b = gaussian(100, 1, 2);
  const double best = Nnls{}(A, b).residual_norm;
  for (QuasiNewtonMethod method : {QuasiNewtonMethod::Lbfgs, QuasiNewtonMethod::VariableMetric,
                                   QuasiNewtonMethod::TruncatedNewton, QuasiNewtonMethod::Ccsa}) {
    const NnlsFit fit = QuasiNewtonNnls{.method = method}(A, b);
    EXPECT_NEAR(fit.residual_norm, best, 1e-6 * best) << static_cast<int>(method);
    EXPECT_NEAR(fit.report.residual, test::kkt_residual(A, b, fit.w), 1e-12);
  }
}

// The paper's finding: on the columns of a force fitting, projection-based solvers do not arrive.
TEST(QuasiNewtonNnls, IsDefeatedByTheStiffnessOfForceFittings) {
  const DenseProblem problem = test::force_fitting_on_a_cube(6, 20, 100, 1);
  const NnlsFit exact = Nnls{}(problem.matrix(), problem.rhs());
  const NnlsFit fit = QuasiNewtonNnls{.max_evaluations = 2000}(problem.matrix(), problem.rhs());
  EXPECT_LE(exact.report.residual, 1e-12);
  EXPECT_GT(fit.report.residual, 1e3 * exact.report.residual);
  EXPECT_GE(fit.residual_norm, exact.residual_norm * (1 - 1e-9));
}

}  // namespace
}  // namespace supple
