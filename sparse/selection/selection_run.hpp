#pragma once
/// \file Run of a selector, what all do alike: check the request, evaluate columns, keep the best iterate, account for
/// it all.

#include <core/random.hpp>
#include <core/stopwatch.hpp>
#include <sparse/nnls/working_set.hpp>
#include <sparse/selection/subset_selector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

namespace supple {

/// \throws InputError unless 1e-140 <= x <= 1e140, so that squares and products with squares are numbers with all digits.
/// \param name  of x, for the message.
void require_square_in_range(const std::string& name, double x);

/// A request, checked against a problem: who may be chosen, who must be, and how many.
class SelectionRules {
 public:
  /// \throws std::invalid_argument if the request makes no sense for A with `cols` columns; InputError if b
  /// is not finite.
  SelectionRules(const SelectionRequest& request, Index cols, const Vector& b);

  Index size() const { return size_; }                              ///< s, at most the number of eligible columns
  const std::vector<Index>& eligible() const { return eligible_; }  ///< candidates and must-keep, ascending
  const std::vector<Index>& must_keep() const { return must_keep_; }
  bool must_keep(Index j) const { return role_[j] == Role::MustKeep; }
  std::vector<Index> eligible_without(const std::vector<Index>& indices) const;
  /// Must-keep and what is eligible of the warm start, its largest weights if there are too many; ascending.
  const std::vector<Index>& start() const { return start_; }

 private:
  enum class Role : char { Excluded, Candidate, MustKeep };

  Index size_;
  std::vector<Role> role_;
  std::vector<Index> eligible_, must_keep_, start_;
};

/// Evaluated columns and their norms ‖a_j‖.
template <FittingProblem P>
struct Evaluated {
  ColumnsOf<P> block;
  Vector norms;
};

/// factor · s, rounded up.
inline Index share(double factor, Index s) {
  return static_cast<Index>(std::min(1e15, std::ceil(factor * static_cast<double>(s))));
}

/// Ascending positions of a joined vector, as those of its first part and those of its second.
inline std::pair<std::vector<Index>, std::vector<Index>> split_at(Index first_size,
                                                                  const std::vector<Index>& positions) {
  std::pair<std::vector<Index>, std::vector<Index>> parts;
  for (Index k : positions) k < first_size ? parts.first.push_back(k) : parts.second.push_back(k - first_size);
  return parts;
}

inline std::vector<Index> sorted_union(std::vector<Index> a, const std::vector<Index>& b) {
  a.insert(a.end(), b.begin(), b.end());
  std::sort(a.begin(), a.end());
  return a;
}

/// Columns seen against a residual r.
template <FittingProblem P>
struct Scan {
  std::vector<Index> indices;
  /// g_j = a_jᵀ r, and 0 where that is rounding: after an exact fit nothing else is left, and it must not
  /// choose.
  Vector correlations;
  Vector norms;                       ///< ‖a_j‖
  std::optional<ColumnsOf<P>> block;  ///< the columns themselves, if evaluated and not too many to keep

  Index size() const { return correlations.size(); }
  Vector cosines() const {  ///< g_j / ‖a_j‖
    return (correlations.array() != 0).select(correlations.cwiseQuotient(norms), 0);
  }
};

/// What finish() does with the weights of the best iterate.
enum class FinalWeights { Refitted, AsTheyAre };

/// One run of a selector on a problem.
template <FittingProblem P>
class SelectionRun {
 public:
  SelectionRun(const P& problem, const SelectionRequest& request)
      : rules(request, problem.cols(), problem.rhs()),
        problem_(problem),
        request_(request),
        b_norm_(problem.rhs().norm()) {}

  const SelectionRules rules;

  double b_norm() const { return b_norm_; }
  double error() const { return error_; }  ///< of the best iterate so far
  /// \param residual  ‖b − A w‖.
  double relative(double residual) const { return residual == 0 ? 0 : residual / b_norm_; }
  double seconds() const { return stopwatch_.seconds(); }
  Index columns_evaluated() const { return columns_evaluated_; }
  /// Has the best iterate the error that was asked for: the request's, or else the selector's own?
  bool met(double tolerance) const {
    return error_ <= std::max(request_.target_error > 0 ? request_.target_error : tolerance, 1e-15);
  }

  /// What it means to have s columns: all that was asked for, unless that was an error.
  Status status_at_size() const { return request_.target_error > 0 && !met(0) ? Status::Stagnated : Status::Converged; }

