#pragma once
/// \file Steps that all mesh readers share: telling a file's kind, dropping unused nodes, counting nodes in one place.

#include <core/types.hpp>
#include <physics/mesh/mesh_numbers.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// "1 node", "2 nodes".
std::string plural(Index count, const std::string& one, const std::string& many);

/// Case does not matter.
bool has_extension(const std::filesystem::path& path, std::string_view extension);

/// The first word of a text that begins no comment.
std::string_view first_word(std::string_view bytes);

/// Nodes that lie exactly where a node before them does.
Index num_coincident_nodes(const Points& nodes);

/// The nodes that a cell names, in the order of the file; cells and numbers follow.
/// \param numbers  one a node of the file; becomes one a node that is kept.
/// \param places  becomes where these stand in the file.
template <std::size_t size>
Points keep_nodes_in_use(const std::vector<Point>& nodes, std::vector<std::array<Index, size>>& cells,
                         std::vector<std::int64_t>& numbers, NodePlaces& places) {
  std::vector<Index> new_index(nodes.size(), -1);
  for (const std::array<Index, size>& cell : cells)
    for (const Index v : cell) new_index[v] = 0;
  Index count = 0;
  for (Index& v : new_index)
    if (v == 0) v = count++;
  Points kept(count, 3);
  for (std::size_t v = 0; v < new_index.size(); ++v)
    if (new_index[v] >= 0) {
      kept.row(new_index[v]) = nodes[v].transpose();
      numbers[new_index[v]] = numbers[v];
    }
  numbers.resize(count);
  if (count < static_cast<Index>(nodes.size())) {
    places.count = static_cast<Index>(nodes.size());
    for (std::size_t v = 0; v < new_index.size(); ++v)
      if (new_index[v] >= 0) places.of_node.push_back(static_cast<Index>(v));
  }
  for (std::array<Index, size>& cell : cells)
    for (Index& v : cell) v = new_index[v];
  return kept;
}

}  // namespace supple
