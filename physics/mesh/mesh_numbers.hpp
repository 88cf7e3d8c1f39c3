#pragma once
/// \file Numbers by which messages and users call the parts of a mesh.

#include <core/types.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace supple {

/// The numbers that a file gives to nodes and elements, by which messages call them. Empty: by index. Cells are tets,
/// hexahedra and the like.
struct MeshNumbers {
  std::vector<std::int64_t> node = {}, cell = {}, triangle = {};
};

/// The corners of a face, ascending; the last one of a triangle is −1.
using FaceCorners = std::array<Index, 4>;
template <typename Corners>
FaceCorners face_corners(const Corners& corners) {
  FaceCorners result{0, 0, 0, -1};
  std::ranges::copy(corners, result.begin());
  std::ranges::sort(result.begin(), result.begin() + static_cast<std::ptrdiff_t>(std::size(corners)));
  return result;
}

/// A group of faces, edges or nodes.
struct NodeGroup {
  std::vector<Index> nodes = {};        ///< ascending
  std::vector<FaceCorners> faces = {};  ///< ascending; none where the group is not of faces: then all between its nodes

  bool operator==(const NodeGroup&) const = default;
};
/// Those that a file names.
using NodeGroups = std::map<std::string, NodeGroup>;

/// Where the nodes of a mesh stand in the list of the file that it was read from. The two differ where the file lists nodes
/// that no cell has, which are dropped. Users, and the files that they write, call nodes by these places, from 0.
struct NodePlaces {
  std::vector<Index> of_node = {};  ///< ascending, one a node; empty: a node's index is its place
  Index count = 0;                  ///< nodes of the file, where `of_node` is not empty

  Index num_places(Index num_nodes) const { return of_node.empty() ? num_nodes : count; }
  Index place(Index node) const { return of_node.empty() ? node : of_node[static_cast<std::size_t>(node)]; }
  /// The node in a place; −1 if no cell has it.
  Index node(Index place) const {
    if (of_node.empty()) return place;
    const auto at = std::ranges::lower_bound(of_node, place);
    return at == of_node.end() || *at != place ? -1 : at - of_node.begin();
  }
  bool operator==(const NodePlaces&) const = default;
};

}  // namespace supple
