#pragma once
/// \file Search for edges and faces that elements share: equal tuples of node numbers.

#include <core/types.hpp>

#include <algorithm>
#include <numeric>
#include <span>
#include <vector>

namespace supple {

/// Calls visit(ids) for every set of equal keys, in order of keys; ids ascend. A key is two or three
/// ascending node numbers below `num_nodes`: buckets by the first leave little to sort.
template <typename Key, typename Visit>
void visit_equal(const std::vector<Key>& keys, Index num_nodes, const Visit& visit) {
  std::vector<Index> bucket_end(num_nodes + 1, 0);
  for (const Key& key : keys) ++bucket_end[key[0] + 1];
  std::partial_sum(bucket_end.begin(), bucket_end.end(), bucket_end.begin());
  struct Item {
    Index rest, id;  // the rest of the key as one number
    bool operator<(const Item& other) const { return rest != other.rest ? rest < other.rest : id < other.id; }
  };
  std::vector<Item> items(keys.size());
  for (Index id = 0; id < static_cast<Index>(keys.size()); ++id) {
    const Key& key = keys[id];
    items[bucket_end[key[0]]++] = {key.size() == 3 ? key[1] * num_nodes + key.back() : key.back(), id};
  }
  std::vector<Index> ids;
  for (Index bucket = 0, begin = 0; bucket < num_nodes; begin = bucket_end[bucket++]) {
    const Index end = bucket_end[bucket];
    std::sort(items.begin() + begin, items.begin() + end);
    for (Index k = begin; k < end;) {
      const Index rest = items[k].rest;
      for (ids.clear(); k < end && items[k].rest == rest; ++k) ids.push_back(items[k].id);
      visit(std::span<const Index>(ids));
    }
  }
}

}  // namespace supple
