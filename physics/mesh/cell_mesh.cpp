#include <core/check.hpp>
#include <physics/mesh/cell_mesh.hpp>
#include <physics/mesh/elements.hpp>
#include <physics/mesh/equal_keys.hpp>
#include <physics/mesh/tet_mesh.hpp>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace supple {

namespace {

/// Faces of a cell: corners counter-clockwise as seen from outside, then the nodes amid their edges; and how a face is
/// cut into triangles.
template <typename Element>
struct Faces;
template <>
struct Faces<LinearTet> {
  static constexpr int num_corners = 3;
  static constexpr std::array<std::array<int, 3>, 4> of_cell{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  static constexpr std::array<std::array<int, 3>, 1> triangles{{{0, 1, 2}}};
};
template <>
struct Faces<TrilinearHex> {
  static constexpr int num_corners = 4;
  static constexpr std::array<std::array<int, 4>, 6> of_cell{
      {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {3, 7, 6, 2}, {0, 4, 7, 3}, {1, 2, 6, 5}}};
  static constexpr std::array<std::array<int, 3>, 2> triangles{{{0, 1, 2}, {0, 2, 3}}};
};
template <>
struct Faces<QuadraticTet> {
  static constexpr int num_corners = 3;
  static constexpr std::array<std::array<int, 6>, 4> of_cell{
      {{1, 2, 3, 5, 9, 8}, {0, 3, 2, 7, 9, 6}, {0, 1, 3, 4, 8, 7}, {0, 2, 1, 6, 5, 4}}};
  static constexpr std::array<std::array<int, 3>, 4> triangles{{{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}};
};

/// All faces of the cells of a mesh: number e · faces_per_cell + k is face k of cell e.
template <typename Mesh>
class CellFaces {
 public:
  using Table = Faces<ElementOf<Mesh>>;
  static constexpr Index per_cell = Table::of_cell.size();
  using Nodes = std::array<Index, Table::of_cell[0].size()>;
  using Corners = std::array<Index, Table::num_corners>;

  explicit CellFaces(const Mesh& mesh) : mesh_(mesh) {}

  Index count() const { return per_cell * mesh_.num_cells(); }
  static Index cell(Index face) { return face / per_cell; }
  Nodes nodes(Index face) const {
    Nodes result;
    const auto& table = Table::of_cell[face % per_cell];
    for (std::size_t k = 0; k < result.size(); ++k) result[k] = mesh_.cells[cell(face)][table[k]];
    return result;
  }
  Corners corners(Index face) const {
    const Nodes all = nodes(face);
    Corners result;
    std::copy_n(all.begin(), result.size(), result.begin());
    return result;
  }

  /// The cycle of corners from the smallest one to the smaller of its neighbours: what both sides of a face share.
  struct Cycle {
    Corners corners;
    bool turned;  ///< differs between the two sides
  };
  Cycle cycle(Index face) const {
    Cycle result{corners(face), false};
    Corners& c = result.corners;
    std::rotate(c.begin(), std::ranges::min_element(c), c.end());
    result.turned = c[1] > c.back();
    if (result.turned) std::reverse(c.begin() + 1, c.end());
    return result;
  }

  /// Calls visit(faces) for every set of faces with the same corners, ascending.
  template <typename Visit>
  void visit_equal_faces(const Visit& visit) const {
    std::vector<std::array<Index, 3>> keys(count());  // the smallest three corners
    std::vector<Index> largest(Table::num_corners == 4 ? count() : 0);
    for (Index face = 0; face < count(); ++face) {
      Corners sorted = corners(face);
      std::ranges::sort(sorted);
      std::copy_n(sorted.begin(), 3, keys[face].begin());
      if constexpr (Table::num_corners == 4) largest[face] = sorted[3];
    }
    std::vector<Index> same;
    visit_equal(keys, mesh_.num_nodes(), [&](std::span<const Index> faces) {
      if constexpr (Table::num_corners == 3) {
        visit(faces);
      } else {
        same.assign(faces.begin(), faces.end());
        std::ranges::stable_sort(same, {}, [&](Index face) { return largest[face]; });
        for (auto begin = same.begin(); begin != same.end();) {
          const auto end =
              std::find_if(begin, same.end(), [&](Index face) { return largest[face] != largest[*begin]; });
          visit(std::span<const Index>(begin, end));
          begin = end;
        }
      }
    });
  }

