#include <io/mesh/mesh_formats.hpp>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <optional>
#include <set>

namespace supple {
namespace {

struct ElementType {
  int num_nodes = 0;
  int dim = 0;
  const char* plural = "";  // of solids and quadrilaterals
};
constexpr const char* quadrilaterals = "quadrilaterals";

/// Element types by number. \see Gmsh reference manual, "MSH file format".
ElementType element_type(std::int64_t type) {
  static constexpr std::pair<int, ElementType> known[] = {{15, {1, 0}},
                                                          {1, {2, 1}},
                                                          {8, {3, 1}},
                                                          {26, {4, 1}},
                                                          {27, {5, 1}},
                                                          {28, {6, 1}},
                                                          {2, {3, 2}},
                                                          {3, {4, 2, quadrilaterals}},
                                                          {9, {6, 2}},
                                                          {10, {9, 2, quadrilaterals}},
                                                          {16, {8, 2, quadrilaterals}},
                                                          {20, {9, 2}},
                                                          {21, {10, 2}},
                                                          {22, {12, 2}},
                                                          {23, {15, 2}},
                                                          {24, {15, 2}},
                                                          {25, {21, 2}},
                                                          {4, {4, 3, "tets"}},
                                                          {11, {10, 3, "tets"}},
                                                          {29, {20, 3, "tets"}},
                                                          {30, {35, 3, "tets"}},
                                                          {31, {56, 3, "tets"}},
                                                          {5, {8, 3, "hexahedra"}},
                                                          {12, {27, 3, "hexahedra of higher order"}},
                                                          {17, {20, 3, "hexahedra of higher order"}},
                                                          {92, {64, 3, "hexahedra of higher order"}},
                                                          {93, {125, 3, "hexahedra of higher order"}},
                                                          {6, {6, 3, "prisms"}},
                                                          {13, {18, 3, "prisms"}},
                                                          {18, {15, 3, "prisms"}},
                                                          {7, {5, 3, "pyramids"}},
                                                          {14, {14, 3, "pyramids"}},
                                                          {19, {13, 3, "pyramids"}}};
  for (const auto& [number, element] : known)
    if (number == type) return element;
  return {};
}

class GmshReader {
 public:
  GmshReader(Cursor& in, FileMesh& mesh) : in_(in), mesh_(mesh) {}

  void read() {
    for (std::string_view section = in_.word(); !section.empty(); section = in_.word()) {
      if (!section.starts_with('$')) in_.fail("expected a section such as $Nodes");
      const std::string end = "$End" + std::string(section.substr(1));
      if (section != "$MeshFormat" && section != "$Comments" && version_.empty())
        in_.fail("expected $MeshFormat before " + std::string(section));
      if (section == "$MeshFormat")
        read_format();
      else if (section == "$PhysicalNames")
        read_physical_names();
      else if (section == "$Entities" && is_4())
        binary_part([&] { read_entities(); });
      else if (section == "$PartitionedEntities" && is_4())
        binary_part([&] { read_partitioned_entities(); });
      else if (section == "$Nodes")
        read_nodes();
      else if (section == "$Elements")
        read_elements();
      else if (!in_.skip_behind(end, is_binary_ ? Cursor::Where::Anywhere : Cursor::Where::LineStart))
        in_.fail("section " + std::string(section) + " is not closed by " + end);
      else
        continue;
      in_.expect(end);
    }
    if (version_.empty()) in_.fail("expected $MeshFormat");
    if (!table_) in_.fail("expected a section $Nodes");
    if (!has_elements_) in_.fail("expected a section $Elements");
    choose_regions();
  }

 private:
  bool is_4() const { return version_ == "4.1" || is_40(); }
  bool is_40() const { return version_ == "4" || version_ == "4.0"; }

