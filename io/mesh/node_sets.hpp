#pragma once
/// \file Node sets described by a rule such as "y<4%", a box, a region or a file: which to hold, to pull, to watch.

#include <physics/mesh/cell_mesh.hpp>

#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace supple {

/// Nodes on one side of a plane, or in it: an axis, one of < <= > >= =, and a coordinate, in m or with its unit, or a share
/// of the bounding box along that axis, counted from its lower end: "y<4%", "x >= 0.25", "z = 10 mm". Several make one rule
/// with "and" and "or" between, of which "and" binds more: "x=0 and y>50% or x=1". In a plane are nodes within 1e-6 of the
/// diagonal.
/// \return ascending node indices, at least one.
/// \throws InputError naming the rule if it has another form or selects no node.
std::vector<Index> select_nodes(const Points& nodes, std::string_view rule);

/// A plane across an axis: "x=50%", "z = 10 mm", as in the rules of select_nodes().
struct AxisPlane {
  int axis;
  double coordinate;  ///< [m]
};
/// \throws InputError naming the text if it has another form.
AxisPlane parse_plane(const Points& nodes, std::string_view text);

/// Nodes that at least one of the rules selects, ascending; none for no rules.
std::vector<Index> select_nodes(const Points& nodes, const std::vector<std::string>& rules);

/// Nodes in a closed box between two corners [m]: "xmin,ymin,zmin:xmax,ymax,zmax".
/// \throws InputError as above, and if a lower bound is above its upper bound.
std::vector<Index> nodes_in_box(const Points& nodes, std::string_view box);

/// Nodes of the cells of a region, given by its name or its number; or those of a group of faces, edges or nodes, by its name.
/// \throws InputError if the mesh has no such region; it lists those it has.
std::vector<Index> nodes_of_region(const TetMesh& mesh, std::string_view region);
std::vector<Index> nodes_of_region(const HexMesh& mesh, std::string_view region);
std::vector<Index> nodes_of_region(const QuadraticTetMesh& mesh, std::string_view region);

/// The regions of a cell of this tag: it, or the groups that it stands for.
template <typename Mesh>
std::vector<int> regions_of_tag(const Mesh& mesh, int tag) {
  const auto groups = mesh.region_groups.find(tag);
  return groups == mesh.region_groups.end() ? std::vector<int>{tag} : groups->second;
}
/// All regions of a mesh: tags of cells, with groups resolved.
template <typename Mesh>
std::set<int> all_regions(const Mesh& mesh) {
  std::set<int> all;
  for (const int tag : std::set<int>(mesh.region.begin(), mesh.region.end()))
    for (const int region : regions_of_tag(mesh, tag)) all.insert(region);
  return all;
}

/// Nodes whose places in the mesh's file a user has listed; those that no cell has are left out.
/// \return ascending, each once.
/// \throws InputError naming `source` if a place is not in the file, or if no cell has any of them.
std::vector<Index> nodes_at_places(const std::vector<Index>& list, Index num_nodes, const NodePlaces& places,
                                   const std::string& source);

/// Nodes from a text file that lists their places in the mesh's file: counted from 0, one a line; '#' begins a comment.
/// \return as nodes_at_places().
/// \throws InputError with the line if one is not in the file; or if the file names none that a cell has.
std::vector<Index> read_node_set(const Points& nodes, const std::filesystem::path& path, const NodePlaces& places = {});

/// Nodes with a label, from a text file with one whole number for each node of the mesh's file, in its order; '#' begins a
/// comment.
/// \throws InputError if there are not as many as nodes, one is no whole number, or no node of a cell has the label.
std::vector<Index> nodes_with_label(const Points& nodes, const std::filesystem::path& path, int label,
                                    const NodePlaces& places = {});

}  // namespace supple