 private:
  const Mesh& mesh_;
};

/// Rest positions relative to node 0, so that where the object lies costs no digits [m].
template <typename Element>
ShapeGradients<Element> relative_positions(const CellMesh<Element::num_nodes>& mesh, Index e) {
  ShapeGradients<Element> X;
  const auto& cell = mesh.cells[e];
  for (int a = 0; a < Element::num_nodes; ++a) X.row(a) = mesh.nodes.row(cell[a]) - mesh.nodes.row(cell[0]);
  return X;
}

template <typename Element>
Matrix3<double> jacobian(const ShapeGradients<Element>& X, const std::array<double, 3>& xi) {
  return X.transpose() * Element::shape_gradients(Point(xi[0], xi[1], xi[2]));
}

template <typename Element>
double volume(const CellMesh<Element::num_nodes>& mesh, Index e) {
  const ShapeGradients<Element> X = relative_positions<Element>(mesh, e);
  double sum = 0;
  for (const QuadraturePoint& at : Element::mass_points) sum += at.weight * jacobian<Element>(X, at.xi).determinant();
  return sum;
}

/// Names of cells and nodes in messages.
template <typename Element>
struct CellNames {
  const MeshNumbers& numbers;

  static std::string number(const std::vector<std::int64_t>& numbers, Index k) {
    return std::to_string(numbers.empty() ? k : numbers[k]);
  }
  std::string cell(Index e) const { return std::string(Element::name) + " " + number(numbers.cell, e); }
  std::string node(Index v) const { return "node " + number(numbers.node, v); }
};

/// \throws std::invalid_argument unless the tet is positively oriented, by more than rounding.
void check_shape(const TetMesh& mesh, Index e, const CellNames<LinearTet>& names) {
  const int orientation = tet_orientation(mesh, e);
  const double volume = tet_volume(mesh, e);
  if (!std::isfinite(volume) || (orientation == 1 && !(volume > 0)))
    throw std::invalid_argument("the volume of " + names.cell(e) + " is beyond the range of numbers");
  if (orientation == 0) throw std::invalid_argument(names.cell(e) + " has zero volume: its nodes lie in a plane");
  if (orientation < 0) throw std::invalid_argument(names.cell(e) + " is reversed: its volume is negative");
}

/// \throws std::invalid_argument unless det J > 0, by more than rounding, wherever it is needed.
template <typename Element>
void check_shape(const CellMesh<Element::num_nodes>& mesh, Index e, const CellNames<Element>& names) {
  const ShapeGradients<Element> X = relative_positions<Element>(mesh, e);
  const auto check = [&](const std::array<double, 3>& xi, const auto& place) {
    const Matrix3<double> J = jacobian<Element>(X, xi);
    const double det = J.determinant(), size = J.col(0).norm() * J.col(1).norm() * J.col(2).norm();
    if (!std::isfinite(det) || !std::isfinite(size))
      throw std::invalid_argument("the volume of " + names.cell(e) + " is beyond the range of numbers");
    if (det > 16 * std::numeric_limits<double>::epsilon() * size) return;
    const double whole = volume<Element>(mesh, e);
    throw std::invalid_argument(names.cell(e) +
                                (whole > 0 ? " is tangled: det J is " : " is flat or reversed: det J is ") +
                                std::to_string(det) + " m^3 at " + place() + ", expected > 0");
  };
  const auto check_rule = [&](std::span<const QuadraturePoint> rule, const char* name) {
    for (std::size_t g = 0; g < rule.size(); ++g) check(rule[g].xi, [&] { return name + std::to_string(g); });
  };
  if constexpr (std::same_as<Element, TrilinearHex>)
    for (int a = 0; a < Element::num_nodes; ++a)
      check(Element::nodes[a], [&] { return "its corner, " + names.node(mesh.cells[e][a]); });
  check_rule(Element::gauss_points, "Gauss point ");
  check_rule(Element::mass_points, "mass point ");
}

template <typename Mesh>
void check_cells(const Mesh& mesh, const MeshNumbers& numbers) {
  using Element = ElementOf<Mesh>;
  const CellNames<Element> names{numbers};
  const auto& cells = mesh.cells;
  require(mesh.num_cells() > 0, "mesh has no cells");
  if (!mesh.region.empty()) require_size("mesh.region", static_cast<Index>(mesh.region.size()), mesh.num_cells());
  std::vector<char> used(mesh.num_nodes(), false);
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    const auto& cell = cells[e];
    for (auto at = cell.begin(); at != cell.end(); ++at) {
      if (*at < 0 || *at >= mesh.num_nodes())
        throw std::invalid_argument(names.cell(e) + " names node " + std::to_string(*at) + ", which does not exist");
      if (std::find(cell.begin(), at, *at) != at)
        throw std::invalid_argument(names.cell(e) + " names " + names.node(*at) + " twice");
      used[*at] = true;
    }
  }
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    if (!used[v]) throw std::invalid_argument(names.node(v) + " belongs to no " + std::string(Element::name));
    if (!mesh.nodes.row(v).allFinite())
      throw std::invalid_argument(names.node(v) + " has a coordinate that is not finite");
  }
  for (Index e = 0; e < mesh.num_cells(); ++e) check_shape(mesh, e, names);

