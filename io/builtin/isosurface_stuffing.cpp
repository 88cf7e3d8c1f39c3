#include <core/check.hpp>
#include <core/parallel.hpp>
#include <io/builtin/isosurface_stuffing.hpp>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace supple {
namespace {

using Depth = std::function<double(const Point&)>;

/// The body-centred cubic lattice: black nodes at the corners of cubic cells, red ones at their centres.
class Lattice {
 public:
  Lattice(const BoundingBox& box, double spacing) : origin_(box.lower.array() - spacing), spacing_(spacing) {
    const Point cells = (box.extent().array() / spacing).ceil() + 2;
    require(cells.allFinite() && cells.prod() < 0x1p30, "the box holds too many cells of that spacing");
    for (int axis = 0; axis < 3; ++axis) cells_[axis] = static_cast<Index>(cells[axis]);
    num_black_ = (cells_[0] + 1) * (cells_[1] + 1) * (cells_[2] + 1);
  }

  Index num_nodes() const { return num_black_ + cells_[0] * cells_[1] * cells_[2]; }
  bool is_black(Index v) const { return v < num_black_; }
  Index black(Index i, Index j, Index k) const { return (i * (cells_[1] + 1) + j) * (cells_[2] + 1) + k; }
  Index red(Index i, Index j, Index k) const { return num_black_ + (i * cells_[1] + j) * cells_[2] + k; }

  Point place(Index v) const {
    const double half = is_black(v) ? 0 : 0.5;
    const auto [i, j, k] = cell(v);
    return origin_ + spacing_ * Point(static_cast<double>(i) + half, static_cast<double>(j) + half,
                                      static_cast<double>(k) + half);
  }

  /// Calls visit(w, is_long) for the up to 14 neighbours of v: six along the axes, eight of the other colour.
  template <typename Visit>
  void visit_neighbours(Index v, const Visit& visit) const {
    const std::array<Index, 3> at = cell(v);
    const bool black_node = is_black(v);
    for (int axis = 0; axis < 3; ++axis)
      for (const Index step : {-1, 1}) {
        std::array<Index, 3> to = at;
        to[axis] += step;
        if (to[axis] < 0 || to[axis] >= cells_[axis] + black_node) continue;
        visit(black_node ? black(to[0], to[1], to[2]) : red(to[0], to[1], to[2]), true);
      }
    for (int corner = 0; corner < 8; ++corner) {
      std::array<Index, 3> to;
      bool exists = true;
      for (int axis = 0; axis < 3; ++axis) {
        to[axis] = at[axis] + ((corner >> axis) & 1) - black_node;
        exists = exists && to[axis] >= 0 && to[axis] < cells_[axis] + !black_node;
      }
      if (exists) visit(black_node ? red(to[0], to[1], to[2]) : black(to[0], to[1], to[2]), false);
    }
  }

  /// Calls visit(tet) for all lattice tets: an edge between the centres of neighbour cells with an edge of
  /// the face between them.
  template <typename Visit>
  void visit_tets(const Visit& visit) const {
    std::array<Index, 3> c;
    for (c[0] = 0; c[0] < cells_[0]; ++c[0])
      for (c[1] = 0; c[1] < cells_[1]; ++c[1])
        for (c[2] = 0; c[2] < cells_[2]; ++c[2])
          for (int axis = 0; axis < 3; ++axis) {
            std::array<Index, 3> next = c;
            if (++next[axis] >= cells_[axis]) continue;
            const int u = (axis + 1) % 3, w = (axis + 2) % 3;
            std::array<Index, 4> around;
            for (int k = 0; k < 4; ++k) {
              std::array<Index, 3> corner = next;
              corner[u] += k == 1 || k == 2;
              corner[w] += k >= 2;
              around[k] = black(corner[0], corner[1], corner[2]);
            }
            const Index here = red(c[0], c[1], c[2]), there = red(next[0], next[1], next[2]);
            for (int k = 0; k < 4; ++k) visit(Tet{here, there, around[k], around[(k + 1) % 4]});
          }
  }

 private:
  std::array<Index, 3> cell(Index v) const {
    const Index in_colour = is_black(v) ? v : v - num_black_;
    const Index nz = cells_[2] + is_black(v), ny = cells_[1] + is_black(v);
    return {in_colour / (nz * ny), in_colour / nz % ny, in_colour % nz};
  }