  void read_format() {
    version_ = in_.word();
    if (version_ != "2" && version_ != "2.0" && version_ != "2.1" && version_ != "2.2" && !is_4())
      in_.fail("expected Gmsh format version 2.2, 4.0 or 4.1, found " + version_.substr(0, 20));
    const std::int64_t kind = in_.integer("0 (ASCII) or 1 (binary)");
    if (kind != 0 && kind != 1) in_.fail("expected 0 (ASCII) or 1 (binary)");
    is_binary_ = kind == 1;
    size_of_size_ = in_.integer("the size of a number");
    if (size_of_size_ != 8 && !(is_4() && size_of_size_ == 4)) in_.fail("expected numbers of 8 bytes");
    mesh_.format = "Gmsh " + version_ + (is_binary_ ? ", binary" : ", ASCII");
    if (!is_binary_) return;
    in_.rest_of_line();
    in_.set_binary(std::endian::little);
    const auto one = in_.take<std::uint32_t>("the mark of the byte order");
    if (one != 1 && one != 0x01000000) in_.fail("expected the integer 1 as mark of the byte order");
    order_ = one == 1 ? std::endian::little : std::endian::big;
    in_.set_text();
  }

  template <typename Read>
  void binary_part(const Read& read) {
    if (is_binary_) {
      in_.rest_of_line();
      in_.set_binary(order_);
    }
    read();
    in_.set_text();
  }

  // One number in the file's mode.
  std::int64_t integer(std::string_view what) { return is_binary_ ? in_.take<std::int32_t>(what) : in_.integer(what); }
  std::int64_t size(std::string_view what) {
    if (!is_binary_) return in_.integer(what);
    return size_of_size_ == 8 ? in_.take<std::int64_t>(what) : in_.take<std::int32_t>(what);
  }
  double real(std::string_view what) { return is_binary_ ? in_.take<double>(what) : in_.real(what); }

  /// A count of things that take at least so many bytes each.
  Index count(std::string_view what, std::size_t text_size, std::size_t binary_size) {
    const std::int64_t count = size("the number of " + std::string(what));
    if (count < 0) in_.fail("the number of " + std::string(what) + " is negative");
    in_.expect_room(static_cast<std::uint64_t>(count), is_binary_ ? binary_size : text_size, what);
    return count;
  }

  void read_physical_names() {
    const Index count = in_.count("physical names", 6);
    for (Index k = 0; k < count; ++k) {
      const std::int64_t dim = in_.integer("a dimension");
      const int tag = static_cast<int>(in_.integer("a physical tag"));
      const std::string_view line = in_.rest_of_line();
      const std::size_t open = line.find('"'), close = line.rfind('"');
      if (open == close) in_.fail("expected a name in quotes");
      const std::string name(line.substr(open + 1, close - open - 1));
      if (dim == 3)
        mesh_.region_names[tag] = name;
      else
        group_names_[{static_cast<int>(dim), tag}] = name;
    }
  }

  /// The group of a physical tag, which is negative where elements are turned over.
  static int group_of(std::int64_t physical) {
    constexpr std::int64_t most = std::numeric_limits<int>::max();
    return static_cast<int>(std::abs(std::clamp(physical, -most, most)));
  }

  void read_entities() {
    for_each_entity([](int, std::int64_t) {});
  }

  /// Parts of entities, each with a tag of its own, the entity that it is of, and the same physical groups.
  void read_partitioned_entities() {
    if (is_40()) in_.fail("partitions of format 4.0 are not read; save the mesh as 4.1");
    size("the number of partitions");
    const Index num_ghosts = count("ghost entities", 4, 8);
    for (Index k = 0; k < num_ghosts; ++k) integer("a ghost entity"), integer("its partition");
    for_each_entity([&](int dim, std::int64_t tag) {
      const std::int64_t parent_dim = integer("the dimension of the parent"), parent = integer("the parent's tag");
      const Index num_partitions = count("partitions", 2, 4);
      for (Index j = 0; j < num_partitions; ++j) integer("a partition");
      const auto of_parent = physical_of_entity_.find({dim, parent});
      if (parent_dim == dim && of_parent != physical_of_entity_.end())
        physical_of_entity_[{dim, tag}].insert(of_parent->second.begin(), of_parent->second.end());
    });
  }