  void account(Index columns) { columns_evaluated_ += columns; }  ///< evaluated elsewhere

  /// \throws InputError naming the column if one is not finite.
  Evaluated<P> evaluate(const std::vector<Index>& js) {
    columns_evaluated_ += static_cast<Index>(js.size());
    ColumnsOf<P> block = columns_of(problem_, std::span<const Index>(js));
    Vector norms = block.squared_norms().cwiseSqrt();
    for (Index k = 0; k < norms.size(); ++k) require_norm(js[k], norms[k]);
    return {std::move(block), std::move(norms)};
  }

  /// Correlations of the columns js with r. Many columns are streamed, or left to the problem if it can do
  /// without evaluating them; then none are kept.
  Scan<P> scan(std::vector<Index> js, const Vector& r) {
    Scan<P> result{std::move(js), {}, {}, {}};
    const auto count = static_cast<Index>(result.indices.size());
    if constexpr (FullGradientProblem<P>) {
      if (2 * count > problem_.cols()) {
        result.correlations = Vector(problem_.transpose_times(r))(result.indices);
        result.norms = all_norms()(result.indices);
        columns_evaluated_ += count;
      }
    }
    if (result.norms.size() != count && count <= largest_block()) {
      Evaluated<P> evaluated = evaluate(result.indices);
      result.correlations = evaluated.block.transpose_times(r);
      result.norms = std::move(evaluated.norms);
      result.block = std::move(evaluated.block);
    } else if (result.norms.size() != count) {
      result.correlations.resize(count);
      result.norms.resize(count);
      for (Index begin = 0; begin < count; begin += largest_block()) {
        const Index size = std::min(largest_block(), count - begin);
        const auto first = result.indices.begin() + begin;
        const Evaluated<P> evaluated = evaluate({first, first + size});
        result.correlations.segment(begin, size) = evaluated.block.transpose_times(r);
        result.norms.segment(begin, size) = evaluated.norms;
      }
    }
    const auto norms = result.norms.array();
    result.correlations =
        (norms > 0 && result.correlations.array().abs() > 1e-13 * b_norm_ * norms).select(result.correlations, 0);
    return result;
  }

  /// The columns at these positions of a scan.
  ColumnsOf<P> columns(const Scan<P>& scan, const std::vector<Index>& positions) {
    if (scan.block) return scan.block->subset(positions);
    std::vector<Index> indices;
    for (Index k : positions) indices.push_back(scan.indices[k]);
    return evaluate(indices).block;
  }

  /// The working set to begin with: must-keep and warm start.
  WorkingSet<P> start() {
    WorkingSet<P> working(problem_);
    working.append(evaluate(rules.start()).block);
    return working;
  }

  /// Positions of the columns that have a weight or must be kept.
  std::vector<Index> used_positions(const WorkingSet<P>& working, const Vector& w) const {
    std::vector<Index> used;
    for (Index k = 0; k < w.size(); ++k)
      if (w[k] != 0 || rules.must_keep(working.block().index(k))) used.push_back(k);
    return used;
  }

  /// For every column of the working set: must it be kept?
  std::vector<char> must_keep(const WorkingSet<P>& working) const {
    std::vector<char> result(working.size());
    for (Index k = 0; k < working.size(); ++k) result[k] = rules.must_keep(working.block().index(k));
    return result;
  }

  /// Drops the columns that have no weight, unless they must be kept; w shrinks with the working set.
  void drop_unused(WorkingSet<P>& working, Vector& w) const {
    const std::vector<Index> used = used_positions(working, w);
    if (static_cast<Index>(used.size()) == working.size()) return;
    working.keep(used);
    w = Vector(w(used));
  }

  /// Enters the iterate w on the working set into the history and keeps it if it is the best.
  /// \return its residual b − A w.
  Vector record(const WorkingSet<P>& working, const Vector& w) {
    const Vector r = working.residual(w);
    const double error = relative(r.norm());
    const std::vector<Index> used = used_positions(working, w);
    std::vector<Index> indices = indices_at(working.block(), used);
    SelectionStep step;
    step.size = static_cast<Index>(used.size());
    step.training_error = error;
    if (request_.validate) step.held_out_error = request_.validate(indices, w(used));
    step.seconds = stopwatch_.seconds();
    step.columns_evaluated = columns_evaluated_;
    history_.push_back(step);
    if (history_.size() == 1 || std::isnan(error_) || (error < error_ && step.size <= rules.size())) {
      error_ = error;
      best_indices_ = std::move(indices);
      best_weights_ = w(used);
    }
    return r;
  }

