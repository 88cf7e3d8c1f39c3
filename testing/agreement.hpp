#pragma once
/// \file Comparisons that say in words what does not hold.

#include <core/types.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>
#include <string>

namespace supple::test {

/// All parts, one after the other.
template <typename... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream stream;
  stream.precision(9);
  (stream << ... << parts);
  return stream.str();
}

/// True, or "<claim>: <entry>: expected <number><origin>, found <number> (tolerance …)" of the entry that is farthest
/// off. NaN is near nothing.
/// \param claim  what is violated if they differ, and where.  \param name  name(row, column): how to call an entry.
/// \param tolerance  absolute.  \param origin  where the expected numbers come from, such as " by differences".
template <typename Name>
testing::AssertionResult agree(const std::string& claim, const Name& name, MatrixIn found, MatrixIn expected,
                               double tolerance, const std::string& origin = "") {
  if (found.rows() != expected.rows() || found.cols() != expected.cols())
    return testing::AssertionFailure() << claim << ": expected " << expected.rows() << " x " << expected.cols()
                                       << " numbers, found " << found.rows() << " x " << found.cols();
  Index row = -1, column = -1;
  double farthest = tolerance;
  for (Index j = 0; j < found.cols(); ++j)
    for (Index i = 0; i < found.rows(); ++i) {
      const double distance = std::abs(found(i, j) - expected(i, j));
      if (distance <= farthest || std::isnan(farthest)) continue;
      row = i, column = j, farthest = distance;
    }
  if (row < 0 && !std::isnan(tolerance)) return testing::AssertionSuccess();
  if (row < 0) return testing::AssertionFailure() << claim << ": the scale of the comparison is not a number";
  return testing::AssertionFailure() << text(claim, ": ", name(row, column), ": expected ", expected(row, column),
                                             origin, ", found ", found(row, column), " (tolerance ", tolerance, ")");
}

/// The same of two numbers.
inline testing::AssertionResult agree(const std::string& claim, const std::string& name, double found, double expected,
                                      double tolerance, const std::string& origin = "") {
  const Vector found_entry = Vector::Constant(1, found), expected_entry = Vector::Constant(1, expected);
  return agree(
      claim, [&](Index, Index) { return name; }, found_entry, expected_entry, tolerance, origin);
}

/// The first that does not hold, or true.
template <typename... Results>
testing::AssertionResult all_hold(const Results&... results) {
  testing::AssertionResult verdict = testing::AssertionSuccess();
  (void)((results || ((verdict = results), false)) && ...);
  return verdict;
}

}  // namespace supple::test
