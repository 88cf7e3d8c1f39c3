#pragma once
/// \file Active-set method of non-negative least squares, written once over a factor of the passive
/// columns. Internal to sparse/.

#include <core/report.hpp>
#include <core/types.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace supple {

using Indices = std::vector<Index>;

/// A least-squares problem with unit (or zero) columns, and a factor of its columns P = P₀, P₁, … that can be
/// updated.
template <typename F>
concept PassiveFactor = requires(F& factor, const F& f, const Indices& P, Index i, const Vector& x) {
  { f.cols() } -> std::convertible_to<Index>;
  { f.is_zero(i) } -> std::convertible_to<bool>;
  { factor.assign(P) } -> std::convertible_to<bool>;     // starts anew with P; false, and empty: some depend on others
  { factor.append(P, i) } -> std::convertible_to<bool>;  // adds column i behind P; false: depends on those, no change
  factor.remove(i);                                      // removes P's position i
  { f.solve(P) } -> std::convertible_to<Vector>;         // minimiser on P, in its order
  { f.gradient(P, x) } -> std::convertible_to<Vector>;   // g = Aᵀ(b − A x) for that minimiser x; all columns
  { f.scale() } -> std::convertible_to<double>;          // g is measured relative to this
  { f.rounding(x) } -> std::convertible_to<double>;      // of g
};

/// Minimises on a passive set of columns, which it exchanges until the others have a gradient that is not
/// positive.
template <PassiveFactor Factor>
class ActiveSet {
 public:
  Factor factor;
  Indices passive;
  Vector x, g;
  Index iterations = 0;
  bool refused = false;  ///< has a column ever stayed out because it depends on others, to the factor's digits?

  /// \param gradient_tolerance  relative to factor.scale().
  ActiveSet(Factor&& unit_columns, double gradient_tolerance, Index largest_iterations)
      : factor(std::move(unit_columns)),
        x(Vector::Zero(factor.cols())),
        g(x),
        tolerance_(gradient_tolerance),
        max_iterations_(largest_iterations),
        in_set_(factor.cols(), 0),
        dependent_(factor.cols(), 0) {}

  /// True if it came to its end, false if it ran into the limit of iterations; x ≥ 0 in any case.
  bool run(const Indices& start) {
    set_passive(start);
    exchange_blocks();
    return exchange_single();
  }

  /// One column at a time only.
  bool run_single(const Indices& start) {
    set_passive(start);
    return exchange_single();
  }

  /// Everything that may be is passive, whatever its sign.
  void run_unconstrained() {
    Indices all(size());
    std::iota(all.begin(), all.end(), Index{0});
    set_passive(std::move(all));
    minimise();
  }

  double kkt_residual() const {
    double worst = 0;
    for (Index i = 0; i < size(); ++i)
      if (!factor.is_zero(i)) worst = std::max(worst, in_set_[i] ? std::abs(g[i]) : g[i]);
    return worst > 0 ? worst / factor.scale() : 0;
  }

 private:
  double tolerance_;
  Index max_iterations_;
  std::vector<char> in_set_;
  std::vector<char> dependent_;  // on the passive set, until that loses a column

  Index size() const { return factor.cols(); }

  bool add(Index i) {
    if (dependent_[i]) return false;
    if (factor.is_zero(i) || !factor.append(passive, i)) {
      refuse(i);
      return false;
    }
    passive.push_back(i);
    in_set_[i] = 1;
    return true;
  }

  void refuse(Index i) {
    dependent_[i] = 1;
    refused = refused || !factor.is_zero(i);
  }

  void remove_at(Index k) {
    factor.remove(k);
    in_set_[passive[k]] = 0;
    x[passive[k]] = 0;
    passive.erase(passive.begin() + k);
  }

  template <typename Predicate>
  bool remove_if(const Predicate& leaves) {
    const auto before = passive.size();
    for (Index k = static_cast<Index>(before) - 1; k >= 0; --k)
      if (leaves(passive[k])) remove_at(k);
    if (passive.size() == before) return false;
    std::fill(dependent_.begin(), dependent_.end(), 0);
    return true;
  }

