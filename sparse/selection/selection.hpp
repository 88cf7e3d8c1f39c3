#pragma once
/// \file Request to a selector, and its answer.

#include <core/progress.hpp>
#include <core/report.hpp>
#include <core/types.hpp>

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace supple {

/// One entry of the history of a selection.
struct SelectionStep {
  Index size = 0;                                                    ///< columns in use
  double training_error = 1;                                         ///< ‖A w − b‖ / ‖b‖; NaN: not evaluated
  double held_out_error = std::numeric_limits<double>::quiet_NaN();  ///< NaN if the request has no validation
  double seconds = 0;                                                ///< since the start
  Index columns_evaluated = 0;                                       ///< since the start, repeats counted
};

/// The residual of a selection is ‖A w − b‖, computed from A, w and b themselves.
struct SelectionReport : Report {
  double training_error = 1;  ///< ‖A w − b‖ / ‖b‖; for a force fitting that is ε, Eq. 5. 0 if b = 0
  double kkt_residual = 0;  ///< max |aᵢᵀ(A w − b)| / (‖aᵢ‖ ‖b‖) over the support: 0 at the optimal weights
  double seconds = 0;
  Index columns_evaluated = 0;
  std::string stop_reason;  ///< in words, for people
  std::vector<SelectionStep> history;
};

struct Selection {
  std::vector<Index> indices;  ///< ascending
  Vector weights;              ///< one for each index; > 0, but for must-keep components, which may have 0
  SelectionReport report;

  Index size() const { return static_cast<Index>(indices.size()); }
};

/// At most `size` of the candidates. Converts from that number alone: NnHtp{}(problem, 150).
struct SelectionRequest {
  static constexpr Index unlimited = std::numeric_limits<Index>::max();

  SelectionRequest(Index largest_size) : size(largest_size) {}
  /// As few as the method needs for a relative error of at most `error`.
  static SelectionRequest to_error(double error) {
    SelectionRequest request(unlimited);
    request.target_error = error;
    return request;
  }

  Index size;                     ///< largest support s, 1 ≤ s ≤ m; unlimited: target_error decides
  double target_error = 0;        ///< stop as soon as ‖A w − b‖ ≤ target_error ‖b‖
  std::vector<Index> candidates;  ///< columns that may be chosen, beside must_keep; empty: all
  std::vector<Index> must_keep;   ///< columns that are in the answer whatever happens, if need be with weight 0
  Selection warm_start;           ///< an earlier answer to improve; what of it is no candidate is left out
  /// Held-out error of a trial selection, for the history only; called once an iteration.
  std::function<double(const std::vector<Index>& indices, VectorIn weights)> validate;
  Progress progress;
};

}  // namespace supple
