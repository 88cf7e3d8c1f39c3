#pragma once
/// \file Memory of steps, and the inverse Hessian that they tell of.

#include <core/check.hpp>

#include <limits>
#include <vector>

namespace supple {

/// Steps s with the changes y of the gradient over them, and the product with the inverse Hessian that follows
/// by the BFGS formula: O(d) for each pair beside one product with the inverse of H₀. Pairs stay useful as long
/// as the Hessian changes little, for other gradients, too.
class BfgsMemory {
 public:
  static constexpr Index unlimited = std::numeric_limits<Index>::max();

  /// \param capacity  pairs to keep, at least one; beyond that the oldest are forgotten (Nocedal 1980).
  explicit BfgsMemory(Index capacity = unlimited) : capacity_(capacity) {
    require(capacity >= 1, "capacity is " + std::to_string(capacity) + ", expected at least 1");
  }

  /// Pairs along which the gradient does not rise are left out: they would make the Hessian indefinite.
  void add(Vector s, Vector y) {
    const double curvature = s.dot(y);
    if (!(curvature > 0)) return;
    if (size() >= capacity_) pairs_.erase(pairs_.begin());
    pairs_.push_back({std::move(s), std::move(y), 1 / curvature});
  }
  void clear() { pairs_.clear(); }
  Index size() const { return static_cast<Index>(pairs_.size()); }

  /// H⁻¹ g by the two-loop recursion (Nocedal 1980); H₀ is what the solver holds.
  template <typename Solver>
  Vector inverse_times(const Solver& solver, Vector g) const {
    const std::vector<double> a = first_loop(g);
    Vector d = solver.solve(g);
    second_loop(a, d);
    return d;
  }

  /// The recursion in two parts, for many gradients whose products with H₀⁻¹ are formed at once: g becomes what H₀⁻¹ is
  /// applied to, which second_loop() then makes H⁻¹ g of.
  std::vector<double> first_loop(Vector& g) const {
    std::vector<double> a(pairs_.size());
    for (std::size_t k = pairs_.size(); k-- > 0;) {
      a[k] = pairs_[k].inverse_curvature * pairs_[k].s.dot(g);
      g -= a[k] * pairs_[k].y;
    }
    return a;
  }
  void second_loop(const std::vector<double>& a, Vector& d) const {
    for (std::size_t k = 0; k < pairs_.size(); ++k)
      d += (a[k] - pairs_[k].inverse_curvature * pairs_[k].y.dot(d)) * pairs_[k].s;
  }

 private:
  struct Pair {
    Vector s, y;
    double inverse_curvature;  // 1 / sᵀy
  };
  Index capacity_;
  std::vector<Pair> pairs_;
};

}  // namespace supple
