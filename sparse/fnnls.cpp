#include <core/check.hpp>
#include <sparse/nnls.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace supple {

Vector PassiveSet::solve(VectorIn c) const {
  Vector x = Vector::Zero(scale.size());
  x(indices) = factor.solve(c(indices).cwiseProduct(scale(indices)));
  return x.cwiseProduct(scale);
}

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr char dependent = 1, zero_column = 2;

// The problem with unit columns, and the state of the active-set method on it.
struct Fit {
  Matrix G;
  Vector c;
  PassiveSet passive;
  Vector x, g;               // g = c − G x
  std::vector<char> in_set;  // is it passive?
  std::vector<char>
      blocked;  // 0, or the reason why not to add it; `dependent` ends when the set loses a column
  double scale_of_c;

  Fit(MatrixIn gram, VectorIn atb, std::span<const Index> start)
      : passive{{}, UpdatableCholesky(gram.cols()), Vector(gram.cols())},
        x(Vector::Zero(gram.cols())),
        in_set(gram.cols(), 0),
        blocked(gram.cols(), 0) {
    for (Index i = 0; i < gram.cols(); ++i) {
      passive.scale[i] = gram(i, i) > 0 ? 1 / std::sqrt(gram(i, i)) : 0;
      if (passive.scale[i] == 0) blocked[i] = zero_column;
    }
    G = passive.scale.asDiagonal() * gram * passive.scale.asDiagonal();
    c = atb.cwiseProduct(passive.scale);
    scale_of_c = c.size() ? c.cwiseAbs().maxCoeff() : 0;
    set_passive({start.begin(), start.end()});
  }

  Index size() const { return c.size(); }
  bool finite() const { return c.allFinite() && G.allFinite(); }

  bool add(Index i) {
    if (blocked[i] || !passive.factor.append(G(passive.indices, i))) {
      blocked[i] = std::max(blocked[i], dependent);
      return false;
    }
    passive.indices.push_back(i);
    in_set[i] = 1;
    return true;
  }

  // Makes exactly these columns passive, but for those that depend on the others.
  void set_passive(std::vector<Index> indices) {
    std::fill(in_set.begin(), in_set.end(), 0);
    std::erase_if(indices, [&](Index i) { return blocked[i] == zero_column || std::exchange(in_set[i], 1); });
    if (passive.factor.assign(G(indices, indices))) {
      passive.indices = std::move(indices);
      return;
    }
    std::fill(in_set.begin(), in_set.end(), 0);
    passive.indices.clear();
    for (Index i : indices) add(i);
  }

  void remove_at(Index k) {
    const Index i = passive.indices[k];
    passive.factor.remove(k);
    passive.indices.erase(passive.indices.begin() + k);
    in_set[i] = 0;
    x[i] = 0;
  }

  template <typename Predicate>
  bool remove_if(const Predicate& leaves) {
    bool removed = false;
    for (Index k = static_cast<Index>(passive.indices.size()) - 1; k >= 0; --k)
      if (leaves(passive.indices[k])) {
        remove_at(k);
        removed = true;
      }
    if (removed)
      for (char& b : blocked) b = b == zero_column ? zero_column : 0;
    return removed;
  }

  Vector solve() const {
    Vector z = Vector::Zero(size());
    z(passive.indices) = passive.factor.solve(c(passive.indices));
    return z;
  }

  void update_gradient() {
    g = c;
    for (Index i : passive.indices) g -= x[i] * G.col(i);
  }

  // Smallest gradient that is more than rounding.
  double threshold(double tolerance) const {
    return std::max(tolerance * scale_of_c, 4 * epsilon * (scale_of_c + x.lpNorm<1>()));
  }

  bool wants_in(Index i, double limit) const { return !in_set[i] && !blocked[i] && g[i] > limit; }

  // Leaves out what is not positive until the minimiser on the passive set is.
  void make_feasible() {
    for (x = solve(); remove_if([&](Index i) { return x[i] <= 0; }); x = solve()) {
    }
    update_gradient();
  }

  // Negative ones out, `entering` in: by updates of the factor if they are few, else from scratch.
  void exchange(const std::vector<Index>& entering) {
    const auto leaves = [&](Index i) { return x[i] < 0; };
    const auto leaving = std::count_if(passive.indices.begin(), passive.indices.end(), leaves);
    if (8 * (leaving + static_cast<Index>(entering.size())) < passive.factor.size()) {
      remove_if(leaves);
      for (Index i : entering) add(i);
      return;
    }
    std::vector<Index> indices = passive.indices;
    std::erase_if(indices, leaves);
    for (char& b : blocked) b = b == zero_column ? zero_column : 0;
    indices.insert(indices.end(), entering.begin(), entering.end());
    set_passive(std::move(indices));
  }

