#include <core/stable_norm.hpp>
#include <sparse/selection/selection_run.hpp>

#include <cstdio>
#include <utility>

namespace supple {

namespace {

void require_columns(const char* name, const std::vector<Index>& indices, Index cols) {
  for (Index j : indices)
    require(0 <= j && j < cols,
            std::string(name) + " holds column " + std::to_string(j) + ", expected 0 to " + std::to_string(cols - 1));
}

std::string to_text(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", x);
  return text;
}

}  // namespace

void require_square_in_range(const std::string& name, double x) {
  if (std::isnan(x)) throw InputError(name + " is not a number, expected finite numbers");
  if (!(1e-140 <= x && x <= 1e140))
    throw InputError(name + " is " + to_text(x) + ", expected 0 or from 1e-140 to 1e140: scale A and b");
}

SelectionRules::SelectionRules(const SelectionRequest& request, Index cols, const Vector& b) {
  const bool unlimited = request.size == SelectionRequest::unlimited;
  require(unlimited || (1 <= request.size && request.size <= cols),
          "size is " + std::to_string(request.size) + ", expected 1 to the number of columns, " + std::to_string(cols));
  require(request.target_error >= 0 && request.target_error < std::numeric_limits<double>::infinity(),
          "target_error is " + std::to_string(request.target_error) + ", expected a number from 0 up");
  require(!unlimited || request.target_error > 0, "size is unlimited and target_error 0, expected one of them");
  require_columns("candidates", request.candidates, cols);
  require_columns("must_keep", request.must_keep, cols);
  require_columns("warm_start", request.warm_start.indices, cols);
  require_size("warm_start.weights", request.warm_start.weights.size(), request.warm_start.size());
  for (Index i = 0; i < b.size(); ++i)
    if (!std::isfinite(b[i]))
      throw InputError("b is " + std::to_string(b[i]) + " in row " + std::to_string(i) + ", expected a finite number");
  const double norm = stable_norm(b);
  if (norm != 0) require_square_in_range("the norm of b", norm);

  role_.assign(cols, request.candidates.empty() ? Role::Candidate : Role::Excluded);
  for (Index j : request.candidates) role_[j] = Role::Candidate;
  for (Index j : request.must_keep) role_[j] = Role::MustKeep;
  for (Index j = 0; j < cols; ++j) {
    if (role_[j] != Role::Excluded) eligible_.push_back(j);
    if (role_[j] == Role::MustKeep) must_keep_.push_back(j);
  }
  size_ = std::min(request.size, static_cast<Index>(eligible_.size()));
  require(static_cast<Index>(must_keep_.size()) <= size_,
          "must_keep has " + std::to_string(must_keep_.size()) +
              " columns, expected at most size = " + std::to_string(size_));

  const Selection& warm = request.warm_start;
  std::vector<Index> largest_first;  // positions in the warm start
  for (Index k = 0; k < warm.size(); ++k)
    if (role_[warm.indices[k]] == Role::Candidate && warm.weights[k] != 0) largest_first.push_back(k);
  std::stable_sort(largest_first.begin(), largest_first.end(),
                   [&](Index k, Index l) { return std::abs(warm.weights[k]) > std::abs(warm.weights[l]); });
  start_ = must_keep_;
  std::vector<char> present(cols, 0);
  for (Index k : largest_first)
    if (static_cast<Index>(start_.size()) < size_ && !std::exchange(present[warm.indices[k]], 1))
      start_.push_back(warm.indices[k]);
  std::sort(start_.begin(), start_.end());
}

std::vector<Index> SelectionRules::eligible_without(const std::vector<Index>& indices) const {
  std::vector<char> excluded(role_.size(), 0);
  for (Index j : indices) excluded[j] = 1;
  std::vector<Index> rest;
  for (Index j : eligible_)
    if (!excluded[j]) rest.push_back(j);
  return rest;
}

}  // namespace supple
