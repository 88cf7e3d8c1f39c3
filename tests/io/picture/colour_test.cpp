#include <io/picture/colour.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace supple {
namespace {

/// Lightness L* of CIELAB, another measure than the one the maps were made with.
double lightness(const Colour& colour) {
  const double Y = Eigen::Vector3d(0.2126, 0.7152, 0.0722).dot(to_linear(colour).cast<double>());
  return Y > 0.008856 ? 116 * std::cbrt(Y) - 16 : 903.3 * Y;
}

TEST(Colour, ScreenAndLinearAreInverse) {
  for (int k = 0; k <= 255; ++k) {
    const Colour grey{k / 255.0, k / 255.0, 1 - k / 255.0}, back = to_screen(to_linear(grey));
    EXPECT_NEAR(back.r, grey.r, 1e-5);
    EXPECT_NEAR(back.b, grey.b, 1e-5);
  }
  EXPECT_NEAR(to_screen({2, -1, 0.5f}).r, 1, 1e-12);
  EXPECT_EQ(to_screen({2, -1, 0.5f}).g, 0);
  EXPECT_NEAR(to_screen({0, 0, 0.21404f}).b, 0.5, 1e-4);  // the middle of the screen's scale
  EXPECT_EQ(rgb(0xff0080), (Colour{1, 0, 128 / 255.0}));
}

TEST(ColourMap, SequentialGetsEvenlyLighter) {
  constexpr int steps = 64;
  const double from = lightness(map_colour(ColourMap::Sequential, 0)),
               to = lightness(map_colour(ColourMap::Sequential, 1));
  EXPECT_GT(to - from, 60);
  for (int k = 1; k <= steps; ++k) {
    const double before = lightness(map_colour(ColourMap::Sequential, (k - 1.0) / steps));
    const double step = lightness(map_colour(ColourMap::Sequential, k * 1.0 / steps)) - before;
    EXPECT_GT(step, 0.5 * (to - from) / steps) << k;
    EXPECT_LT(step, 1.6 * (to - from) / steps) << k;
  }
}

TEST(ColourMap, DivergingIsEquallyDarkOnBothSidesAndNeutralInTheMiddle) {
  for (const double side : {0.1, 0.25, 0.4, 0.5})
    EXPECT_NEAR(lightness(map_colour(ColourMap::Diverging, 0.5 - side)),
                lightness(map_colour(ColourMap::Diverging, 0.5 + side)), 6);
  const Colour middle = map_colour(ColourMap::Diverging, 0.5);
  EXPECT_NEAR(middle.r, middle.b, 0.02);
  EXPECT_GT(map_colour(ColourMap::Diverging, 0).b, 2 * map_colour(ColourMap::Diverging, 0).r);
  EXPECT_GT(map_colour(ColourMap::Diverging, 1).r, 2 * map_colour(ColourMap::Diverging, 1).b);
}

TEST(ColourMap, OutsideIsClampedAndNotANumberIsGrey) {
  for (const ColourMap map : {ColourMap::Sequential, ColourMap::Diverging}) {
    EXPECT_EQ(map_colour(map, -3), map_colour(map, 0));
    EXPECT_EQ(map_colour(map, 7), map_colour(map, 1));
    const Colour grey = map_colour(map, std::nan(""));
    EXPECT_TRUE(grey.r == grey.g && grey.g == grey.b);
  }
}

}  // namespace
}  // namespace supple
