#pragma once
/// \file Comparisons that print both sides and the worst entry.

#include <core/types.hpp>

#include <gtest/gtest.h>

namespace supple::test {

/// Every entry of `actual` within `tolerance` (absolute) of `expected`; NaN is near nothing.
inline testing::AssertionResult is_near(MatrixIn actual, MatrixIn expected, double tolerance) {
  if (actual.rows() != expected.rows() || actual.cols() != expected.cols())
    return testing::AssertionFailure() << "size " << actual.rows() << " x " << actual.cols() << ", expected "
                                       << expected.rows() << " x " << expected.cols();
  for (Index j = 0; j < actual.cols(); ++j)
    for (Index i = 0; i < actual.rows(); ++i)
      if (!(std::abs(actual(i, j) - expected(i, j)) <= tolerance)) {
        const Eigen::IOFormat format(12, 0, ", ", "\n", "  [", "]");
        const auto shown = [&](MatrixIn A) {  // enough to see what is wrong, not a page of a large system
          return A.topLeftCorner(std::min<Index>(A.rows(), 24), std::min<Index>(A.cols(), 12)).eval();
        };
        return testing::AssertionFailure() << "entry (" << i << ", " << j << ") is " << actual(i, j) << ", expected "
                                           << expected(i, j) << " +- " << tolerance << "\nactual\n"
                                           << shown(actual).format(format) << "\nexpected\n"
                                           << shown(expected).format(format);
      }
  return testing::AssertionSuccess();
}

/// The same bits (equal numbers; no NaN).
inline testing::AssertionResult is_same(MatrixIn actual, MatrixIn expected) {
  return is_near(actual, expected, 0);
}

}  // namespace supple::test
