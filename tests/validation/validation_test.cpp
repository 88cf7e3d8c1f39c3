// A short part of docs/validation.md: coarse meshes, so within a few percent.

#include <benchmarks/validation/cases.hpp>
#include <gtest/gtest.h>

#include <algorithm>

namespace supple::test {
namespace {

ValidationCase named(const std::string& name) {
  const std::vector<ValidationCase> all = validation_cases();
  const auto found = std::ranges::find(all, name, &ValidationCase::name);
  if (found == all.end()) throw std::out_of_range("no case " + name);
  return *found;
}

void expect_published(const std::string& name, double tolerance, bool with_reduced, double reduced_tolerance = 0) {
  const ValidationCase what = named(name);
  const Validation result = what.run(what.levels.front(), with_reduced);
  ASSERT_EQ(result.full.size(), static_cast<Index>(what.values.size())) << name;
  for (std::size_t k = 0; k < what.values.size(); ++k) {
    const auto& [quantity, unit, value] = what.values[k];
    EXPECT_NEAR(result.full[static_cast<Index>(k)], value, tolerance * std::abs(value)) << name << ", " << quantity;
    if (with_reduced)
      EXPECT_NEAR(result.reduced[static_cast<Index>(k)], value, reduced_tolerance * std::abs(value))
          << name << ", reduced, " << quantity;
  }
}

TEST(Validation, CooksMembrane) {
  expect_published("Cook's membrane", 0.01, true, 0.03);
}
TEST(Validation, TheBarBehindACylinder) {
  expect_published("Turek–Hron CSM1", 0.015, true, 0.03);
  expect_published("Turek–Hron CSM2", 0.015, false);
}
TEST(Validation, TheTwistedBeam) {
  expect_published("twisted beam", 0.02, false);
}
TEST(Validation, TheThickPlate) {
  expect_published("NAFEMS FV52", 0.04, false);
}
TEST(Validation, TheThinPlateAsAShell) {
  expect_published("NAFEMS FV16, shell of equilateral triangles", 0.25, false);
}

}  // namespace
}  // namespace supple::test
