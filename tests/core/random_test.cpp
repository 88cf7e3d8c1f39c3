#include <core/random.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <vector>

namespace supple {
namespace {

TEST(Random, SameSeedSameNumbersOtherSeedOthers) {
  Random a(5), b(5), c(6);
  bool different = false;
  for (int k = 0; k < 100; ++k) {
    const double value = a.uniform();
    EXPECT_EQ(value, b.uniform());
    different |= value != c.uniform();
  }
  EXPECT_TRUE(different);
}

TEST(Random, IsTheSameOnEveryPlatform) {
  // The standard fixes the 10 000th number of mt19937_64 with its default seed 5489: 9981545732273789042.
  Random random(5489);
  for (int k = 1; k < 10000; ++k) random.uniform();
  EXPECT_EQ(random.uniform(), static_cast<double>(9981545732273789042u >> 11) * 0x1p-53);
}

TEST(Random, UniformHasTheMomentsOfTheUnitInterval) {
  Random random(1);
  constexpr int count = 100000;
  double sum = 0, squares = 0;
  for (int k = 0; k < count; ++k) {
    const double x = random.uniform();
    ASSERT_TRUE(0 <= x && x < 1);
    sum += x;
    squares += x * x;
  }
  // Four standard deviations: σ(x) = 1/√12, σ(x²) = √(4/45).
  EXPECT_NEAR(sum / count, 1. / 2, 4 * std::sqrt(1. / 12 / count));
  EXPECT_NEAR(squares / count, 1. / 3, 4 * std::sqrt(4. / 45 / count));
}

TEST(Random, NormalHasTheMomentsOfTheNormalDistribution) {
  Random random(2);
  constexpr int count = 100000;
  double moments[4] = {};
  for (int k = 0; k < count; ++k) {
    const double x = random.normal();
    double power = 1;
    for (double& moment : moments) moment += power *= x;
  }
  // Four standard deviations: Var xᵏ = E x²ᵏ − (E xᵏ)² = 1, 2, 15, 96.
  const double expected[] = {0, 1, 0, 3}, variance[] = {1, 2, 15, 96};
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(moments[k] / count, expected[k], 4 * std::sqrt(variance[k] / count));
}

TEST(Random, BelowReachesEveryNumberAboutEquallyOften) {
  Random random(3);
  constexpr int count = 70000;
  std::vector<int> hits(7, 0);
  for (int k = 0; k < count; ++k) ++hits.at(random.below(7));
  for (const int hit : hits) EXPECT_NEAR(hit, count / 7., 4 * std::sqrt(count * 6. / 49));
  EXPECT_EQ(random.below(1), 0);
}

TEST(Random, SampleHasDifferentItemsOfTheList) {
  Random random(4);
  std::vector<int> items(50);
  std::iota(items.begin(), items.end(), 100);
  const std::vector<int> ten = random.sample(items, 10);
  EXPECT_EQ(std::set<int>(ten.begin(), ten.end()).size(), 10u);
  EXPECT_TRUE(std::ranges::all_of(ten, [](int item) { return 100 <= item && item < 150; }));
  std::vector<int> all = random.sample(items, 80);
  EXPECT_NE(all, items);
  std::ranges::sort(all);
  EXPECT_EQ(all, items);
}

}  // namespace
}  // namespace supple
