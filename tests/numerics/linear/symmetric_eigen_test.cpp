#include <core/check.hpp>
#include <core/random.hpp>
#include <numerics/linear/symmetric_eigen.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace supple::test {
namespace {

TEST(SymmetricEigen, DiagonalisesTheMatrix) {
  Random random(5);
  const Matrix X = Matrix::NullaryExpr(12, 12, [&] { return random.normal(); });
  const Matrix A = X + X.transpose();
  const SymmetricEigen eigen = symmetric_eigen(A);
  EXPECT_LT((A * eigen.vectors - eigen.vectors * eigen.values.asDiagonal()).norm(), 1e-13 * A.norm());
  EXPECT_LT((eigen.vectors.transpose() * eigen.vectors - Matrix::Identity(12, 12)).norm(), 1e-13);
  EXPECT_LT((symmetric_eigenvalues(A) - eigen.values).norm(), 1e-13 * A.norm());
}

// Second differences on n points have the eigenvalues 2 − 2 cos(k π / (n + 1)).
TEST(SymmetricEigen, HasTheEigenvaluesOfSecondDifferencesInOrder) {
  const Index n = 9;
  Matrix A = Matrix::Zero(n, n);
  A.diagonal().setConstant(2);
  A.diagonal(-1).setConstant(-1);  // the lower triangle alone
  const Vector values = symmetric_eigenvalues(A);
  for (Index k = 0; k < n; ++k)
    EXPECT_NEAR(values[k], 2 - 2 * std::cos(static_cast<double>(k + 1) * std::numbers::pi / (n + 1)), 1e-14);
}

TEST(SymmetricEigen, RefusesWhatIsNotSquareAndWhatIsNotANumber) {
  EXPECT_THROW(symmetric_eigen(Matrix::Zero(2, 3)), std::invalid_argument);
  EXPECT_THROW(symmetric_eigenvalues(Matrix::Constant(3, 3, std::nan(""))), SolverError);
}

}  // namespace
}  // namespace supple::test