  /// \param read_more  reads what stands behind the tag of an entity: called with its dimension and tag.
  template <typename ReadMore>
  void for_each_entity(const ReadMore& read_more) {
    std::array<Index, 4> counts{};
    for (Index& n : counts) n = count("entities", 2, 16);
    for (int dim = 0; dim < 4; ++dim)
      for (Index k = 0; k < counts[dim]; ++k) {
        const std::int64_t tag = integer("an entity tag");
        read_more(dim, tag);
        for (int c = 0; c < (dim == 0 && !is_40() ? 3 : 6); ++c) real("a bounding box");
        const Index num_physical = count("physical tags", 2, 4);
        for (Index j = 0; j < num_physical; ++j) {
          const std::int64_t physical = integer("a physical tag");
          physical_of_entity_[{dim, tag}].insert(group_of(physical));
        }
        const Index num_bounding = dim == 0 ? 0 : count("bounding entities", 2, 4);
        for (Index j = 0; j < num_bounding; ++j) integer("a bounding entity");
      }
  }

  void read_nodes() {
    if (table_) in_.fail("a second section $Nodes");
    std::vector<std::int64_t>& numbers = mesh_.numbers.node;
    const auto read_point = [&] {
      Point x;
      for (double& coordinate : x) coordinate = real("a coordinate");
      mesh_.nodes.push_back(x);
    };
    if (is_4()) {
      binary_part([&] {
        const Index num_blocks = count("blocks of nodes", 7, 20);
        const Index num_nodes = count("nodes", 7, is_40() ? 28 : 32);
        if (!is_40()) size("the smallest node tag"), size("the largest node tag");
        reserve_nodes(num_nodes);
        for (Index block = 0; block < num_blocks; ++block) {
          std::int64_t dim = integer("the dimension of an entity");
          const std::int64_t entity = integer("an entity tag");
          if (is_40()) dim = entity;  // they stand the other way round
          const bool parametric = integer("0 or 1 (parametric)") != 0;
          const Index n = count("nodes", 7, is_40() ? 28 : 32);
          for (Index k = 0; k < n && !is_40(); ++k) numbers.push_back(size("a node tag"));
          for (Index k = 0; k < n; ++k) {
            if (is_40()) numbers.push_back(integer("a node tag"));
            read_point();
            for (std::int64_t c = 0; parametric && c < std::min<std::int64_t>(dim, 3); ++c) real("a parameter");
          }
        }
        if (static_cast<Index>(numbers.size()) != num_nodes)
          in_.fail("the blocks hold " + std::to_string(numbers.size()) + " nodes, announced were " +
                   std::to_string(num_nodes));
      });
    } else {
      const Index num_nodes = in_.count("nodes", is_binary_ ? 28 : 7);
      reserve_nodes(num_nodes);
      binary_part([&] {
        for (Index k = 0; k < num_nodes; ++k) {
          numbers.push_back(integer("a node number"));
          read_point();
        }
      });
    }
    table_.emplace(numbers, in_);
  }

  void reserve_nodes(Index count) {
    mesh_.nodes.reserve(count);
    mesh_.numbers.node.reserve(count);
  }

