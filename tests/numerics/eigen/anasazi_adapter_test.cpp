#include <numerics/eigen/anasazi_adapter.hpp>

#include <AnasaziBasicOutputManager.hpp>
#include <AnasaziMVOPTester.hpp>
#include <gtest/gtest.h>

namespace supple {
namespace {

/// Anasazi's own testers write what fails to standard output.
Teuchos::RCP<Anasazi::OutputManager<double>> loud() {
  return Teuchos::rcp(new Anasazi::BasicOutputManager<double>(Anasazi::Errors | Anasazi::Warnings));
}

Teuchos::RCP<Multivector> vectors(Index rows, Index cols) {
  return Teuchos::rcp(new Multivector(Matrix::Zero(rows, cols), std::make_shared<Random>(3)));
}

// More rows than one piece of a tall product, and not a multiple of it.
constexpr Index rows = 2 * tall::rows_in_piece + 37;

TEST(AnasaziAdapter, PassesAnasazisTestOfVectors) {
  const Teuchos::RCP<const Multivector> prototype = vectors(rows, 5);
  EXPECT_TRUE(Anasazi::TestMultiVecTraits(loud(), prototype));
}

TEST(AnasaziAdapter, PassesAnasazisTestOfOperators) {
  const Teuchos::RCP<const Multivector> prototype = vectors(rows, 5);
  const auto op = Teuchos::rcp(
      new BlockOperator{[](MatrixIn x, MatrixOut y) { y = Vector::LinSpaced(x.rows(), -1, 2).asDiagonal() * x; }});
  EXPECT_TRUE((Anasazi::TestOperatorTraits<double, Multivector, BlockOperator>(loud(), prototype, op)));
}

TEST(AnasaziAdapter, DrawsRandomVectorsFromItsSeed) {
  using Traits = Anasazi::MultiVecTraits<double, Multivector>;
  const auto first = vectors(100, 3), second = vectors(100, 3);
  Traits::MvRandom(*first);
  Traits::MvRandom(*second);
  EXPECT_EQ(first->copy(), second->copy());
  Traits::MvRandom(*second);  // the generator moves on
  EXPECT_NE(first->copy(), second->copy());
}

TEST(AnasaziAdapter, FormsTallProductsWithTheSameBitsForAnyNumberOfThreads) {
  const auto A = vectors(rows, 7), B = vectors(rows, 4);
  Anasazi::MultiVecTraits<double, Multivector>::MvRandom(*A);
  Anasazi::MultiVecTraits<double, Multivector>::MvRandom(*B);
  set_num_threads(1);
  const Matrix inner = tall::inner_products(A->matrix(), B->matrix());
  Matrix sum = B->copy();
  tall::add_product(-1, A->matrix(), inner, 1, sum);
  set_num_threads(3);
  Matrix sum_threads = B->copy();
  EXPECT_EQ(tall::inner_products(A->matrix(), B->matrix()), inner);
  tall::add_product(-1, A->matrix(), inner, 1, sum_threads);
  EXPECT_EQ(sum_threads, sum);
  set_num_threads(0);
  const Matrix expected = A->matrix().transpose() * B->matrix();
  EXPECT_LE((inner - expected).norm(), 1e-13 * expected.norm() * std::sqrt(static_cast<double>(rows)));
  EXPECT_LE((sum - (B->matrix() - A->matrix() * expected)).norm(), 1e-12 * sum.norm());
}

}  // namespace
}  // namespace supple
