#include <core/check.hpp>
#include <io/text/unit.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

namespace supple {
namespace {

TEST(Unit, ConvertsBetweenUnitsOfOneKind) {
  struct Case {
    const char *given, *unit;
    double factor;
  };
  for (const auto& [given, unit, factor] : {Case{"kPa", "Pa", 1e3},
                                            {"MPa", "Pa", 1e6},
                                            {"N/mm^2", "Pa", 1e6},
                                            {"N mm^-2", "MPa", 1},
                                            {"g/cm^3", "kg/m^3", 1000},
                                            {"kg·m⁻³", "kg/m^3", 1},
                                            {"cm", "m", 0.01},
                                            {"mm", "m", 1e-3},
                                            {"min", "s", 60},
                                            {"ms", "s", 1e-3},
                                            {"µs", "s", 1e-6},
                                            {"deg", "rad", std::numbers::pi / 180},
                                            {"kg m/s^2", "N", 1},
                                            {"kg m / s²", "N", 1},
                                            {"N m", "J", 1},
                                            {"J/s", "W", 1},
                                            {"1/s", "Hz", 1},
                                            {"km/h", "m/s", 1 / 3.6},
                                            {"%", "", 0.01},
                                            {"", "", 1},
                                            {"N*s/m", "kg/s", 1}})
    EXPECT_NEAR(conversion_factor(given, unit), factor, 1e-12 * factor) << given << " in " << unit;
}

TEST(Unit, RefusesOtherKindsAndWhatIsNoUnit) {
  for (const char* given : {"kg", "Pa s", "", "m^", "m^x", "m/s/s", "/", "Pa/", "kkPa", "hh", "m^99", "²"})
    EXPECT_THROW(conversion_factor(given, "Pa"), InputError) << given;
  EXPECT_THROW(conversion_factor("Pa", "wrong"), std::invalid_argument);
  EXPECT_THAT([] { conversion_factor("kg", "Pa"); },
              testing::ThrowsMessage<InputError>(testing::HasSubstr("'kg' is not a unit of Pa")));
}

TEST(Unit, QuantitiesAreNumbersWithOrWithoutUnit) {
  EXPECT_DOUBLE_EQ(parse_quantity("2.5 MPa", "Pa"), 2.5e6);
  EXPECT_DOUBLE_EQ(parse_quantity("-3e-2m", "cm"), -3);
  EXPECT_DOUBLE_EQ(parse_quantity("+7", "kg"), 7);
  EXPECT_DOUBLE_EQ(parse_quantity("0.3", ""), 0.3);
  for (const char* text : {"", "Pa", "nan Pa", "1e999", "inf", "2 kg", "1 2", "--1", "+-1", "-+1", "1e308 GPa"})
    EXPECT_THROW(parse_quantity(text, "Pa"), InputError) << text;
}

}  // namespace
}  // namespace supple
