#include <io/builtin/builtin_spec.hpp>
#include <io/builtin/builtin_surfaces.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace supple {
namespace {

const double row_height = std::sqrt(0.75);  // of equilateral triangles of edge 1

/// Triangles between two rows of nodes, from their first to their last ones: the row whose next node comes
/// first goes on.
template <typename Place>
void zip_rows(Index lower, Index num_lower, Index upper, Index num_upper, const Place& place,
              std::vector<Triangle>& triangles) {
  Index i = 0, j = 0;
  while (i + 1 < num_lower || j + 1 < num_upper) {
    const auto middle = [&](Index v) { return place(v) + place(v + 1); };
    const bool from_lower = j + 1 == num_upper || (i + 1 < num_lower && middle(lower + i) < middle(upper + j));
    if (from_lower) {
      triangles.push_back({lower + i, upper + j, lower + i + 1});
      ++i;
    } else {
      triangles.push_back({lower + i, upper + j, upper + j + 1});
      ++j;
    }
  }
}

TriangleMesh plate(const BuiltinSpec& spec) {
  const std::vector<Index> numbers =
      spec.numbers(2, 'x', "plate:NXxNY with numbers of edges and rows ≥ 1, such as plate:40x20");
  spec.expect_size(2 * product(numbers) + static_cast<double>(numbers[1]));
  const Index nx = numbers[0], ny = numbers[1];
  const double width = row_height * static_cast<double>(ny);
  const double edge = 1 / std::max(static_cast<double>(nx), width);
  std::vector<Index> first{0};
  for (Index j = 0; j <= ny; ++j) first.push_back(first.back() + nx + 1 + j % 2);
  TriangleMesh mesh;
  mesh.nodes.resize(first.back(), 3);
  for (Index j = 0; j <= ny; ++j) {
    const Index count = first[j + 1] - first[j];
    for (Index i = 0; i < count; ++i) {
      const double shifted = static_cast<double>(i) - (j % 2 == 1 ? 0.5 : 0);
      const double x = std::clamp(shifted, 0.0, static_cast<double>(nx));
      mesh.nodes.row(first[j] + i) << edge * x, 0, edge * row_height * static_cast<double>(j);
    }
  }
  const auto place = [&](Index v) { return mesh.nodes(v, 0); };
  for (Index j = 0; j < ny; ++j)
    zip_rows(first[j], first[j + 1] - first[j], first[j + 1], first[j + 2] - first[j + 1], place, mesh.triangles);
  return mesh;
}

TriangleMesh cylinder(const BuiltinSpec& spec) {
  const std::string expectation = "cylinder:NxM with N ≥ 3 edges around and M ≥ 1 rows, such as cylinder:48x60";
  const std::vector<Index> numbers = spec.numbers(2, 'x', expectation);
  if (numbers[0] < 3) spec.fail("expected " + expectation);
  spec.expect_size(2 * product(numbers));
  const Index n = numbers[0], m = numbers[1];
  const double half_angle = std::numbers::pi / static_cast<double>(n);
  // equilateral: edges between rows are as long as the chord sin(π/n) of a row
  const double sagitta = 0.5 * (1 - std::cos(half_angle));
  const double height = std::sqrt(0.75 * std::sin(half_angle) * std::sin(half_angle) - sagitta * sagitta);
  TriangleMesh mesh;
  mesh.nodes.resize(n * (m + 1), 3);
  for (Index j = 0; j <= m; ++j)
    for (Index i = 0; i < n; ++i) {
      const double angle = half_angle * static_cast<double>(2 * i + j % 2);
      mesh.nodes.row(n * j + i) << 0.5 * std::cos(angle), height * static_cast<double>(j), -0.5 * std::sin(angle);
    }
  for (Index j = 0; j < m; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index next = (i + 1) % n, lower = n * j, upper = n * (j + 1);
      if (j % 2 == 0) {  // the upper row is half an edge ahead
        mesh.triangles.push_back({lower + i, lower + next, upper + i});
        mesh.triangles.push_back({upper + i, lower + next, upper + next});
      } else {
        mesh.triangles.push_back({lower + i, upper + next, upper + i});
        mesh.triangles.push_back({lower + i, lower + next, upper + next});
      }
    }
  return mesh;
}

/// Corners are the cyclic permutations of (0, ± 1, ± φ), golden φ.
TriangleMesh icosahedron() {
  TriangleMesh mesh;
  mesh.nodes.resize(12, 3);
  const double s = 0.5 / std::sqrt(1 + std::numbers::phi * std::numbers::phi), l = s * std::numbers::phi;
  mesh.nodes << -s, l, 0, s, l, 0, -s, -l, 0, s, -l, 0,  //
      0, -s, l, 0, s, l, 0, -s, -l, 0, s, -l,            //
      l, 0, -s, l, 0, s, -l, 0, -s, -l, 0, s;
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return mesh;
}

TriangleMesh sphere(const BuiltinSpec& spec) {
  const Index n = spec.numbers(1, ',', "sphere:N with N ≥ 1 parts of an edge, such as sphere:16")[0];
  spec.expect_size(20 * product({n, n}));
  const TriangleMesh coarse = icosahedron();
  TriangleMesh mesh;
  mesh.nodes.resize(10 * n * n + 2, 3);
  using Weights = std::vector<std::pair<Index, Index>>;  // (corner, weight > 0) by corner, weights add up to n
  std::map<Weights, Index> on_edge;                      // nodes that faces share
  Index count = 0;
  for (const auto& [a, b, c] : coarse.triangles) {
    const auto node_at = [&, corners = std::array{a, b, c}](Index i, Index j) {
      const std::array<Index, 3> weight{n - i - j, i, j};
      Weights weights;
      Point x = Point::Zero();
      for (int k = 0; k < 3; ++k)
        if (weight[k] > 0) {
          weights.emplace_back(corners[k], weight[k]);
          x += static_cast<double>(weight[k]) * coarse.nodes.row(corners[k]).transpose();
        }
      std::sort(weights.begin(), weights.end());
      if (weights.size() < 3) {
        const auto [known, is_new] = on_edge.try_emplace(weights, count);
        if (!is_new) return known->second;
      }
      mesh.nodes.row(count) = 0.5 * x.normalized().transpose();
      return count++;
    };
    std::vector<Index> lower, upper;
    for (Index i = 0; i <= n; ++i) lower.push_back(node_at(i, 0));
    for (Index j = 1; j <= n; ++j, lower = std::move(upper), upper.clear()) {
      for (Index i = 0; i <= n - j; ++i) upper.push_back(node_at(i, j));
      for (Index i = 0; i <= n - j; ++i) {
        mesh.triangles.push_back({lower[i], lower[i + 1], upper[i]});
        if (i < n - j) mesh.triangles.push_back({lower[i + 1], upper[i + 1], upper[i]});
      }
    }
  }
  return mesh;
}

struct BuiltinSurface {
  std::string_view name;
  TriangleMesh (*make)(const BuiltinSpec&);
};
constexpr BuiltinSurface known_surfaces[] = {{"plate", plate}, {"cylinder", cylinder}, {"sphere", sphere}};

const BuiltinSurface* find_surface(std::string_view name) {
  for (const BuiltinSurface& builtin : known_surfaces)
    if (builtin.name == name) return &builtin;
  return nullptr;
}

}  // namespace

bool is_builtin_surface(std::string_view text) {
  return find_surface(BuiltinSpec(text).name) != nullptr;
}

TriangleMesh builtin_surface(std::string_view text) {
  const BuiltinSpec spec(text);
  const BuiltinSurface* builtin = find_surface(spec.name);
  if (!builtin) spec.fail("is no built-in surface; expected one of\n" + std::string(builtin_surface_help));
  return builtin->make(spec);
}

}  // namespace supple