  void tell(Index iteration, Index iterations) const {
    supple::tell(request_.progress, "selecting components",
                 std::min(1.0, static_cast<double>(iteration) / static_cast<double>(iterations)));
  }

  /// The best iterate, and its residual as A, w and b themselves have it.
  Selection finish(WorkingSet<P>& working, Status status, Index iterations, std::string stop_reason,
                   FinalWeights weights = FinalWeights::Refitted, Signs signs = Signs::NonNegative) {
    Vector w = restore_best(working);
    if (weights == FinalWeights::Refitted) {
      NnlsSolution refitted = working.fit(signs, used_positions(working, w));
      working.polish(refitted, signs);
      if (working.residual(refitted.w).norm() <= working.residual(w).norm()) w = std::move(refitted.w);
      drop_unused(working, w);
    }
    const Vector r = working.residual(w);
    Selection selection{working.indices(), std::move(w), {}};
    SelectionReport& report = selection.report;
    report.iterations = iterations;
    report.residual = r.norm();
    report.training_error = relative(report.residual);
    report.status = final_status(status, report.training_error);
    report.kkt_residual = kkt_residual(working, selection.weights, r);
    report.columns_evaluated = columns_evaluated_;
    report.stop_reason = std::move(stop_reason);
    report.history = std::move(history_);
    report.seconds = stopwatch_.seconds();
    return selection;
  }

 private:
  // So many columns are kept evaluated at a time: 512 MB of numbers.
  Index largest_block() const {
    return std::clamp<Index>((Index{1} << 26) / std::max<Index>(1, numbers_per_column(problem_)), 64, 8192);
  }

  // A target decides what it means to have come to an end: weights fitted once more may meet it where iterates did not.
  Status final_status(Status status, double error) const {
    if (!std::isfinite(error)) return Status::NotFinite;
    if (request_.target_error == 0) return status;
    if (error <= std::max(request_.target_error, 1e-15)) return Status::Converged;
    return status == Status::Converged ? Status::Stagnated : status;
  }

  const Vector& all_norms() {
    if (all_norms_.size() == 0) {
      all_norms_ = Vector(problem_.squared_norms()).cwiseSqrt();
      for (Index j : rules.eligible()) require_norm(j, all_norms_[j]);
    }
    return all_norms_;
  }

  static void require_norm(Index j, double norm) {
    if (norm != 0) require_square_in_range("the norm of column " + std::to_string(j) + " of A", norm);
  }

  // Makes `working` hold the best iterate, ascending; what has left it meanwhile is evaluated again.
  Vector restore_best(WorkingSet<P>& working) {
    if (history_.empty()) {
      best_indices_ = rules.must_keep();
      best_weights_ = Vector::Zero(static_cast<Index>(best_indices_.size()));
    }
    std::vector<Index> order = all_positions(static_cast<Index>(best_indices_.size()));
    std::sort(order.begin(), order.end(), [&](Index k, Index l) { return best_indices_[k] < best_indices_[l]; });
    best_weights_ = Vector(best_weights_(order));
    std::sort(best_indices_.begin(), best_indices_.end());

    const std::vector<Index> present = working.indices();
    std::vector<Index> missing, positions;
    for (Index j : best_indices_)
      if (std::find(present.begin(), present.end(), j) == present.end()) missing.push_back(j);
    working.append(evaluate(missing).block);
    const std::vector<Index> all = working.indices();
    for (Index j : best_indices_) positions.push_back(std::find(all.begin(), all.end(), j) - all.begin());
    working.keep(positions);
    return best_weights_;
  }

  double kkt_residual(const WorkingSet<P>& working, const Vector& w, const Vector& r) const {
    if (w.size() == 0 || b_norm_ == 0) return 0;
    const Vector g = working.block().transpose_times(r);
    double worst = 0;
    for (Index k = 0; k < g.size(); ++k)
      if (working.gram()(k, k) > 0)
        worst = std::max(worst, (w[k] != 0 ? std::abs(g[k]) : g[k]) / std::sqrt(working.gram()(k, k)));
    return worst / b_norm_;
  }

  const P& problem_;
  const SelectionRequest& request_;
  const double b_norm_;
  const Stopwatch stopwatch_;
  Index columns_evaluated_ = 0;
  std::vector<SelectionStep> history_;
  double error_ = 1;
  Vector all_norms_;
  std::vector<Index> best_indices_;
  Vector best_weights_;
};

}  // namespace supple