  const CellFaces faces(mesh);
  constexpr bool all_nodes_are_corners = Faces<Element>::of_cell[0].size() == Faces<Element>::num_corners;
  faces.visit_equal_faces([&](std::span<const Index> same) {
    if (same.size() == 1) return;
    const auto one = faces.cycle(same[0]), other = faces.cycle(same[1]);
    const auto nodes_of = [](const auto& nodes) { return std::set<Index>(nodes.begin(), nodes.end()); };
    const bool is_pair = same.size() == 2 && one.corners == other.corners && one.turned != other.turned;
    if (is_pair && (all_nodes_are_corners || nodes_of(faces.nodes(same[0])) == nodes_of(faces.nodes(same[1])))) return;
    std::string corners;
    for (const Index v : faces.corners(same[0]))
      corners += (corners.empty() ? "" : ", ") + names.number(numbers.node, v);
    const Index first = faces.cell(same[0]), second = faces.cell(same[1]);
    const std::string pair = names.cell(first) + " and " + names.cell(second), face = "face (" + corners + ")";
    if (is_pair) throw std::invalid_argument(pair + " have different nodes amid the edges of their common " + face);
    if (nodes_of(cells[first]) == nodes_of(cells[second])) throw std::invalid_argument(pair + " have the same nodes");
    if (one.corners != other.corners || one.turned == other.turned)
      throw std::invalid_argument(pair + " overlap: they do not lie on either side of their common " + face +
                                  ", so the mesh is tangled");
    throw std::invalid_argument(pair + " share their " + face + " with " + names.cell(faces.cell(same[2])) +
                                ": at most two cells can meet at a face");
  });
}

template <typename Mesh>
std::vector<Triangle> cut_boundary(const Mesh& mesh) {
  const CellFaces faces(mesh);
  std::vector<char> outside(faces.count(), false);
  faces.visit_equal_faces([&](std::span<const Index> same) { outside[same[0]] = same.size() == 1; });
  std::vector<Triangle> result;
  for (Index face = 0; face < faces.count(); ++face) {
    if (!outside[face]) continue;
    const auto nodes = faces.nodes(face);
    for (const auto& [a, b, c] : Faces<ElementOf<Mesh>>::triangles) result.push_back({nodes[a], nodes[b], nodes[c]});
  }
  return result;
}

template <typename Mesh>
NodeComponents components(const Mesh& mesh) {
  const auto& cells = mesh.cells;
  constexpr Index size = Mesh::nodes_per_cell;
  static_assert(sizeof(cells[0]) == size * sizeof(Index));
  return connected_components({cells.empty() ? nullptr : cells.front().data(), size * cells.size()}, size,
                              mesh.num_nodes());
}

}  // namespace

