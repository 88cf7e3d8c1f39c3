#pragma once
/// \file Median of a few measured values.

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

namespace supple {

/// The middle one of values in order, of an even number the upper of two; NaN if there are none.
inline double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace supple