  Point origin_;
  double spacing_;
  std::array<Index, 3> cells_{};
  Index num_black_ = 0;
};

/// Where depth vanishes between a and b, whose depths have opposite signs: the Illinois method.
Point surface_between(const Depth& depth, const Point& a, double depth_a, const Point& b, double depth_b) {
  double s = 0, t = 1, f_s = depth_a, f_t = depth_b, x = 0.5;
  for (int iteration = 0; iteration < 12; ++iteration) {
    x = (s * f_t - t * f_s) / (f_t - f_s);
    const double f = depth(a + x * (b - a));
    if (std::abs(f) <= 1e-9 * std::max(std::abs(depth_a), std::abs(depth_b))) break;
    if ((f > 0) == (f_t > 0)) {
      t = x, f_t = f, f_s /= 2;
    } else {
      s = t, f_s = f_t, t = x, f_t = f;
    }
  }
  return a + x * (b - a);
}

class Stuffing {
 public:
  Stuffing(const Depth& depth, const BoundingBox& box, double spacing)
      : depth_of_(depth), lattice_(box, spacing), spacing_(spacing) {}

  TetMesh mesh() {
    evaluate();
    find_cuts();
    warp();
    lattice_.visit_tets([&](const Tet& tet) { stuff(tet); });
    TetMesh mesh;
    mesh.nodes.resize(static_cast<Index>(nodes_.size()), 3);
    for (std::size_t v = 0; v < nodes_.size(); ++v) mesh.nodes.row(v) = nodes_[v].transpose();
    mesh.cells = std::move(tets_);
    for (Index e = 0; e < mesh.num_cells(); ++e)
      if (tet_volume(mesh, e) < 0) std::swap(mesh.cells[e][2], mesh.cells[e][3]);
    return mesh;
  }

 private:
  void evaluate() {
    depth_.resize(lattice_.num_nodes());
    parallel_ranges(lattice_.num_nodes(), 4096, [&](Index begin, Index end) {
      for (Index v = begin; v < end; ++v) depth_[v] = depth_of_(lattice_.place(v));
    });
  }

  bool is_cut(Index v, Index w) const { return (depth_[v] > 0 && depth_[w] < 0) || (depth_[v] < 0 && depth_[w] > 0); }
  static std::array<Index, 2> edge(Index v, Index w) { return {std::min(v, w), std::max(v, w)}; }

  void find_cuts() {
    std::vector<std::array<Index, 2>> edges;
    for (Index v = 0; v < lattice_.num_nodes(); ++v)
      if (depth_[v] > 0)
        lattice_.visit_neighbours(v, [&](Index w, bool) {
          if (is_cut(v, w)) edges.push_back({v, w});
        });
    std::vector<Point> cuts(edges.size());
    parallel_ranges(static_cast<Index>(edges.size()), 256, [&](Index begin, Index end) {
      for (Index k = begin; k < end; ++k) {
        const auto [v, w] = edges[k];
        cuts[k] = surface_between(depth_of_, lattice_.place(v), depth_[v], lattice_.place(w), depth_[w]);
      }
    });
    cut_.reserve(edges.size());
    for (std::size_t k = 0; k < edges.size(); ++k) cut_.emplace(edge(edges[k][0], edges[k][1]), Cut{cuts[k], -1});
  }

  /// Moves nodes onto the surface that would leave edges shorter than a safe share: Table 1 of the paper.
  void warp() {
    constexpr double share_long = 0.24999, share_short = 0.41189;
    for (Index v = 0; v < lattice_.num_nodes(); ++v) {
      if (depth_[v] == 0) continue;
      const Point place = lattice_.place(v);
      double nearest = 1;
      Point target;
      lattice_.visit_neighbours(v, [&](Index w, bool is_long) {
        if (!is_cut(v, w)) return;
        const Point& cut = cut_.at(edge(v, w)).place;
        const double reach = spacing_ * (is_long ? share_long : share_short * std::sqrt(0.75));
        const double distance = (cut - place).norm();
        if (distance / reach < nearest) nearest = distance / reach, target = cut;
      });
      if (nearest < 1) {
        depth_[v] = 0;
        warped_.emplace(v, target);
      }
    }
  }