BoundingBox bounding_box(const Points& nodes) {
  return {nodes.colwise().minCoeff().transpose(), nodes.colwise().maxCoeff().transpose()};
}

HexMesh hex_box(Index nx, Index ny, Index nz, const Point& size) {
  require(nx > 0 && ny > 0 && nz > 0, "a box needs at least one cell along each axis");
  require((size.array() > 0).all(), "a box needs sides > 0");
  HexMesh mesh;
  const auto node = [&](Index i, Index j, Index k) { return i + (nx + 1) * (j + (ny + 1) * k); };
  mesh.nodes.resize(node(0, 0, nz + 1), 3);
  for (Index k = 0; k <= nz; ++k)
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i)
        mesh.nodes.row(node(i, j, k)) << size[0] * static_cast<double>(i) / static_cast<double>(nx),
            size[1] * static_cast<double>(j) / static_cast<double>(ny),
            size[2] * static_cast<double>(k) / static_cast<double>(nz);
  mesh.cells.reserve(nx * ny * nz);
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        std::array<Index, 8> cell;
        for (int a = 0; a < 8; ++a) {
          const auto& corner = TrilinearHex::corners[a];
          cell[a] = node(i + corner[0], j + corner[1], k + corner[2]);
        }
        mesh.cells.push_back(cell);
      }
  return mesh;
}

QuadraticTetMesh quadratic_mesh(const TetMesh& mesh) {
  constexpr Index edges_per_tet = QuadraticTet::edges.size();
  QuadraticTetMesh result;
  result.cells.resize(mesh.cells.size());
  result.region = mesh.region;
  result.region_names = mesh.region_names;
  result.region_groups = mesh.region_groups;
  std::vector<std::array<Index, 2>> edges(edges_per_tet * mesh.cells.size());
  for (Index id = 0; id < static_cast<Index>(edges.size()); ++id) {
    const auto [a, b] = QuadraticTet::edges[id % edges_per_tet];
    const Tet& tet = mesh.cells[id / edges_per_tet];
    edges[id] = {std::min(tet[a], tet[b]), std::max(tet[a], tet[b])};
  }
  std::vector<std::array<Index, 2>> distinct;
  visit_equal(edges, mesh.num_nodes(), [&](std::span<const Index> ids) {
    for (const Index id : ids)
      result.cells[id / edges_per_tet][4 + id % edges_per_tet] = mesh.num_nodes() + static_cast<Index>(distinct.size());
    distinct.push_back(edges[ids[0]]);
  });
  for (std::size_t e = 0; e < mesh.cells.size(); ++e) std::ranges::copy(mesh.cells[e], result.cells[e].begin());
  result.nodes.resize(mesh.num_nodes() + static_cast<Index>(distinct.size()), 3);
  result.nodes.topRows(mesh.num_nodes()) = mesh.nodes;
  for (std::size_t k = 0; k < distinct.size(); ++k)
    result.nodes.row(mesh.num_nodes() + static_cast<Index>(k)) =
        (mesh.nodes.row(distinct[k][0]) + mesh.nodes.row(distinct[k][1])) / 2;
  for (const auto& [name, group] : mesh.node_groups) {
    NodeGroup& own = result.node_groups[name] = group;
    std::vector<std::array<Index, 2>> sides;  // of the faces
    for (const auto& [a, b, c, d] : group.faces) {
      const std::array<std::array<Index, 2>, 3> of_face{{{a, b}, {a, c}, {b, c}}};
      sides.insert(sides.end(), of_face.begin(), of_face.end());
    }
    std::ranges::sort(sides);
    const auto has = [&group = group](Index v) { return std::ranges::binary_search(group.nodes, v); };
    for (std::size_t k = 0; k < distinct.size(); ++k) {
      const bool is_in = own.faces.empty() ? has(distinct[k][0]) && has(distinct[k][1])
                                           : std::ranges::binary_search(sides, distinct[k]);
      if (is_in) own.nodes.push_back(mesh.num_nodes() + static_cast<Index>(k));
    }
  }
  return result;
}

