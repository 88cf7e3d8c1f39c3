#pragma once
/// \file Report of an iterative method: status, iterations, residual. Not converging is an answer, not an exception.

#include <core/types.hpp>

#include <limits>
#include <string_view>

namespace supple {

enum class Status {
  Converged,      ///< the stated tolerance is met
  MaxIterations,  ///< stopped at the limit of iterations; the best iterate is returned
  Stagnated,      ///< no further progress possible; the best iterate is returned
  NotFinite,      ///< a NaN or infinity appeared; the result must not be used
};

constexpr std::string_view to_string(Status status) {
  switch (status) {
    case Status::Converged:
      return "converged";
    case Status::MaxIterations:
      return "max-iterations";
    case Status::Stagnated:
      return "stagnated";
    case Status::NotFinite:
      return "not-finite";
  }
  return "unknown";
}

struct [[nodiscard]] Report {
  Status status = Status::MaxIterations;
  Index iterations = 0;
  double residual = std::numeric_limits<double>::infinity();  ///< in the measure that the method documents
};

}  // namespace supple
