#include <core/pack.hpp>
#include <core/random.hpp>
#include <core/single_pack.hpp>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace supple {
namespace {

using Lanes = std::array<double, Pack::size>;

Lanes lanes(const Pack& a) {
  alignas(64) Lanes result;
  a.store(result.data());
  return result;
}

Pack random_pack(Random& random, double low, double high) {
  Pack a;
  for (int k = 0; k < Pack::size; ++k) a.set(k, low + (high - low) * random.uniform());
  return a;
}

TEST(Pack, IsAsLargeAndAlignedAsEightDoubles) {
  EXPECT_EQ(sizeof(Pack), 64u);
  EXPECT_EQ(alignof(Pack), 64u);
}

TEST(Pack, LoadsAndStoresAlignedAndUnaligned) {
  alignas(64) std::array<double, 17> source, target{};
  for (std::size_t k = 0; k < source.size(); ++k) source[k] = static_cast<double>(k * k);
  Pack::load(source.data()).store(target.data());
  Pack::load_unaligned(source.data() + 9).store_unaligned(target.data() + 9);
  for (std::size_t k : {0u, 3u, 7u, 9u, 16u}) EXPECT_EQ(target[k], source[k]);
  EXPECT_EQ(target[8], 0);
}

TEST(Pack, NumbersFillEveryLaneExactly) {
  // −0, NaN and infinity included: value − 0 would be the wrong way to broadcast if it lost a bit of them.
  for (const double value : {3.5, -0.0, 0.0, std::numeric_limits<double>::infinity(), 5e-324}) {
    const Pack a = value;
    for (int k = 0; k < Pack::size; ++k) {
      EXPECT_EQ(a[k], value);
      EXPECT_EQ(std::signbit(a[k]), std::signbit(value));
    }
  }
  EXPECT_TRUE(std::isnan(Pack(std::numeric_limits<double>::quiet_NaN())[5]));
  EXPECT_EQ(Pack(7)[2], 7);
}

TEST(Pack, ArithmeticIsThatOfEachLane) {
  Random random(1);
  const Pack a = random_pack(random, -2, 2), b = random_pack(random, 0.5, 3);
  for (int k = 0; k < Pack::size; ++k) {
    EXPECT_EQ((a + b)[k], a[k] + b[k]);
    EXPECT_EQ((a - b)[k], a[k] - b[k]);
    EXPECT_EQ((a * b)[k], a[k] * b[k]);
    EXPECT_EQ((a / b)[k], a[k] / b[k]);
    EXPECT_EQ((2 * a - 1)[k], 2 * a[k] - 1);
    EXPECT_EQ((-a)[k], -a[k]);
  }
}

TEST(Pack, FunctionsAreThoseOfEachLane) {
  Random random(2);
  const Pack a = random_pack(random, 0.1, 0.9), b = random_pack(random, -1, 1);
  const Pack signs = b;
  for (int k = 0; k < Pack::size; ++k) {
    EXPECT_EQ(sqrt(a)[k], std::sqrt(a[k]));
    EXPECT_EQ(log(a)[k], std::log(a[k]));
    EXPECT_EQ(exp(a)[k], std::exp(a[k]));
    EXPECT_EQ(cbrt(b)[k], std::cbrt(b[k]));
    EXPECT_EQ(acos(b)[k], std::acos(b[k]));
    EXPECT_EQ(pow(a, 1.5)[k], std::pow(a[k], 1.5));
    EXPECT_EQ(abs(b)[k], std::abs(b[k]));
    EXPECT_EQ(min(a, b)[k], std::min(a[k], b[k]));
    EXPECT_EQ(max(a, b)[k], std::max(a[k], b[k]));
    EXPECT_EQ(where_positive(signs, a, b)[k], where_positive(signs[k], a[k], b[k]));
  }
  EXPECT_NEAR(
      a.sum(),
      [&] {
        double sum = 0;
        for (const double x : lanes(a)) sum += x;
        return sum;
      }(),
      1e-15 * 8);
}

TEST(Pack, AnglesAreThoseOfTheStandardLibraryToTheLastPlaces) {
  constexpr double tolerance = 3 * std::numeric_limits<double>::epsilon();  // 2.5 units, and one of std::atan2
  Random random(4);
  for (int k = 0; k < 20000; ++k) {
    const double scale = std::exp(60 * (random.uniform() - 0.5));
    const Pack y = random_pack(random, -1, 1), x = random_pack(random, -scale, scale), angle = atan2(y, x);
    for (int lane = 0; lane < Pack::size; ++lane) {
      const double expected = std::atan2(y[lane], x[lane]);
      ASSERT_NEAR(angle[lane], expected, tolerance * std::abs(expected)) << y[lane] << ", " << x[lane];
    }
  }
}

TEST(Pack, AnglesOfTheAxesTheDiagonalsAndTheOriginAreThoseOfTheStandardLibrary) {
  constexpr double denormal = std::numeric_limits<double>::denorm_min(),
                   infinity = std::numeric_limits<double>::infinity();
  for (const double y : {0.0, -0.0, 1.0, -1.0, denormal, -denormal, 1e300, -1e300, infinity})
    for (const double x : {0.0, -0.0, 1.0, -1.0, denormal, -denormal, 1e300, -1e300}) {
      const double angle = atan2(Pack(y), Pack(x))[6], expected = std::atan2(y, x);
      EXPECT_DOUBLE_EQ(angle, expected) << y << ", " << x;
      EXPECT_EQ(std::signbit(angle), std::signbit(expected)) << y << ", " << x;
    }
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(atan2(Pack(nan), Pack(1))[0]) && std::isnan(atan2(Pack(1), Pack(nan))[0]));
}

