#include <core/check.hpp>
#include <physics/mesh/equal_keys.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <string>

namespace supple {

namespace {

using Edge = std::array<Index, 2>;

Index from_node(const std::vector<Triangle>& triangles, Index side) {
  return triangles[side / 3][side % 3];
}
Index to_node(const std::vector<Triangle>& triangles, Index side) {
  return triangles[side / 3][(side + 1) % 3];
}

/// Calls visit(sides) for every edge, in order of its nodes.
template <typename Visit>
void visit_edges(const std::vector<Triangle>& triangles, Index num_nodes, const Visit& visit) {
  std::vector<Edge> edges(3 * triangles.size());
  for (Index side = 0; side < static_cast<Index>(edges.size()); ++side) {
    const Index from = from_node(triangles, side), to = to_node(triangles, side);
    edges[side] = {std::min(from, to), std::max(from, to)};
  }
  visit_equal(edges, num_nodes, visit);
}

/// How messages call the parts of a mesh.
struct Names {
  const MeshNumbers& numbers;

  static std::string number(const std::vector<std::int64_t>& of, Index k) {
    return std::to_string(of.empty() ? k : of[k]);
  }
  std::string node(Index v) const { return "node " + number(numbers.node, v); }
  std::string triangle(Index t) const { return "triangle " + number(numbers.triangle, t); }
  std::string edge(const TriangleMesh& mesh, Index side) const {
    const Index from = from_node(mesh.triangles, side), to = to_node(mesh.triangles, side);
    return "edge (" + number(numbers.node, std::min(from, to)) + ", " + number(numbers.node, std::max(from, to)) + ")";
  }
};

/// The root of a union-find forest, with path halving.
Index root_of(std::vector<Index>& parent, Index v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

void unite(std::vector<Index>& parent, Index a, Index b) {
  const Index r = root_of(parent, a), s = root_of(parent, b);
  parent[std::max(r, s)] = std::min(r, s);
}

struct TriangleEdges {
  Point ab, ac;
  TriangleEdges(const TriangleMesh& mesh, Index t) {
    const Triangle& triangle = mesh.triangles[t];
    ab = (mesh.nodes.row(triangle[1]) - mesh.nodes.row(triangle[0])).transpose();
    ac = (mesh.nodes.row(triangle[2]) - mesh.nodes.row(triangle[0])).transpose();
  }
  /// Whether rounding may account for all of the normal: the corners lie in a line.
  bool is_flat() const {
    const Point n = ab.cross(ac), b = ab.cwiseAbs(), c = ac.cwiseAbs();
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      if (std::abs(n[i]) > 4 * std::numeric_limits<double>::epsilon() * (b[j] * c[k] + b[k] * c[j])) return false;
    }
    return true;
  }
};

void check_triangles(const TriangleMesh& mesh, const Names& names) {
  std::vector<char> used(mesh.num_nodes(), false);
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    for (int a = 0; a < 3; ++a) {
      const Index v = triangle[a];
      if (v < 0 || v >= mesh.num_nodes())
        throw std::invalid_argument(names.triangle(t) + " names node " + std::to_string(v) + ", which does not exist");
      if (std::find(triangle.begin(), triangle.begin() + a, v) != triangle.begin() + a)
        throw std::invalid_argument(names.triangle(t) + " names " + names.node(v) + " twice");
      used[v] = true;
    }
  }
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    if (!used[v]) throw std::invalid_argument(names.node(v) + " belongs to no triangle");
    if (!mesh.nodes.row(v).allFinite())
      throw std::invalid_argument(names.node(v) + " has a coordinate that is not finite");
  }
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const double area = triangle_area(mesh, t);
    const bool is_flat = TriangleEdges(mesh, t).is_flat();
    if (!std::isfinite(area) || (!is_flat && !(area > 0)))
      throw std::invalid_argument("the area of " + names.triangle(t) + " is beyond the range of numbers");
    if (is_flat) throw std::invalid_argument(names.triangle(t) + " has zero area: its nodes lie in a line");
  }
}

void check_no_triangle_repeats(const TriangleMesh& mesh, const Names& names) {
  std::vector<Triangle> keys = mesh.triangles;
  for (Triangle& key : keys) std::sort(key.begin(), key.end());
  visit_equal(keys, mesh.num_nodes(), [&](std::span<const Index> same) {
    if (same.size() > 1)
      throw std::invalid_argument(names.triangle(same[0]) + " and " + names.triangle(same[1]) +
                                  " have the same three nodes");
  });
}

void check_edges(const TriangleMesh& mesh, const Names& names) {
  visit_edges(mesh.triangles, mesh.num_nodes(), [&](std::span<const Index> sides) {
    const auto triangle = [&](Index k) { return names.triangle(sides[k] / 3); };
    if (sides.size() > 2)
      throw std::invalid_argument(triangle(0) + ", " + triangle(1) + " and " + triangle(2) + " share their " +
                                  names.edge(mesh, sides[0]) + ": at most two triangles can meet at an edge");
    if (sides.size() == 2 && from_node(mesh.triangles, sides[0]) == from_node(mesh.triangles, sides[1]))
      throw std::invalid_argument(triangle(0) + " and " + triangle(1) + " run along their common " +
                                  names.edge(mesh, sides[0]) + " in the same direction: one of them is turned over");
  });
}

}  // namespace

double triangle_area(const TriangleMesh& mesh, Index t) {
  const TriangleEdges edges(mesh, t);
  return edges.ab.cross(edges.ac).norm() / 2;
}