  // Makes exactly these columns passive, but for those that depend on others.
  void set_passive(Indices indices) {
    std::fill(in_set_.begin(), in_set_.end(), 0);
    std::fill(dependent_.begin(), dependent_.end(), 0);
    std::erase_if(indices, [&](Index i) { return factor.is_zero(i) || std::exchange(in_set_[i], 1); });
    x = Vector::Zero(size());
    if (factor.assign(indices)) {
      passive = std::move(indices);
      return;
    }
    std::fill(in_set_.begin(), in_set_.end(), 0);
    passive.clear();
    for (Index i : indices) add(i);
  }

  Vector minimiser() const {
    Vector z = Vector::Zero(size());
    z(passive) = factor.solve(passive);
    return z;
  }

  void minimise() {
    x = minimiser();
    g = factor.gradient(passive, x);
  }

  // Leaves out what is not positive until the minimiser on the passive set is.
  void make_feasible() {
    for (x = minimiser(); remove_if([&](Index i) { return x[i] <= 0; }); x = minimiser()) {
    }
    g = factor.gradient(passive, x);
  }

  // Smallest gradient that is more than rounding.
  double threshold() const { return std::max(tolerance_ * factor.scale(), factor.rounding(x)); }

  bool wants_in(Index i, double limit) const { return !in_set_[i] && !dependent_[i] && g[i] > limit; }

  // Negative ones out, `entering` in: by updates of the factor if they are few, else from scratch.
  void exchange(const Indices& entering) {
    const auto leaves = [&](Index i) { return x[i] < 0; };
    const auto leaving = std::count_if(passive.begin(), passive.end(), leaves);
    if (8 * (leaving + entering.size()) < passive.size()) {
      remove_if(leaves);
      for (Index i : entering) add(i);
      return;
    }
    Indices indices = passive;
    std::erase_if(indices, leaves);
    indices.insert(indices.end(), entering.begin(), entering.end());
    set_passive(std::move(indices));
  }

  // Kim & Park: exchange all that violate, as long as they get fewer, or for three more rounds.
  void exchange_blocks() {
    auto fewest = std::numeric_limits<std::ptrdiff_t>::max();
    for (int patience = 3; iterations < max_iterations_; ++iterations) {
      minimise();
      const double limit = threshold();
      Indices entering;
      for (Index i = 0; i < size(); ++i)
        if (wants_in(i, limit)) entering.push_back(i);
      const auto violations = static_cast<std::ptrdiff_t>(entering.size()) +
                              std::count_if(passive.begin(), passive.end(), [&](Index i) { return x[i] < 0; });
      if (violations == 0) return;
      if (violations < fewest) {
        fewest = violations;
        patience = 3;
      } else if (patience-- == 0) {
        return;
      }
      exchange(entering);
    }
  }

  // Lawson & Hanson: one column in, then along the segment to the minimiser, dropping what becomes zero. The
  // error decreases strictly; a column whose entrance cannot decrease it, for lack of digits, counts as
  // dependent.
  bool exchange_single() {
    make_feasible();
    for (;; ++iterations) {
      const double limit = factor.least_gradient(x, threshold());
      Index best = -1;
      for (Index i = 0; i < size(); ++i)
        if (wants_in(i, limit) && (best < 0 || g[i] > g[best])) best = i;
      if (best < 0) return true;
      if (iterations >= max_iterations_) return false;
      if (!add(best)) continue;
      Vector z = minimiser();
      if (z[best] <= 0 || !factor.last_matters()) {
        remove_at(static_cast<Index>(passive.size()) - 1);
        refuse(best);
        continue;
      }
      while (std::any_of(passive.begin(), passive.end(), [&](Index i) { return z[i] <= 0; })) {
        double alpha = 1;
        for (Index i : passive)
          if (z[i] <= 0) alpha = std::min(alpha, x[i] / (x[i] - z[i]));
        const Vector toward = x + alpha * (z - x);
        Index first = -1;  // the one that alpha belongs to leaves, whatever rounding says
        for (Index i : passive)
          if (z[i] <= 0 && (first < 0 || toward[i] < toward[first])) first = i;
        x = toward;
        remove_if([&](Index i) { return i == first || toward[i] <= 0; });
        z = minimiser();
      }
      x = z;
      g = factor.gradient(passive, x);
    }
  }
};

inline Status nnls_status(bool finished, double kkt_residual, double tolerance) {
  if (kkt_residual <= tolerance) return Status::Converged;
  return finished ? Status::Stagnated : Status::MaxIterations;
}

}  // namespace supple
