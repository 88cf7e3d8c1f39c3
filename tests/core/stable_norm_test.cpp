#include <core/stable_norm.hpp>

#include <gtest/gtest.h>

namespace supple {
namespace {

TEST(StableNorm, OfEntriesWhoseSquaresAreNoNumbersIsStillTheNorm) {
  for (const double unit : {1e-300, 1e-170, 1.0, 1e170, 1e300})
    EXPECT_NEAR(stable_norm(unit * Vector{{3, -4, 12}}) / unit, 13, 1e-12) << "unit " << unit;
}

TEST(StableNorm, AgreesWithThePlainNormForEveryLengthAndPlace) {
  const Vector x = Vector::LinSpaced(70, -1, 3).array().cube();
  for (Index begin = 0; begin < 9; ++begin)
    for (Index size = 1; begin + size <= x.size(); size += 7)
      EXPECT_NEAR(stable_norm(x.segment(begin, size)), x.segment(begin, size).norm(), 1e-14 * x.norm());
  EXPECT_EQ(stable_norm(Vector()), 0);
  EXPECT_EQ(stable_norm(Vector::Zero(5)), 0);
}

}  // namespace
}  // namespace supple