TEST(Pack, AnyPositiveLooksAtEveryLane) {
  EXPECT_FALSE(any_positive(Pack(0)) || any_positive(Pack(-1)));
  for (int k = 0; k < Pack::size; ++k) {
    Pack a = -1;
    a.set(k, 1e-300);
    EXPECT_TRUE(any_positive(a)) << k;
  }
}

TEST(Pack, WorksAsTheScalarOfEigenMatrices) {
  Random random(3);
  Matrix3<Pack> F;
  Vector3<Pack> x;
  for (int i = 0; i < 3; ++i) {
    x[i] = random_pack(random, -1, 1);
    for (int j = 0; j < 3; ++j) F(i, j) = random_pack(random, -1, 1);
  }
  const Vector3<Pack> y = F.transpose() * (F * x) + 0.5 * x;
  const Pack determinant = F.determinant();
  for (int k = 0; k < Pack::size; ++k) {
    const auto lane = [k](const Pack& a) { return a[k]; };
    const Matrix3<double> F_k = F.unaryExpr(lane);
    const Vector3<double> x_k = x.unaryExpr(lane), y_k = y.unaryExpr(lane);
    EXPECT_LT((y_k - (F_k.transpose() * (F_k * x_k) + 0.5 * x_k)).norm(), 1e-14);
    EXPECT_NEAR(determinant[k], F_k.determinant(), 1e-14);
  }
}

TEST(SinglePack, RoundsToSinglePrecisionOnce) {
  static_assert(sizeof(SinglePack) == 32 && alignof(SinglePack) == 32);
  Random random(3);
  const Pack a = random_pack(random, -2, 2);
  SinglePack rounded;
  for (int k = 0; k < Pack::size; ++k) rounded.set(k, a[k]);
  const Pack b = rounded;
  for (int k = 0; k < Pack::size; ++k) {
    EXPECT_EQ(b[k], static_cast<double>(static_cast<float>(a[k])));
    EXPECT_NEAR(b[k], a[k], 6e-8 * std::abs(a[k]));
  }
}

}  // namespace
}  // namespace supple