  void read_elements() {
    if (!table_) in_.fail("expected $Nodes before $Elements");
    has_elements_ = true;
    if (is_4()) {
      binary_part([&] {
        const Index num_blocks = count("blocks of elements", 7, 20);
        const Index num_elements = count("elements", 3, 12);
        if (!is_40()) size("the smallest element tag"), size("the largest element tag");
        Index total = 0;
        for (Index block = 0; block < num_blocks; ++block) {
          std::int64_t dim = integer("the dimension of an entity"), entity = integer("an entity tag");
          if (is_40()) std::swap(dim, entity);
          const ElementType type = read_type();
          const std::size_t number_size = is_40() ? 4 : static_cast<std::size_t>(size_of_size_);
          const Index n = count("elements", 2 * type.num_nodes, number_size * (type.num_nodes + 1));
          const auto found = physical_of_entity_.find({type.dim, entity});
          const std::vector<int> groups = found == physical_of_entity_.end()
                                              ? std::vector<int>{}
                                              : std::vector<int>(found->second.begin(), found->second.end());
          const int physical = groups.empty() || type.dim != 3 ? 0 : tag_of_groups(mesh_, groups);
          total += n;
          for (Index k = 0; k < n; ++k) {
            const auto tag = [&](std::string_view what) { return is_40() ? integer(what) : size(what); };
            const std::int64_t number = tag("an element tag");
            read_element(type, number, physical, entity, groups, [&] { return tag("a node tag"); });
          }
        }
        if (total != num_elements)
          in_.fail("the blocks hold " + std::to_string(total) + " elements, announced were " +
                   std::to_string(num_elements));
      });
      return;
    }
    const Index num_elements = in_.count("elements", is_binary_ ? 8 : 5);
    binary_part([&] {
      for (Index k = 0; k < num_elements;) {
        std::int64_t number = is_binary_ ? 0 : integer("an element number");
        const ElementType type = read_type();
        const Index in_group = is_binary_ ? integer("the number of elements that follow") : 1;
        if (in_group < 1 || in_group > num_elements - k)
          in_.fail("a group of " + std::to_string(in_group) + " elements where " + std::to_string(num_elements - k) +
                   " are left");
        const std::int64_t num_tags = integer("the number of tags");
        if (num_tags < 0) in_.fail("the number of tags is negative");
        for (Index j = 0; j < in_group; ++j, ++k) {
          if (is_binary_) number = integer("an element number");
          std::array<std::int64_t, 2> tags{};  // physical, elementary
          for (std::int64_t t = 0; t < num_tags; ++t) {
            const std::int64_t tag = integer("a tag");
            if (t < 2) tags[t] = tag;
          }
          const int group = group_of(tags[0]);
          read_element(type, number, tags[0], tags[1], group == 0 ? std::vector<int>{} : std::vector<int>{group},
                       [&] { return integer("a node number"); });
        }
      }
    });
  }

  ElementType read_type() {
    const std::int64_t number = integer("an element type");
    const ElementType type = element_type(number);
    if (type.num_nodes == 0) in_.fail("element type " + std::to_string(number) + " is not known");
    return type;
  }

  /// \param groups  physical ones of the element, of whatever dimension.
  template <typename ReadNumber>
  void read_element(const ElementType& type, std::int64_t number, std::int64_t physical, std::int64_t entity,
                    const std::vector<int>& groups, const ReadNumber& read_number) {
    const bool is_tet = type.dim == 3 && type.plural == std::string_view("tets");
    const bool is_hexahedron = type.dim == 3 && type.plural == std::string_view("hexahedra") && type.num_nodes == 8;
    std::array<Index, 10> nodes{};
    std::vector<Index> face;  // or edge, or point, of a group
    for (int a = 0; a < type.num_nodes; ++a) {
      const std::int64_t node = read_number();
      if (type.dim < 3 && !groups.empty()) face.push_back(table_->lookup(node).value_or(-1));
      if ((is_tet && (a < 4 || type.num_nodes == 10)) || is_hexahedron) nodes[a] = table_->find(node, in_);
    }
    if (is_tet || is_hexahedron) {
      if (is_hexahedron) {
        mesh_.add_hexahedron(std::span(nodes).first(8));
      } else if (type.num_nodes == 10) {
        std::swap(nodes[8], nodes[9]);  // edge 23 before 13
        mesh_.add_tet(nodes);
      } else {
        mesh_.add_tet(std::span(nodes).first(4));
        mesh_.num_higher += type.num_nodes > 4;
      }
      mesh_.numbers.cell.push_back(number);
      physical_.push_back(group_of(physical));
      entity_.push_back(static_cast<int>(entity));
    } else if (type.dim == 3) {
      ++mesh_.other_solid[type.plural];
    } else {
      ++mesh_.num_lower;
      if (!face.empty()) add_to_groups(type, groups, face);
    }
  }

  void add_to_groups(const ElementType& type, const std::vector<int>& groups, const std::vector<Index>& nodes) {
    if (std::ranges::find(nodes, -1) != nodes.end()) {
      ++num_without_nodes_;
      return;
    }
    for (const int group : groups) {
      NodeGroup& own = groups_[{type.dim, group}];
      own.nodes.insert(own.nodes.end(), nodes.begin(), nodes.end());
      if (type.dim == 2)
        own.faces.push_back(face_corners(std::span(nodes).first(type.plural == quadrilaterals ? 4 : 3)));
    }
  }

