#pragma once
/// \file Readers of the mesh formats behind read_solid_mesh, one a format: each turns a text into a FileMesh.

#include <io/mesh/mesh_notes.hpp>
#include <io/text/cursor.hpp>
#include <physics/mesh/cell_mesh.hpp>

#include <optional>
#include <span>
#include <unordered_map>

namespace supple {

/// A mesh as a file tells it: indices are in range, nothing else is certain.
struct FileMesh {
  std::string format;
  std::vector<Point> nodes;
  std::vector<Tet> tets;                        ///< the corners of tets of any order
  std::vector<std::array<Index, 6>> mid_edges;  ///< of the tets of second order, in turn; as QuadraticTet has them
  std::vector<std::array<Index, 8>> hexahedra;  ///< as TrilinearHex has them
  std::vector<int> region;                      ///< one a tet or hexahedron, in order of the file, or empty
  std::map<int, std::string> region_names;
  std::map<int, std::vector<int>> region_groups;  ///< see CellMesh
  NodeGroups node_groups;                         ///< of faces, edges and nodes; their nodes in any order
  std::map<Index, std::uint8_t> held;             ///< axes along which the file holds nodes, see HeldAxes
  std::vector<double>
      attribute;  ///< one a cell, or empty: what tells the regions where a format has real numbers for it
  MeshNumbers numbers;
  std::map<int, FileMaterial> materials;
  std::vector<std::string> warnings;

  Index num_higher = 0;                      ///< tets of order three or more, of which only the corners were taken
  Index num_lower = 0;                       ///< cells of lower dimension, left out
  std::map<std::string, Index> other_solid;  ///< prisms and the like, which are refused, by kind

  /// Tets and hexahedra.
  Index num_cells() const { return static_cast<Index>(tets.size() + hexahedra.size()); }
  /// \param cell  its corners, or its ten nodes as QuadraticTet has them.
  void add_tet(std::span<const Index> cell);
  void add_hexahedron(std::span<const Index> cell);
};

/// Puts the mid-edge nodes in the order of QuadraticTet where a format leaves theirs open: for all tets the one that
/// brings each next to the middle of its edge. \throws InputError if there is none.
void order_mid_edges(FileMesh& mesh, const Cursor& in);

void read_gmsh(Cursor& in, FileMesh& mesh);
void read_medit(Cursor& in, FileMesh& mesh);
void read_tetgen(Cursor& node_file, Cursor& ele_file, FileMesh& mesh);
void read_vega(Cursor& in, FileMesh& mesh);    ///< \pre the text is one of with_includes()
void read_abaqus(Cursor& in, FileMesh& mesh);  ///< \pre the text is one of with_includes()
/// The text of a file, and those that its lines *INCLUDE name, in their place, relative to the file: "*INCLUDE name" of VegaFEM,
/// "*INCLUDE, INPUT=name" of Abaqus, in any case.
std::string with_includes(const std::filesystem::path& path, std::string_view text);
void read_legacy_vtk(Cursor& in, FileMesh& mesh);
void read_vtu(const Cursor& in, FileMesh& mesh);

/// Index of the node that a file calls by `number`, where nodes are numbered in turn from `first`.
Index node_at(const Cursor& in, std::int64_t number, std::int64_t first, Index num_nodes);

/// Cells as both VTK formats list them: cell c names the nodes connectivity[offsets[c] … offsets[c + 1]),
/// which count from `first_node` of the mesh.
struct VtkCells {
  std::vector<std::int64_t> offsets, connectivity, types;
  std::vector<double> region;  ///< one a cell, or empty
};
void add_vtk_cells(const VtkCells& cells, Index first_node, const Cursor& in, FileMesh& mesh);

/// The tag of cells that are in all of these groups: that of the group, or one of their own.
/// \param groups  ascending, each once, at least one.
int tag_of_groups(FileMesh& mesh, const std::vector<int>& groups);

/// Makes regions of attributes: whole numbers are tags; others get tags from 1, ascending, and their value as name.
void make_regions_of_attributes(FileMesh& mesh);

/// Whether a cell array of that name tells regions.
bool is_region_array(std::string_view name);

/// Finds nodes by the numbers of a file that need neither begin at 1 nor be in order.
class NumberTable {
 public:
  /// \throws InputError at the cursor if a number occurs twice.
  NumberTable(const std::vector<std::int64_t>& numbers, const Cursor& in);
  Index find(std::int64_t number, const Cursor& in) const;
  std::optional<Index> lookup(std::int64_t number) const;  ///< none for a number that no node has

 private:
  std::int64_t first_ = 0, last_ = -1;  // numbers in turn need no table
  std::unordered_map<std::int64_t, Index> table_;
};

}  // namespace supple
