#pragma once
/// \file Small meshes made by rule.

#include <core/random.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <physics/mesh/triangle_mesh.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace supple::test {

/// The tet (0, e₁, e₂, e₃) · edge: volume edge³ / 6.
inline TetMesh single_tet(double edge = 1) {
  TetMesh mesh;
  mesh.nodes = Points::Zero(4, 3);
  for (int a = 0; a < 3; ++a) mesh.nodes(a + 1, a) = edge;
  mesh.cells = {{0, 1, 2, 3}};
  return mesh;
}

/// A box of nx × ny × nz cubes of size `edge` [m], each cut into six tets around its diagonal (Kuhn 1960).
/// Node (i, j, k) is number i + (nx + 1) (j + (ny + 1) k), at edge · (i, j, k).
inline TetMesh kuhn_box(Index nx, Index ny, Index nz, double edge = 0.1) {
  TetMesh mesh;
  const auto node = [&](const std::array<Index, 3>& i) { return i[0] + (nx + 1) * (i[1] + (ny + 1) * i[2]); };
  mesh.nodes.resize((nx + 1) * (ny + 1) * (nz + 1), 3);
  for (Index k = 0; k <= nz; ++k)
    for (Index j = 0; j <= ny; ++j)
      for (Index i = 0; i <= nx; ++i)
        mesh.nodes.row(node({i, j, k})) =
            edge * Eigen::RowVector3d(static_cast<double>(i), static_cast<double>(j), static_cast<double>(k));
  for (Index k = 0; k < nz; ++k)
    for (Index j = 0; j < ny; ++j)
      for (Index i = 0; i < nx; ++i) {
        std::array<int, 3> axes{0, 1, 2};
        do {  // along the axes in this order from (i, j, k) to the opposite corner
          std::array<Index, 3> corner{i, j, k};
          Tet tet{node(corner)};
          for (int step = 0; step < 3; ++step) {
            ++corner[axes[step]];
            tet[step + 1] = node(corner);
          }
          const bool odd = ((axes[0] > axes[1]) + (axes[0] > axes[2]) + (axes[1] > axes[2])) % 2 == 1;
          if (odd) std::swap(tet[2], tet[3]);
          mesh.cells.push_back(tet);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  return mesh;
}

/// Every coordinate moved by up to `amplitude` [m] either way; keep it well below the height of the tets.
template <typename Mesh>
Mesh perturbed(Mesh mesh, double amplitude, std::uint64_t seed) {
  Random random(seed);
  for (Index k = 0; k < mesh.nodes.size(); ++k) mesh.nodes.data()[k] += amplitude * (2 * random.uniform() - 1);
  return mesh;
}

/// nx × ny squares of size `edge` [m] in the plane z = 0, normals along z, all cut along the diagonal (1, 1).
/// Node (i, j) is number i + (nx + 1) j, at edge · (i, j).
inline TriangleMesh square_grid(Index nx, Index ny, double edge = 0.1) {
  TriangleMesh mesh;
  mesh.nodes.resize((nx + 1) * (ny + 1), 3);
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i)
      mesh.nodes.row(i + (nx + 1) * j) << edge * static_cast<double>(i), edge * static_cast<double>(j), 0;
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) {
      const Index v = i + (nx + 1) * j, up = v + nx + 1;
      mesh.triangles.push_back({v, v + 1, up + 1});
      mesh.triangles.push_back({v, up + 1, up});
    }
  return mesh;
}

/// ny rows of 2 nx equilateral triangles of size `edge` [m] in the plane z = 0, normals along z. Node (i, j)
/// is number i + (nx + 1) j; every other row is shifted by half an edge in x.
inline TriangleMesh equilateral_grid(Index nx, Index ny, double edge = 0.1) {
  TriangleMesh mesh = square_grid(nx, ny, edge);
  for (Index j = 0; j <= ny; ++j)
    for (Index i = 0; i <= nx; ++i)
      mesh.nodes.row(i + (nx + 1) * j) << edge * (static_cast<double>(i) + (j % 2 == 1 ? 0.5 : 0)),
          edge * std::sqrt(0.75) * static_cast<double>(j), 0;
  mesh.triangles.clear();
  for (Index j = 0; j < ny; ++j)
    for (Index i = 0; i < nx; ++i) {
      const Index v = i + (nx + 1) * j, up = v + nx + 1;
      if (j % 2 == 0) {
        mesh.triangles.push_back({v, v + 1, up});
        mesh.triangles.push_back({v + 1, up + 1, up});
      } else {
        mesh.triangles.push_back({v, v + 1, up + 1});
        mesh.triangles.push_back({v, up + 1, up});
      }
    }
  return mesh;
}

/// The octahedron with corners at ± radius on the axes, normals outward.
inline TriangleMesh octahedron(double radius = 0.1) {
  TriangleMesh mesh;
  mesh.nodes = Points::Zero(6, 3);
  for (int a = 0; a < 3; ++a) mesh.nodes(2 * a, a) = radius, mesh.nodes(2 * a + 1, a) = -radius;
  for (Index x = 0; x < 2; ++x)
    for (Index y = 2; y < 4; ++y)
      for (Index z = 4; z < 6; ++z)
        mesh.triangles.push_back((x + y + z) % 2 == 0 ? Triangle{x, y, z} : Triangle{x, z, y});
  return mesh;
}

template <typename Mesh, typename Predicate>
std::vector<Index> nodes_where(const Mesh& mesh, const Predicate& holds) {
  std::vector<Index> nodes;
  for (Index v = 0; v < mesh.num_nodes(); ++v)
    if (holds(Point(mesh.nodes.row(v)))) nodes.push_back(v);
  return nodes;
}

inline std::vector<Index> boundary_nodes(const TetMesh& mesh) {
  std::vector<Index> nodes;
  for (const Triangle& face : boundary_faces(mesh)) nodes.insert(nodes.end(), face.begin(), face.end());
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
  return nodes;
}

/// Displacements of all nodes (3 n) under x ↦ F x + t.
inline Vector affine_displacement(const Points& nodes, const Matrix3<double>& F, const Point& t = Point::Zero()) {
  const Points moved = (nodes * F.transpose()).rowwise() + t.transpose();
  const Points u = moved - nodes;
  return Eigen::Map<const Vector>(u.data(), u.size());
}

}  // namespace supple::test
