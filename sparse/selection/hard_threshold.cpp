#include <sparse/selection/hard_threshold.hpp>

#include <algorithm>

namespace supple {

std::vector<Index> largest_positive(VectorIn x, Index count) {
  std::vector<Index> positions;
  for (Index i = 0; i < x.size(); ++i)
    if (x[i] > 0) positions.push_back(i);
  if (count < static_cast<Index>(positions.size())) {
    const auto before = [&](Index i, Index j) { return x[i] > x[j] || (x[i] == x[j] && i < j); };
    std::nth_element(positions.begin(), positions.begin() + count, positions.end(), before);
    positions.resize(count);
    std::sort(positions.begin(), positions.end());
  }
  return positions;
}

std::vector<Index> largest_magnitude(VectorIn x, Index count) {
  return largest_positive(x.cwiseAbs(), count);
}

std::vector<Index> best_of_groups(VectorIn x, Index groups) {
  std::vector<Index> positions;
  groups = std::min(groups, x.size());
  for (Index k = 0; k < groups; ++k) {
    const Index begin = k * x.size() / groups, end = (k + 1) * x.size() / groups;
    Index best = 0;
    if (x.segment(begin, end - begin).maxCoeff(&best) > 0) positions.push_back(begin + best);
  }
  return positions;
}

}  // namespace supple
