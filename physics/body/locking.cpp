#include <physics/body/locking.hpp>
#include <physics/body/material_law.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace supple {

namespace {

/// NaN where the law does not tell.
template <typename Mesh>
double largest_poisson(const SolidOf<Mesh>& solid) {
  const auto& poisson = material_law(solid.law).poisson;
  double largest = std::numeric_limits<double>::quiet_NaN();
  if (!poisson) return largest;
  for (Index k = 0; k < solid.parameters.rows(); ++k) {
    const std::vector<double> values(solid.parameters.row(k).begin(), solid.parameters.row(k).end());
    largest = std::fmax(largest, poisson(values));
  }
  return largest;
}

}  // namespace

std::optional<double> locking_poisson(const Body& body) {
  constexpr double limit = 0.45 + 1e-9;  // parameters have rounded it
  if (std::holds_alternative<Shell>(body) || std::holds_alternative<QuadraticTetSolid>(body)) return {};
  const double largest = visit_solid(body, [](const auto& solid) { return largest_poisson(solid); });
  return largest > limit ? std::optional(largest) : std::nullopt;
}

}  // namespace supple
