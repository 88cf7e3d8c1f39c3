#include <core/check.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/text/cursor.hpp>
#include <io/text/index_file.hpp>
#include <io/text/unit.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

namespace supple {
namespace {

std::string_view trim(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

std::optional<double> to_finite(std::string_view text) {
  text = trim(text);
  double value = 0;
  const auto [rest, error] = std::from_chars(text.data() + text.starts_with('+'), text.data() + text.size(), value);
  if (error != std::errc() || rest != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

[[noreturn]] void fail(std::string_view rule, const std::string& message) {
  throw InputError("node selection \"" + std::string(rule) + "\": " + message);
}

std::vector<std::string_view> parts_of(std::string_view text, std::string_view separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(trim(text.substr(0, end)));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + separator.size());
  }
}

/// "y<4%": whether a node is on one side of a plane, or in it.
class Comparison {
 public:
  /// \throws InputError naming the rule that it is a part of.
  Comparison(std::string_view rule, std::string_view text, const BoundingBox& box) {
    const std::string expectation =
        "expected an axis, one of < <= > >= =, and a coordinate or a share, such as y<4%, x>=0.25 or x=10 mm; several "
        "with 'and' and 'or' between";
    if (text.empty() || text[0] < 'x' || text[0] > 'z') fail(rule, expectation);
    axis_ = text[0] - 'x';
    text = trim(text.substr(1));
    if (text.empty() || (text[0] != '<' && text[0] != '>' && text[0] != '=')) fail(rule, expectation);
    relation_ = text[0];
    or_equal_ = text.size() > 1 && text[1] == '=';
    text = trim(text.substr(or_equal_ ? 2 : 1));
    const bool is_share = text.ends_with('%');
    std::optional<double> value = to_finite(is_share ? text.substr(0, text.size() - 1) : text);
    if (!value && is_share) fail(rule, expectation);
    if (!value) {
      try {
        value = parse_quantity(text, "m");
      } catch (const InputError& error) {
        fail(rule, expectation + ": " + error.what());
      }
    }
    bound_ = is_share ? std::lerp(box.lower[axis_], box.upper[axis_], *value / 100) : *value;
    rounding_ = 1e-6 * box.diagonal();
  }

  char relation() const { return relation_; }
  AxisPlane plane() const { return {axis_, bound_}; }

  bool operator()(const Point& node) const {
    const double x = node[axis_];
    if (relation_ == '=') return std::abs(x - bound_) <= rounding_;
    return (or_equal_ && x == bound_) || (relation_ == '<' ? x < bound_ : x > bound_);
  }

 private:
  int axis_;
  char relation_;
  bool or_equal_;
  double bound_, rounding_;
};

template <typename Is>
std::vector<Index> nodes_where(Index num_nodes, std::string_view rule, const Is& is_selected) {
  std::vector<Index> selected;
  for (Index v = 0; v < num_nodes; ++v)
    if (is_selected(v)) selected.push_back(v);
  if (selected.empty()) fail(rule, "selects no node");
  return selected;
}

template <typename Mesh>
std::vector<Index> region_nodes(const Mesh& mesh, std::string_view region) {
  std::optional<int> tag;
  for (const auto& [number, name] : mesh.region_names)
    if (name == region) tag = number;
  if (!tag) {
    int number = 0;
    const auto [rest, error] = std::from_chars(region.data(), region.data() + region.size(), number);
    if (error == std::errc() && rest == region.data() + region.size()) tag = number;
  }
  std::vector<char> is_member(mesh.num_nodes(), false);
  bool exists = false;
  std::set<int> tags;  // that are of the region
  for (const int some : std::set<int>(mesh.region.begin(), mesh.region.end()))
    if (tag && std::ranges::count(regions_of_tag(mesh, some), *tag) > 0) tags.insert(some);
  for (std::size_t e = 0; e < mesh.region.size(); ++e)
    if (tags.contains(mesh.region[e])) {
      exists = true;
      for (const Index v : mesh.cells[e]) is_member[v] = true;
    }
  if (const auto group = mesh.node_groups.find(std::string(region)); !exists && group != mesh.node_groups.end())
    return group->second.nodes;
  if (!exists) {
    std::string known;
    for (const int number : all_regions(mesh)) {
      if (known.size() > 200) {
        known += ", …";
        break;
      }
      const auto name = mesh.region_names.find(number);
      known += (known.empty() ? "" : ", ") + std::to_string(number);
      if (name != mesh.region_names.end()) known += " (" + name->second + ")";
    }
    for (const auto& [name, group] : mesh.node_groups) {
      if (known.size() > 200) break;
      known += (known.empty() ? "" : ", ") + name;
    }
    fail(region, known.empty() ? "the mesh has no regions" : "no such region; the mesh has " + known);
  }
  return nodes_where(mesh.num_nodes(), region, [&](Index v) { return is_member[v]; });
}

}  // namespace

std::vector<Index> select_nodes(const Points& nodes, std::string_view rule) {
  const BoundingBox box = bounding_box(nodes);
  std::vector<char> any(static_cast<std::size_t>(nodes.rows()), false);
  for (const std::string_view alternative : parts_of(rule, " or ")) {
    std::vector<char> all(any.size(), true);
    for (const std::string_view text : parts_of(alternative, " and ")) {
      const Comparison holds(rule, text, box);
      for (std::size_t v = 0; v < all.size(); ++v) all[v] = all[v] && holds(nodes.row(static_cast<Index>(v)));
    }
    for (std::size_t v = 0; v < any.size(); ++v) any[v] = any[v] || all[v];
  }
  return nodes_where(nodes.rows(), rule, [&](Index v) { return any[static_cast<std::size_t>(v)]; });
}

AxisPlane parse_plane(const Points& nodes, std::string_view text) {
  const Comparison plane(text, trim(text), bounding_box(nodes));
  if (plane.relation() != '=') fail(text, "expected a plane, such as x=50% or z=10 mm");
  return plane.plane();
}

std::vector<Index> select_nodes(const Points& nodes, const std::vector<std::string>& rules) {
  std::set<Index> selected;
  for (const std::string& rule : rules)
    for (const Index v : select_nodes(nodes, rule)) selected.insert(v);
  return {selected.begin(), selected.end()};
}

std::vector<Index> nodes_in_box(const Points& nodes, std::string_view box) {
  const std::string expectation = "expected xmin,ymin,zmin:xmax,ymax,zmax";
  std::array<double, 6> bounds;
  std::string_view rest = box;
  for (int k = 0; k < 6; ++k) {
    const std::size_t end = k == 5 ? rest.size() : rest.find(k == 2 ? ':' : ',');
    const std::optional<double> value = end == std::string_view::npos ? std::nullopt : to_finite(rest.substr(0, end));
    if (!value) fail(box, expectation);
    bounds[k] = *value;
    if (k < 5) rest.remove_prefix(end + 1);
  }
  const Point lower(bounds[0], bounds[1], bounds[2]), upper(bounds[3], bounds[4], bounds[5]);
  if ((lower.array() > upper.array()).any()) fail(box, "a lower bound is above its upper bound; " + expectation);
  return nodes_where(nodes.rows(), box, [&](Index v) {
    const Point x = nodes.row(v);
    return (x.array() >= lower.array()).all() && (x.array() <= upper.array()).all();
  });
}

std::vector<Index> nodes_of_region(const TetMesh& mesh, std::string_view region) {
  return region_nodes(mesh, region);
}
std::vector<Index> nodes_of_region(const HexMesh& mesh, std::string_view region) {
  return region_nodes(mesh, region);
}
std::vector<Index> nodes_of_region(const QuadraticTetMesh& mesh, std::string_view region) {
  return region_nodes(mesh, region);
}

std::vector<Index> nodes_at_places(const std::vector<Index>& list, Index num_nodes, const NodePlaces& places,
                                   const std::string& source) {
  const Index count = places.num_places(num_nodes);
  std::set<Index> nodes;
  for (const Index place : list) {
    if (place < 0 || place >= count)
      throw InputError(source + ": node " + std::to_string(place) + " does not exist: indices are 0 … " +
                       std::to_string(count - 1));
    if (const Index v = places.node(place); v >= 0) nodes.insert(v);
  }
  if (nodes.empty() && !list.empty()) throw InputError(source + ": no cell has any of the nodes that are listed");
  return {nodes.begin(), nodes.end()};
}

std::vector<Index> read_node_set(const Points& nodes, const std::filesystem::path& path, const NodePlaces& places) {
  return nodes_at_places(read_indices(path, "node", places.num_places(nodes.rows())), nodes.rows(), places,
                         path.string());
}

std::vector<Index> nodes_with_label(const Points& nodes, const std::filesystem::path& path, int label,
                                    const NodePlaces& places) {
  const std::string text = read_text(path);
  const Index count = places.num_places(nodes.rows());
  std::vector<Index> selected;
  Index node = 0, line_number = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    std::string_view line(text.data() + begin, end - begin);
    begin = end + 1;
    ++line_number;
    line = trim(line.substr(0, line.find('#')));
    while (!line.empty() && (line.back() == '\r' || line.back() == '\t')) line = trim(line.substr(0, line.size() - 1));
    if (line.empty()) continue;
    int value = 0;
    const auto [rest, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc() || rest != line.data() + line.size())
      throw InputError(path.string() + ":" + std::to_string(line_number) +
                       ": expected a whole number, the label of node " + std::to_string(node));
    if (value == label && node < count)
      if (const Index v = places.node(node); v >= 0) selected.push_back(v);
    ++node;
  }
  if (node != count)
    throw InputError(path.string() + ": has " + std::to_string(node) + " labels, expected one for each of the " +
                     std::to_string(count) + " nodes");
  if (selected.empty()) throw InputError(path.string() + ": no node has the label " + std::to_string(label));
  return selected;
}

}  // namespace supple