double cell_volume(const TetMesh& mesh, Index e) {
  return tet_volume(mesh, e);
}
double cell_volume(const HexMesh& mesh, Index e) {
  return volume<TrilinearHex>(mesh, e);
}
double cell_volume(const QuadraticTetMesh& mesh, Index e) {
  return volume<QuadraticTet>(mesh, e);
}

Tet reversed(const Tet& c) {
  return {c[0], c[1], c[3], c[2]};
}
std::array<Index, 8> reversed(const std::array<Index, 8>& c) {
  return {c[4], c[5], c[6], c[7], c[0], c[1], c[2], c[3]};
}
std::array<Index, 10> reversed(const std::array<Index, 10>& c) {
  return {c[0], c[1], c[3], c[2], c[4], c[8], c[7], c[6], c[5], c[9]};
}

double scaled_jacobian(const HexMesh& mesh, Index e) {
  const auto X = relative_positions<TrilinearHex>(mesh, e);
  double least = 1;
  for (const auto& corner : TrilinearHex::nodes) {
    const Matrix3<double> J = jacobian<TrilinearHex>(X, corner);
    const double size = J.col(0).norm() * J.col(1).norm() * J.col(2).norm();
    least = std::min(least, size > 0 ? J.determinant() / size : 0);
  }
  return least;
}
double radius_ratio(const QuadraticTetMesh& mesh, Index e) {
  const auto& cell = mesh.cells[e];
  return radius_ratio(mesh.nodes, Tet{cell[0], cell[1], cell[2], cell[3]});
}

void check_mesh(const TetMesh& mesh, const MeshNumbers& numbers) {
  check_cells(mesh, numbers);
}
void check_mesh(const HexMesh& mesh, const MeshNumbers& numbers) {
  check_cells(mesh, numbers);
}
void check_mesh(const QuadraticTetMesh& mesh, const MeshNumbers& numbers) {
  check_cells(mesh, numbers);
}

std::vector<Triangle> boundary_faces(const TetMesh& mesh) {
  return cut_boundary(mesh);
}
std::vector<Triangle> boundary_faces(const HexMesh& mesh) {
  return cut_boundary(mesh);
}
std::vector<Triangle> boundary_faces(const QuadraticTetMesh& mesh) {
  return cut_boundary(mesh);
}

Hinges boundary_hinges(const TetMesh& mesh) {
  return surface_hinges(boundary_faces(mesh), mesh.num_nodes());
}
Hinges boundary_hinges(const HexMesh& mesh) {
  return surface_hinges(boundary_faces(mesh), mesh.num_nodes());
}
Hinges boundary_hinges(const QuadraticTetMesh& mesh) {
  return surface_hinges(boundary_faces(mesh), mesh.num_nodes());
}

NodeComponents connected_components(const TetMesh& mesh) {
  return components(mesh);
}
NodeComponents connected_components(const HexMesh& mesh) {
  return components(mesh);
}
NodeComponents connected_components(const QuadraticTetMesh& mesh) {
  return components(mesh);
}

}  // namespace supple
