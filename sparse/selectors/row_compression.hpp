#pragma once
/// \file Compression of rows to choose on: seeded sketches of A and b, and the exact refit of what was chosen.

#include <core/parallel.hpp>
#include <core/random.hpp>
#include <core/stable_norm.hpp>
#include <sparse/selection/selection_run.hpp>
#include <sparse/selection/smallest_selection.hpp>
#include <sparse/selectors/baselines.hpp>

namespace supple {

/// Few rows that stand for all of A and b: S A on some columns, and S b.
struct CompressedRows {
  Matrix A;
  Vector b;
  std::vector<Index> columns;  ///< the numbers of A's columns in the original
  Index passes = 1;            ///< how often each of them was evaluated for that
};

/// CountSketch: every row is added, with a random sign, to a random one of `rows` rows, which keeps inner
/// products in the mean.
/// \see Clarkson & Woodruff 2013.
class CountSketch {
 public:
  /// \throws std::invalid_argument if rows < 1.
  CountSketch(Index original_rows, Index rows, std::uint64_t seed);

  Index rows() const { return rows_; }
  void apply(VectorIn x, VectorOut out) const;  ///< out = S x

 private:
  Index rows_;
  std::vector<Index> bucket_;
  Vector sign_;
};

/// Calls visit(begin, A_B) for consecutive B = columns[begin], …, as many as make 128 MB.
/// \throws InputError naming a column that is not finite, or whose square is no number.
template <FittingProblem P, typename Visit>
void visit_columns(const P& problem, const std::vector<Index>& columns, const Visit& visit) {
  const auto count = static_cast<Index>(columns.size());
  const Index width = std::max<Index>(16, (Index{1} << 24) / std::max<Index>(1, problem.rows()));
  for (Index begin = 0; begin < count; begin += width) {
    Matrix block(problem.rows(), std::min(width, count - begin));
    parallel_ranges(block.cols(), 16, [&](Index first, Index last) {
      for (Index k = first; k < last; ++k) {
        problem.column(columns[begin + k], block.col(k));
        const double norm = stable_norm(block.col(k));
        if (norm != 0)
          require_square_in_range("the norm of column " + std::to_string(columns[begin + k]) + " of A", norm);
      }
    });
    visit(begin, block);
  }
}

/// \note evaluates each of the columns once; keeps sketch.rows() · |columns| numbers.
template <FittingProblem P>
CompressedRows sketch_rows(const CountSketch& sketch, const P& problem, const std::vector<Index>& columns) {
  CompressedRows result{Matrix(sketch.rows(), static_cast<Index>(columns.size())), Vector(sketch.rows()), columns, 1};
  sketch.apply(problem.rhs(), result.b);
  visit_columns(problem, columns, [&](Index begin, const Matrix& block) {
    parallel_for(block.cols(), [&](Index k) { sketch.apply(block.col(k), result.A.col(begin + k)); });
  });
  return result;
}

/// The dominant left singular vectors of A, each scaled by the inverse of its singular value: S = σ₁ Σ⁻¹ Uᵀ,
/// so that the rows of S A are orthogonal and of norm σ₁. By a randomised range finder, in two passes over the columns.
/// At most `rows` rows, fewer if A has less rank.
/// \note 2 (rows + 10) · |columns| numbers.
/// \see Halko, Martinsson & Tropp 2011.
template <FittingProblem P>
CompressedRows whitened_rows(Index rows, std::uint64_t seed, const P& problem, const std::vector<Index>& columns);

/// Runs `select` on compressed rows of the eligible columns, then fits the weights of what it chose to all
/// rows. Where that misses a target error that it met on the compressed rows, it is asked for more, in the end for all
/// the columns that the request allows. In the history, errors of the compressed problem are NaN: they say nothing about
/// all rows.
template <typename S, FittingProblem P>
Selection select_on_rows(CompressedRows compressed, const S& select, const P& problem, const SelectionRequest& request,
                         const Stopwatch& since);

/// Chooses with `select` on a CountSketch of the rows, and fits the weights to all rows.
/// \note every candidate column is evaluated once (for a target error without a size: in each run of the
/// search); rows · m numbers are kept.
template <typename Selector>
struct Sketched {
  Selector select;
  /// Rows of the sketch; 0: 8 s, at least 256. What is needed grows with s, not with the rows of A.
  Index rows = 0;
  std::uint64_t seed = 0;
  static constexpr Signs signs = signs_of<Selector>();