double radius_ratio(const TriangleMesh& mesh, Index t) {
  const TriangleEdges edges(mesh, t);
  const double a = edges.ab.norm(), b = edges.ac.norm(), c = (edges.ac - edges.ab).norm();
  const double area = edges.ab.cross(edges.ac).norm() / 2;
  if (!(area > 0)) return 0;
  return 2 * (2 * area / (a + b + c)) * (4 * area / (a * b * c));
}

void check_mesh(const TriangleMesh& mesh, const MeshNumbers& numbers) {
  const Names names{numbers};
  require(mesh.num_triangles() > 0, "mesh has no triangles");
  check_triangles(mesh, names);
  check_no_triangle_repeats(mesh, names);
  check_edges(mesh, names);
}

Index orient_consistently(TriangleMesh& mesh, const MeshNumbers& numbers) {
  const std::vector<Index> neighbour = neighbour_sides(mesh);
  enum : signed char { unseen = 0, kept = 1, turned = -1 };
  std::vector<signed char> state(mesh.triangles.size(), unseen);
  std::vector<Index> piece;  // its triangles, in the order in which a walk through edges meets them
  Index num_turned = 0;
  for (Index first = 0; first < mesh.num_triangles(); ++first) {
    if (state[first] != unseen) continue;
    state[first] = kept;
    piece = {first};
    for (std::size_t next = 0; next < piece.size(); ++next)
      for (Index side = 3 * piece[next]; side < 3 * piece[next] + 3; ++side) {
        const Index across = neighbour[side];
        if (across < 0) continue;
        const bool same_direction = from_node(mesh.triangles, side) == from_node(mesh.triangles, across);
        const auto expected = static_cast<signed char>(same_direction ? -state[side / 3] : state[side / 3]);
        if (state[across / 3] == unseen) {
          state[across / 3] = expected;
          piece.push_back(across / 3);
        } else if (state[across / 3] != expected) {
          const Names names{numbers};
          throw std::invalid_argument(
              "the surface has only one side, like a Möbius strip, so its triangles "
              "cannot be oriented: this shows at " +
              names.edge(mesh, side) + " between " + names.triangle(std::min(side, across) / 3) + " and " +
              names.triangle(std::max(side, across) / 3));
        }
      }
    const auto count = std::count_if(piece.begin(), piece.end(), [&](Index t) { return state[t] == turned; });
    const signed char smaller = 2 * count > static_cast<std::ptrdiff_t>(piece.size()) ? kept : turned;
    for (const Index t : piece)
      if (state[t] == smaller) {
        std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
        ++num_turned;
      }
  }
  return num_turned;
}

std::vector<Index> neighbour_sides(const TriangleMesh& mesh) {
  std::vector<Index> neighbour(3 * mesh.triangles.size(), -1);
  visit_edges(mesh.triangles, mesh.num_nodes(), [&](std::span<const Index> sides) {
    if (sides.size() != 2 || sides[0] / 3 == sides[1] / 3) return;
    neighbour[sides[0]] = sides[1];
    neighbour[sides[1]] = sides[0];
  });
  return neighbour;
}

std::vector<Flap> interior_edges(const TriangleMesh& mesh) {
  const std::vector<Index> neighbour = neighbour_sides(mesh);
  std::vector<Flap> flaps;
  for (Index side = 0; side < static_cast<Index>(neighbour.size()); ++side)
    if (const Index across = neighbour[side]; across > side) {
      const auto opposite = [&](Index s) { return mesh.triangles[s / 3][(s + 2) % 3]; };
      flaps.push_back(
          {{from_node(mesh.triangles, side), to_node(mesh.triangles, side), opposite(side), opposite(across)},
           {side / 3, across / 3}});
    }
  return flaps;
}

std::vector<Edge> boundary_edges(const TriangleMesh& mesh) {
  const std::vector<Index> neighbour = neighbour_sides(mesh);
  std::vector<Edge> edges;
  for (Index side = 0; side < static_cast<Index>(neighbour.size()); ++side)
    if (neighbour[side] < 0) edges.push_back({from_node(mesh.triangles, side), to_node(mesh.triangles, side)});
  return edges;
}

Hinges surface_hinges(const std::vector<Triangle>& triangles, Index num_nodes) {
  Hinges hinges;
  std::vector<Index> fan(3 * triangles.size(), 0);  // of corner a of triangle t
  std::iota(fan.begin(), fan.end(), Index{0});
  std::vector<char> on_hinge(num_nodes, false);
  const auto corner_at = [&](Index side, Index node) {
    return from_node(triangles, side) == node ? side : side - side % 3 + (side + 1) % 3;
  };
  visit_edges(triangles, num_nodes, [&](std::span<const Index> sides) {
    const Edge ends{from_node(triangles, sides[0]), to_node(triangles, sides[0])};
    if (sides.size() > 2) {
      ++hinges.edges;
      for (const Index node : ends) on_hinge[node] = true;
    } else if (sides.size() == 2) {
      for (const Index node : ends) unite(fan, corner_at(sides[0], node), corner_at(sides[1], node));
    }
  });
  std::vector<Index> num_fans(num_nodes, 0);
  for (Index corner = 0; corner < static_cast<Index>(fan.size()); ++corner)
    if (root_of(fan, corner) == corner) ++num_fans[triangles[corner / 3][corner % 3]];
  for (Index v = 0; v < num_nodes; ++v) hinges.nodes += num_fans[v] > 1 && !on_hinge[v];
  return hinges;
}

NodeComponents connected_components(const TriangleMesh& mesh) {
  static_assert(sizeof(Triangle) == 3 * sizeof(Index));
  return connected_components(
      {mesh.triangles.empty() ? nullptr : mesh.triangles.front().data(), 3 * mesh.triangles.size()}, 3,
      mesh.num_nodes());
}

}  // namespace supple