  /// The part of a lattice tet with depth ≥ 0.
  void stuff(const Tet& tet) {
    std::array<Index, 4> in, on, out;
    int num_in = 0, num_on = 0, num_out = 0;
    for (const Index v : tet) {
      if (depth_[v] > 0)
        in[num_in++] = v;
      else if (depth_[v] == 0)
        on[num_on++] = v;
      else
        out[num_out++] = v;
    }
    if (num_in == 0) return;
    std::array<Index, 4> p{}, z{};
    for (int k = 0; k < num_in; ++k) p[k] = node(in[k]);
    for (int k = 0; k < num_on; ++k) z[k] = node(on[k]);
    const auto cut = [&](int a, int b) { return cut_node(in[a], out[b]); };
    if (num_out == 0) {
      std::copy(z.begin(), z.begin() + num_on, p.begin() + num_in);
      tets_.push_back(p);
    } else if (num_in == 1) {
      std::array<Index, 4> corner{p[0]};
      for (int k = 0; k < num_on; ++k) corner[1 + k] = z[k];
      for (int k = 0; k < num_out; ++k) corner[1 + num_on + k] = cut(0, k);
      tets_.push_back(corner);
    } else if (num_in == 2 && num_on == 1) {
      add_pyramid(z[0], {p[0], p[1], cut(1, 0), cut(0, 0)});
    } else if (num_in == 2) {
      add_prism({p[0], cut(0, 0), cut(0, 1)}, {p[1], cut(1, 0), cut(1, 1)});
    } else {
      add_prism({p[0], p[1], p[2]}, {cut(0, 0), cut(1, 0), cut(2, 0)});
    }
  }

  // A quadrilateral between two tets is split at its node of highest rank, so both split it alike.
  void add_pyramid(Index apex, const std::array<Index, 4>& quad) {
    const auto top = std::max_element(quad.begin(), quad.end(), [&](Index a, Index b) { return ranks_before(a, b); });
    const Index k = top - quad.begin();
    for (const Index side : {1, 2}) tets_.push_back({apex, quad[k], quad[(k + side) % 4], quad[(k + side + 1) % 4]});
  }

  void add_prism(std::array<Index, 3> bottom, std::array<Index, 3> top) {
    const auto highest = [&](const std::array<Index, 3>& side) {
      return std::max_element(side.begin(), side.end(), [&](Index a, Index b) { return ranks_before(a, b); }) -
             side.begin();
    };
    if (ranks_before(bottom[highest(bottom)], top[highest(top)])) std::swap(bottom, top);
    const Index k = highest(bottom), a = (k + 1) % 3, b = (k + 2) % 3;
    tets_.push_back({bottom[k], top[0], top[1], top[2]});
    add_pyramid(bottom[k], {bottom[a], bottom[b], top[b], top[a]});
  }

  bool ranks_before(Index a, Index b) const { return rank_[a] != rank_[b] ? rank_[a] < rank_[b] : a < b; }

  Index add_node(const Point& place, int rank) {
    nodes_.push_back(place);
    rank_.push_back(rank);
    return static_cast<Index>(nodes_.size()) - 1;
  }

  Index node(Index v) {
    const auto [at, is_new] = node_.try_emplace(v, static_cast<Index>(nodes_.size()));
    if (is_new) {
      const auto moved = warped_.find(v);
      add_node(moved == warped_.end() ? lattice_.place(v) : moved->second, lattice_.is_black(v) ? 1 : 2);
    }
    return at->second;
  }

  Index cut_node(Index in, Index out) {
    Cut& cut = cut_.at(edge(in, out));
    if (cut.node < 0) cut.node = add_node(cut.place, 0);
    return cut.node;
  }

  struct Cut {
    Point place;
    Index node;
  };
  struct EdgeHash {
    std::size_t operator()(const std::array<Index, 2>& edge) const {
      return std::hash<Index>()(edge[0] * 0x9E3779B97F4A7C15 + edge[1]);
    }
  };

  const Depth& depth_of_;
  Lattice lattice_;
  double spacing_;
  std::vector<double> depth_;
  std::unordered_map<std::array<Index, 2>, Cut, EdgeHash> cut_;
  std::unordered_map<Index, Point> warped_;
  std::unordered_map<Index, Index> node_;
  std::vector<Point> nodes_;
  std::vector<int> rank_;
  std::vector<Tet> tets_;
};

}  // namespace

TetMesh stuff_isosurface(const Depth& depth, const BoundingBox& box, double spacing) {
  require(spacing > 0 && std::isfinite(spacing), "spacing must be positive");
  TetMesh mesh = Stuffing(depth, box, spacing).mesh();
  require(mesh.num_cells() > 0, "no part of the solid is as thick as a lattice cell");
  return mesh;
}

}  // namespace supple