  /// A tet or hexahedron in several physical groups stands several times in files of version 2, once for each.
  void merge_repeated_cells() {
    const bool is_tets = mesh_.hexahedra.empty();
    if (is_4() || (!is_tets && !mesh_.tets.empty()) ||
        (!mesh_.mid_edges.empty() && mesh_.mid_edges.size() != mesh_.tets.size()))
      return;
    if (is_tets)
      merge_repeated(mesh_.tets);
    else
      merge_repeated(mesh_.hexahedra);
  }

  template <std::size_t size>
  void merge_repeated(std::vector<std::array<Index, size>>& cells) {
    if (std::set<int>(physical_.begin(), physical_.end()).size() < 2) return;
    std::vector<std::size_t> order(cells.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto nodes = [&](std::size_t e) -> const auto& {
      return cells[e];
    };
    std::ranges::stable_sort(order, {}, nodes);
    if (std::ranges::adjacent_find(order, {}, nodes) == order.end()) return;
    std::vector<std::set<int>> groups(cells.size());
    std::vector<char> goes(cells.size(), false);
    for (std::size_t k = 0, first = 0; k < order.size(); ++k) {
      if (cells[order[k]] != cells[order[first]]) first = k;
      goes[order[k]] = k > first && !groups[order[first]].contains(physical_[order[k]]);
      groups[order[first]].insert(physical_[order[k]]);
    }
    std::size_t kept = 0;
    for (std::size_t e = 0; e < cells.size(); ++e) {
      if (goes[e]) continue;
      physical_[kept] = groups[e].empty() ? physical_[e] : tag_of_groups(mesh_, {groups[e].begin(), groups[e].end()});
      cells[kept] = cells[e];
      entity_[kept] = entity_[e];
      mesh_.numbers.cell[kept] = mesh_.numbers.cell[e];
      if (!mesh_.mid_edges.empty()) mesh_.mid_edges[kept] = mesh_.mid_edges[e];
      ++kept;
    }
    cells.resize(kept), physical_.resize(kept), entity_.resize(kept), mesh_.numbers.cell.resize(kept);
    if (!mesh_.mid_edges.empty()) mesh_.mid_edges.resize(kept);
  }

  void name_groups() {
    constexpr const char* kinds[]{"point ", "curve ", "surface "};
    for (const auto& [group, own] : groups_) {
      const auto name = group_names_.find(group);
      NodeGroup& all =
          mesh_.node_groups[name != group_names_.end() ? name->second
                                                       : kinds[group.first] + std::to_string(group.second)];
      all.nodes.insert(all.nodes.end(), own.nodes.begin(), own.nodes.end());
      all.faces.insert(all.faces.end(), own.faces.begin(), own.faces.end());
    }
    if (num_without_nodes_ > 0)
      mesh_.warnings.push_back(std::to_string(num_without_nodes_) +
                               " elements of groups of faces, edges or points name nodes that do not exist: left out");
  }

  void choose_regions() {
    name_groups();
    merge_repeated_cells();
    const auto marks = [](const std::vector<int>& tags) {
      return std::any_of(tags.begin(), tags.end(), [](int tag) { return tag != 0; });
    };
    if (marks(physical_))
      mesh_.region = std::move(physical_);
    else if (marks(entity_))
      mesh_.region = std::move(entity_), mesh_.region_names.clear();
  }

  Cursor& in_;
  FileMesh& mesh_;
  std::string version_;
  bool is_binary_ = false, has_elements_ = false;
  std::int64_t size_of_size_ = 8;
  std::endian order_ = std::endian::native;
  std::optional<NumberTable> table_;
  std::map<std::pair<int, std::int64_t>, std::set<int>> physical_of_entity_;  // by dimension and tag
  std::map<std::pair<int, int>, std::string> group_names_;                    // of dimensions below three
  std::map<std::pair<int, int>, NodeGroup> groups_;
  Index num_without_nodes_ = 0;
  std::vector<int> physical_, entity_;  // of each tet or hexahedron
};

}  // namespace

void read_gmsh(Cursor& in, FileMesh& mesh) {
  GmshReader(in, mesh).read();
}

}  // namespace supple