  template <FittingProblem P>
  Selection operator()(const P& problem, const SelectionRequest& request) const {
    require(rows >= 0, "rows is " + std::to_string(rows) + ", expected 0 (automatic) or more");
    if (request.size == SelectionRequest::unlimited) return smallest_selection(*this, problem, request);
    const Stopwatch stopwatch;
    const SelectionRules rules(request, problem.cols(), problem.rhs());
    const Index wanted = rows > 0 ? rows : std::max<Index>(256, 8 * rules.size());
    const CountSketch sketch(problem.rows(), std::clamp<Index>(problem.rows(), 1, wanted), seed);
    return select_on_rows(sketch_rows(sketch, problem, rules.eligible()), select, problem, request, stopwatch);
  }
};

// ---------------------------------------------------------------------------------------------------------------------

/// Orthonormal columns that span those of Y.
/// \note O(rows cols²).
Matrix orthonormalized(const Matrix& Y);
/// σ₁ Σ⁻¹ Uᵀ of J = U Σ Vᵀ, for the at most `rows` singular values above 1e-10 of the largest, σ₁.
Matrix whitening(const Matrix& J, Index rows);

template <FittingProblem P>
CompressedRows whitened_rows(Index rows, std::uint64_t seed, const P& problem, const std::vector<Index>& columns) {
  const auto m = static_cast<Index>(columns.size());
  const Index width = std::min({rows + 10, problem.rows(), m});
  Random random(seed);
  Matrix Y = Matrix::Zero(problem.rows(), width);
  {
    const Matrix omega = Matrix::NullaryExpr(m, width, [&] { return random.normal(); });
    visit_columns(problem, columns, [&](Index begin, const Matrix& block) {
      parallel_ranges(Y.rows(), 512, [&](Index first, Index last) {
        Y.middleRows(first, last - first).noalias() +=
            block.middleRows(first, last - first) * omega.middleRows(begin, block.cols());
      });
    });
  }
  const Matrix Q = orthonormalized(Y);
  Matrix J(width, m);
  visit_columns(problem, columns, [&](Index begin, const Matrix& block) {
    parallel_ranges(block.cols(), 64, [&](Index first, Index last) {
      J.middleCols(begin + first, last - first).noalias() = Q.transpose() * block.middleCols(first, last - first);
    });
  });
  const Matrix S = whitening(J, rows);
  return {S * J, S * (Q.transpose() * problem.rhs()), columns, 2};
}

template <typename S, FittingProblem P>
Selection select_on_rows(CompressedRows compressed, const S& select, const P& problem, const SelectionRequest& request,
                         const Stopwatch& since) {
  constexpr Signs signs = signs_of<S>();
  const double compressing = since.seconds();
  const std::vector<Index> columns = std::move(compressed.columns);
  SelectionRun<P> run(problem, request);
  run.account(compressed.passes * static_cast<Index>(columns.size()));
  WorkingSet<P> working(problem);
  const auto fit = [&] { return working.fit(signs, all_positions(working.size())).w; };
  const auto finish = [&](Status status, Index iterations, std::string reason) {
    return run.finish(working, status, iterations, std::move(reason), FinalWeights::Refitted, signs);
  };
  if (request.warm_start.size() > 0) {  // which may be better on all rows than what follows from few
    working = run.start();
    run.record(working, fit());
    if (request.target_error > 0 && run.met(0)) return finish(Status::Converged, 0, "target error reached");
  }
  std::vector<Index> position(problem.cols(), -1);
  for (std::size_t k = 0; k < columns.size(); ++k) position[columns[k]] = static_cast<Index>(k);
  const auto original = [&](const std::vector<Index>& positions) {
    std::vector<Index> indices;
    for (Index k : positions) indices.push_back(columns[k]);
    return indices;
  };

  SelectionRequest inner = request;
  inner.candidates.clear();
  inner.warm_start = {};
  if (inner.size != SelectionRequest::unlimited) inner.size = run.rules.size();
  for (Index& j : inner.must_keep) j = position[j];
  std::vector<double> weights;
  for (Index k = 0; k < request.warm_start.size(); ++k)
    if (const Index j = position[request.warm_start.indices[k]]; j >= 0) {
      inner.warm_start.indices.push_back(j);
      weights.push_back(request.warm_start.weights[k]);
    }
  inner.warm_start.weights = Eigen::Map<const Vector>(weights.data(), static_cast<Index>(weights.size()));
  if (request.validate)
    inner.validate = [&](const std::vector<Index>& indices, VectorIn w) {
      return request.validate(original(indices), w);
    };

  const DenseProblem rows(std::move(compressed.A), std::move(compressed.b));
  Selection chosen;
  std::vector<SelectionStep> steps;  // on the compressed rows
  bool lost = true;                  // met the target on the compressed rows, but not on all
  for (int attempt = 0; lost && attempt < 5; ++attempt) {
    if (attempt == 4) inner.target_error = 0;
    const double start = run.seconds();
    chosen = select(rows, inner);
    for (SelectionStep step : chosen.report.history) {
      step.seconds += start;
      step.training_error = std::numeric_limits<double>::quiet_NaN();
      step.columns_evaluated = run.columns_evaluated();
      steps.push_back(step);
    }
    working = WorkingSet<P>(problem);
    working.append(run.evaluate(original(chosen.indices)).block);
    const double error = run.relative(run.record(working, fit()).norm());
    lost = chosen.report.status == Status::Converged && run.status_at_size() != Status::Converged;
    inner.target_error *= 0.8 * request.target_error / std::max(error, 1e-15);
    inner.warm_start = chosen;
  }
  Selection selection =
      finish(lost ? Status::Stagnated : chosen.report.status, chosen.report.iterations,
             chosen.report.stop_reason + " on the compressed rows" + (lost ? ", but not on all" : ""));
  std::vector<SelectionStep>& history = selection.report.history;
  history.insert(history.begin(), steps.begin(), steps.end());
  std::stable_sort(history.begin(), history.end(), [](const SelectionStep& first, const SelectionStep& second) {
    return first.seconds < second.seconds;
  });
  for (SelectionStep& step : history) step.seconds += compressing;
  selection.report.seconds += compressing;
  return selection;
}

static_assert(SubsetSelector<Sketched<UniformRandom>>);

}  // namespace supple