  // Kim & Park: exchange all that violate, as long as they get fewer, or for three more rounds. True if
  // optimal.
  bool exchange_blocks(double tolerance, Index& iterations, Index max_iterations) {
    Index fewest = size() + 1;
    for (int patience = 3; iterations < max_iterations;) {
      x = solve();
      update_gradient();
      const double limit = threshold(tolerance);
      std::vector<Index> entering;
      for (Index i = 0; i < size(); ++i)
        if (wants_in(i, limit)) entering.push_back(i);
      const auto leaving =
          std::count_if(passive.indices.begin(), passive.indices.end(), [&](Index i) { return x[i] < 0; });
      const Index violations = static_cast<Index>(entering.size()) + leaving;
      if (violations == 0) return true;
      if (violations < fewest) {
        fewest = violations;
        patience = 3;
      } else if (patience-- == 0) {
        return false;
      }
      ++iterations;
      exchange(entering);
    }
    return false;
  }

  // Lawson & Hanson: one column in, then along the segment to the minimiser, dropping what becomes zero. The
  // error decreases strictly; a column whose entrance cannot decrease it, for lack of digits, is blocked.
  bool exchange_single(double tolerance, Index& iterations, Index max_iterations) {
    make_feasible();
    for (;; ++iterations) {
      const double limit = threshold(tolerance);
      Index best = -1;
      for (Index i = 0; i < size(); ++i)
        if (wants_in(i, limit) && (best < 0 || g[i] > g[best])) best = i;
      if (best < 0) return true;
      if (iterations >= max_iterations) return false;
      if (!add(best)) continue;
      Vector z = solve();
      if (z[best] <= 0) {
        remove_at(static_cast<Index>(passive.indices.size()) - 1);
        blocked[best] = dependent;
        continue;
      }
      while (
          std::any_of(passive.indices.begin(), passive.indices.end(), [&](Index i) { return z[i] <= 0; })) {
        double alpha = 1;
        for (Index i : passive.indices)
          if (z[i] <= 0) alpha = std::min(alpha, x[i] / (x[i] - z[i]));
        const Vector toward = x + alpha * (z - x);
        Index first = -1;  // the one that alpha belongs to leaves, whatever rounding says
        for (Index i : passive.indices)
          if (z[i] <= 0 && (first < 0 || toward[i] < toward[first])) first = i;
        x = toward;
        remove_if([&](Index i) { return i == first || toward[i] <= 0; });
        z = solve();
      }
      x = z;
      update_gradient();
    }
  }

  // Everything passive that may be.
  void solve_all() {
    std::vector<Index> all(size());
    std::iota(all.begin(), all.end(), Index{0});
    set_passive(std::move(all));
    x = solve();
    update_gradient();
  }

  double kkt_residual() const {
    double worst = 0;
    for (Index i = 0; i < size(); ++i)
      if (blocked[i] != zero_column) worst = std::max(worst, in_set[i] ? std::abs(g[i]) : g[i]);
    return scale_of_c > 0 ? worst / scale_of_c : 0;
  }
};

NnlsSolution not_finite(Fit&& fit) {
  Report report;
  report.status = Status::NotFinite;
  return {Vector::Zero(fit.size()), std::move(fit.passive), report};
}

void require_normal_equations(MatrixIn gram, VectorIn atb) {
  require_size("gram (columns)", gram.cols(), gram.rows());
  require_size("atb", atb.size(), gram.cols());
}

}  // namespace

NnlsSolution Fnnls::operator()(MatrixIn gram, VectorIn atb, std::span<const Index> start) const {
  require_normal_equations(gram, atb);
  for (Index i : start)
    require(0 <= i && i < gram.cols(),
            "passive holds " + std::to_string(i) + ", expected 0 to " + std::to_string(gram.cols() - 1));
  Fit fit(gram, atb, start);
  if (!fit.finite()) return not_finite(std::move(fit));
  Report report;
  const Index limit = max_iterations > 0 ? max_iterations : 3 * fit.size() + 30;
  const bool finished = fit.exchange_blocks(tolerance, report.iterations, limit) ||
                        fit.exchange_single(tolerance, report.iterations, limit);
  fit.update_gradient();
  report.residual = fit.kkt_residual();
  report.status = report.residual <= tolerance ? Status::Converged
                  : finished                   ? Status::Stagnated
                                               : Status::MaxIterations;
  Vector w = fit.x.cwiseProduct(fit.passive.scale);
  return {std::move(w), std::move(fit.passive), report};
}

NnlsSolution least_squares(MatrixIn gram, VectorIn atb) {
  require_normal_equations(gram, atb);
  Fit fit(gram, atb, {});
  if (!fit.finite()) return not_finite(std::move(fit));
  fit.solve_all();
  Report report;
  report.iterations = 1;
  report.residual = fit.scale_of_c > 0 ? fit.g.cwiseAbs().maxCoeff() / fit.scale_of_c : 0;
  report.status = report.residual <= 1e-12 ? Status::Converged : Status::Stagnated;
  Vector w = fit.x.cwiseProduct(fit.passive.scale);
  return {std::move(w), std::move(fit.passive), report};
}

}  // namespace supple
