#include <io/mesh/mesh_formats.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

namespace supple {

namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return static_cast<unsigned char>(c) <= ' '; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// Names count in any case.
std::string upper(std::string_view text) {
  std::string result(trimmed(text));
  if (result.size() > 1 && result.front() == '"' && result.back() == '"') result = result.substr(1, result.size() - 2);
  for (char& c : result) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return result;
}

/// A line, or several of which all but the last end in a comma, cut at commas.
struct Row {
  std::vector<std::string> cells;
  std::size_t position = 0;

  bool is_keyword() const { return !cells.empty() && cells[0].starts_with('*'); }
  /// What a keyword says of a parameter: "" if it is there without a value.
  std::optional<std::string> parameter(std::string_view name) const {
    for (std::size_t k = 1; k < cells.size(); ++k) {
      const std::size_t equals = std::min(cells[k].find('='), cells[k].size());
      if (upper(std::string_view(cells[k]).substr(0, equals)) != name) continue;
      return std::string(trimmed(std::string_view(cells[k]).substr(std::min(equals + 1, cells[k].size()))));
    }
    return {};
  }
};

class AbaqusReader {
 public:
  AbaqusReader(Cursor& in, FileMesh& mesh) : in_(in), mesh_(mesh) {}

  void read() {
    mesh_.format = "Abaqus";
    advance();
    while (!row_.cells.empty()) {
      const Row keyword = row_;
      const std::string name = upper(keyword.cells[0]);
      advance();
      if (name == "*NODE")
        read_nodes(keyword);
      else if (name == "*ELEMENT")
        read_elements(keyword);
      else if (name == "*NSET" || name == "*ELSET")
        read_set(keyword, name == "*NSET");
      else if (name == "*MATERIAL")
        material_ = begin_material(keyword);
      else if (name == "*ELASTIC" || name == "*HYPERELASTIC" || name == "*DENSITY")
        read_property(keyword, name);
      else if (name == "*SOLID SECTION")
        sections_.push_back(keyword);
      else if (name == "*BOUNDARY")
        read_boundary(keyword);
      else if (name == "*INSTANCE" && !row_.cells.empty() && !row_.is_keyword())
        fail(row_, "the instance is moved, which is not read; write the mesh without parts and instances");
      else if (name == "*CLOAD" || name == "*DLOAD" || name == "*DSLOAD")
        ignored_.insert(name);
      while (!row_.cells.empty() && !row_.is_keyword()) advance();
    }
    if (mesh_.nodes.empty()) in_.fail("expected a section *NODE");
    resolve();
  }

 private:
  struct Set {
    std::string name;
    std::vector<std::int64_t> members;
  };
  using Sets = std::map<std::string, Set>;  // by name in capitals
  struct Boundary {
    Row row;
    std::uint8_t axes;
  };

  [[noreturn]] void fail(const Row& row, const std::string& message) {
    in_.set_position(row.position);
    in_.fail(message);
  }

  /// The next line that says something. Comments begin with "**".
  void advance() {
    row_ = {};
    while (in_.num_left() > 0) {
      const std::size_t position = in_.position();
      std::string_view line = trimmed(in_.rest_of_line());
      if (line.empty() || line.starts_with("**")) continue;
      if (row_.cells.empty()) row_.position = position;
      const bool goes_on = line.ends_with(',');
      if (goes_on) line.remove_suffix(1);
      while (true) {
        const std::size_t comma = std::min(line.find(','), line.size());
        row_.cells.emplace_back(trimmed(line.substr(0, comma)));
        if (comma == line.size()) break;
        line.remove_prefix(comma + 1);
      }
      if (!goes_on || !can_go_on()) return;
    }
  }
  /// Whether a comma at the end of a line means that the next belongs to it: of keywords, and of elements that miss nodes.
  bool can_go_on() const { return row_.is_keyword() || row_.cells.size() < nodes_expected_ + 1; }

  std::int64_t integer(const Row& row, std::size_t cell, const std::string& what) {
    std::int64_t value = 0;
    const std::string text = cell < row.cells.size() ? row.cells[cell] : "";
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      fail(row, "expected " + what + ", found \"" + text.substr(0, 40) + "\"");
    return value;
  }
  double real(const Row& row, std::size_t cell, const std::string& what) {
    double value = 0;
    const std::string text = cell < row.cells.size() ? row.cells[cell] : "";
    const std::size_t sign = text.starts_with('+');
    const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      fail(row, "expected " + what + ", found \"" + text.substr(0, 40) + "\"");
    return value;
  }
  static bool is_number(const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](unsigned char c) { return std::isdigit(c); });
  }

  std::string named(const Row& keyword, std::string_view parameter) {
    const auto name = keyword.parameter(parameter);
    if (!name || name->empty()) fail(keyword, "expected " + std::string(parameter) + "=a name");
    return *name;
  }
  static Set& set_of(Sets& sets, const std::string& name) {
    Set& set = sets[upper(name)];
    if (set.name.empty()) set.name = name;
    return set;
  }

  void read_nodes(const Row& keyword) {
    Set* set = nullptr;
    if (const auto name = keyword.parameter("NSET"); name && !name->empty()) set = &set_of(node_sets_, *name);
    for (; !row_.cells.empty() && !row_.is_keyword(); advance()) {
      const std::int64_t number = integer(row_, 0, "a node number");
      if (!index_of_node_.emplace(number, static_cast<Index>(mesh_.nodes.size())).second)
        fail(row_, "node " + std::to_string(number) + " is there twice; files with several parts are not read");
      Point x = Point::Zero();
      for (std::size_t c = 0; c < 3 && c + 1 < row_.cells.size(); ++c)
        if (!row_.cells[c + 1].empty()) x[static_cast<Index>(c)] = real(row_, c + 1, "a coordinate");
      mesh_.nodes.push_back(x);
      mesh_.numbers.node.push_back(number);
      if (set) set->members.push_back(number);
    }
  }

  void read_elements(const Row& keyword) {
    const std::string type = upper(named(keyword, "TYPE"));
    Set* set = nullptr;
    if (const auto name = keyword.parameter("ELSET"); name && !name->empty()) set = &set_of(element_sets_, *name);
    const auto is = [&](std::string_view prefix) {  // C3D8 and C3D8R, but not C3D8 of C3D80
      return type.starts_with(prefix) &&
             (type.size() == prefix.size() || !std::isdigit(static_cast<unsigned char>(type[prefix.size()])));
    };
    const bool is_solid = type.starts_with("C3D");
    const std::size_t size = is("C3D4") ? 4 : is("C3D10") ? 10 : is("C3D8") ? 8 : 0;
    nodes_expected_ = size;
    if (size > 0) reread();  // the first row may go on
    for (; !row_.cells.empty() && !row_.is_keyword(); advance()) {
      const std::int64_t number = integer(row_, 0, "an element number");
      if (set) set->members.push_back(number);
      if (size == 0) {
        if (is_solid)
          ++mesh_.other_solid["elements of kind " + type.substr(0, 20)];
        else
          ++mesh_.num_lower;
        std::vector<std::int64_t>& nodes = nodes_of_other_[number];
        for (std::size_t a = 1; a < row_.cells.size(); ++a)
          if (!row_.cells[a].empty()) nodes.push_back(integer(row_, a, "a node number"));
        continue;
      }
      if (row_.cells.size() != size + 1)
        fail(row_, "expected an element number and " + std::to_string(size) + " nodes of " + type + ", found " +
                       std::to_string(row_.cells.size()) + " numbers");
      std::array<Index, 10> nodes{};
      for (std::size_t a = 0; a < size; ++a) nodes[a] = node(row_, integer(row_, a + 1, "a node number"));
      if (!index_of_cell_.emplace(number, static_cast<Index>(mesh_.numbers.cell.size())).second)
        fail(row_, "element " + std::to_string(number) + " is there twice");
      mesh_.numbers.cell.push_back(number);
      nodes_of_cell_.emplace_back(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(size));
      if (size == 8)
        mesh_.add_hexahedron(std::span(nodes).first(8));
      else
        mesh_.add_tet(std::span(nodes).first(size));
    }
    nodes_expected_ = 0;
  }
  void reread() {
    if (row_.cells.empty() || row_.is_keyword()) return;
    in_.set_position(row_.position);
    advance();
  }

  Index node(const Row& row, std::int64_t number) {
    const auto found = index_of_node_.find(number);
    if (found == index_of_node_.end()) fail(row, "there is no node " + std::to_string(number));
    return found->second;
  }

  void read_set(const Row& keyword, bool of_nodes) {
    Sets& sets = of_nodes ? node_sets_ : element_sets_;
    Set& set = set_of(sets, named(keyword, of_nodes ? "NSET" : "ELSET"));
    const bool generate = keyword.parameter("GENERATE").has_value();
    if (const auto elements = keyword.parameter("ELSET"); of_nodes && elements)
      nodes_of_elements_.emplace_back(upper(set.name), keyword);
    for (; !row_.cells.empty() && !row_.is_keyword(); advance()) {
      if (generate) {
        const std::int64_t first = integer(row_, 0, "the first number"), last = integer(row_, 1, "the last number"),
                           step = row_.cells.size() > 2 && !row_.cells[2].empty() ? integer(row_, 2, "a step") : 1;
        if (step < 1 || last < first) fail(row_, "expected first, last and step of numbers that rise");
        const auto& known = of_nodes ? index_of_node_ : index_of_cell_;
        for (auto member = known.lower_bound(first); member != known.end() && member->first <= last; ++member)
          if ((member->first - first) % step == 0) set.members.push_back(member->first);
        continue;
      }
      for (std::size_t k = 0; k < row_.cells.size(); ++k) {
        if (row_.cells[k].empty()) continue;
        if (is_number(row_.cells[k])) {
          set.members.push_back(integer(row_, k, "a number"));
        } else if (const auto other = sets.find(upper(row_.cells[k])); other != sets.end()) {
          const std::vector<std::int64_t> members = other->second.members;  // it may be the set itself
          set.members.insert(set.members.end(), members.begin(), members.end());
        } else {
          fail(row_, "the set " + set.name + " names the set " + row_.cells[k].substr(0, 40) +
                         ", which does not exist before it");
        }
      }
    }
  }

  FileMaterial* begin_material(const Row& keyword) {
    const std::string name = named(keyword, "NAME");
    FileMaterial& material = materials_[upper(name)];
    material.name = name;
    return &material;
  }

  void read_property(const Row& keyword, const std::string& name) {
    if (!material_) fail(keyword, name + " belongs to no *MATERIAL");
    if (row_.cells.empty() || row_.is_keyword()) fail(keyword, name + " has no data");
    if (name == "*DENSITY") {
      material_->density = real(row_, 0, "a density");
    } else if (name == "*ELASTIC") {
      const std::string type = upper(keyword.parameter("TYPE").value_or("ISOTROPIC"));
      if (type != "ISOTROPIC" && type != "ISO") return not_read("*ELASTIC, TYPE=" + type);
      material_->young = real(row_, 0, "Young's modulus");
      material_->poisson = real(row_, 1, "Poisson's ratio");
      has_law_.insert(upper(material_->name));
    } else {
      const bool neo_hooke = keyword.parameter("NEO HOOKE") || keyword.parameter("NEO-HOOKE"),
                 mooney = keyword.parameter("MOONEY-RIVLIN").has_value();
      if ((!neo_hooke && !mooney) || keyword.parameter("TEST DATA INPUT"))
        return not_read("*HYPERELASTIC other than NEO HOOKE and MOONEY-RIVLIN by coefficients");
      const double c10 = real(row_, 0, "C10"), c01 = mooney ? real(row_, 1, "C01") : 0;
      const std::size_t last = mooney ? 2 : 1;
      const double d1 = last < row_.cells.size() ? real(row_, last, "D1") : 0;
      if (!(d1 > 0)) return not_read("an incompressible *HYPERELASTIC, D1 = 0");
      material_->law = "mooney-rivlin";  // D1⁻¹ (J − 1)² there, κ/2 (J − 1)² here
      material_->parameters = {{"c10", c10}, {"c01", c01}, {"bulk", 2 / d1}};
      has_law_.insert(upper(material_->name));
    }
  }
  void not_read(const std::string& what) {
    mesh_.warnings.push_back("material " + material_->name + ": " + what + " is not read");
  }

  void read_boundary(const Row&) {
    static const std::map<std::string, std::uint8_t> words{{"ENCASTRE", 7}, {"PINNED", 7}, {"XSYMM", 1},
                                                           {"YSYMM", 2},    {"ZSYMM", 4},  {"XASYMM", 6},
                                                           {"YASYMM", 5},   {"ZASYMM", 3}};
    for (; !row_.cells.empty() && !row_.is_keyword(); advance()) {
      std::uint8_t axes = 0;
      const std::string word = row_.cells.size() > 1 ? upper(row_.cells[1]) : "";
      if (const auto known = words.find(word); known != words.end()) {
        axes = known->second;
      } else {
        const std::int64_t first = integer(row_, 1, "a degree of freedom or ENCASTRE, XSYMM and the like");
        const std::int64_t last =
            row_.cells.size() > 2 && !row_.cells[2].empty() ? integer(row_, 2, "the last one") : first;
        if (row_.cells.size() > 3 && !row_.cells[3].empty() && real(row_, 3, "a displacement") != 0) {
          ignored_.insert("*BOUNDARY with displacements");
          continue;
        }
        for (std::int64_t c = std::max<std::int64_t>(first, 1); c <= std::min<std::int64_t>(last, 3); ++c)
          axes = static_cast<std::uint8_t>(axes | 1 << (c - 1));
      }
      if (axes != 0) boundaries_.push_back({row_, axes});
    }
  }

  // -------------------------------------------------------------------------------------------------------------------

  void resolve() {
    for (const auto& [name, keyword] : nodes_of_elements_) {
      const auto elements = element_sets_.find(upper(*keyword.parameter("ELSET")));
      if (elements == element_sets_.end())
        fail(keyword, "there is no element set " + keyword.parameter("ELSET")->substr(0, 40));
      Set& set = node_sets_[name];
      for (const Index v : nodes_of_elements(elements->second))
        set.members.push_back(mesh_.numbers.node[static_cast<std::size_t>(v)]);
    }
    std::set<std::string> sections;
    if (!sections_.empty()) mesh_.region.assign(mesh_.numbers.cell.size(), 0);
    for (const Row& section : sections_) {
      const std::string name = upper(named(section, "ELSET"));
      const auto set = element_sets_.find(name);
      if (set == element_sets_.end()) fail(section, "there is no element set " + name.substr(0, 40));
      sections.insert(name);
      const int tag = static_cast<int>(sections.size());
      mesh_.region_names[tag] = set->second.name;
      for (const std::int64_t number : set->second.members)
        if (const auto cell = index_of_cell_.find(number); cell != index_of_cell_.end())
          mesh_.region[static_cast<std::size_t>(cell->second)] = tag;
      const auto material = materials_.find(upper(named(section, "MATERIAL")));
      if (material == materials_.end())
        fail(section, "there is no material " + section.parameter("MATERIAL")->substr(0, 40));
      if (!has_law_.contains(material->first)) continue;
      if (!(material->second.density > 0)) {
        material->second.density = 1000;
        mesh_.warnings.push_back("material " + material->second.name + " has no *DENSITY: 1000 is taken");
      }
      mesh_.materials[tag] = material->second;
    }
    for (const auto& [key, set] : element_sets_)
      if (!sections.contains(key)) {
        NodeGroup group{nodes_of_elements(set), faces_of(set)};
        if (!group.nodes.empty()) mesh_.node_groups[set.name] = std::move(group);
      }
    for (const auto& [key, set] : node_sets_)
      for (const std::int64_t number : set.members)
        if (const auto v = index_of_node_.find(number); v != index_of_node_.end())
          mesh_.node_groups[set.name].nodes.push_back(v->second);
    for (const auto& [row, axes] : boundaries_) {
      std::vector<std::int64_t> numbers;
      if (is_number(row.cells[0])) {
        numbers.push_back(integer(row, 0, "a node number"));
        (void)node(row, numbers[0]);
      } else if (const auto set = node_sets_.find(upper(row.cells[0])); set != node_sets_.end()) {
        numbers = set->second.members;
      } else {
        fail(row, "there is no node set " + row.cells[0].substr(0, 40));
      }
      for (const std::int64_t number : numbers)
        if (const auto v = index_of_node_.find(number); v != index_of_node_.end()) mesh_.held[v->second] |= axes;
    }
    for (const std::string& what : ignored_) mesh_.warnings.push_back(what + " is not read: loads belong into a scene");
  }

  std::vector<Index> nodes_of_elements(const Set& set) {
    std::set<Index> nodes;
    for (const std::int64_t number : set.members) {
      if (const auto cell = index_of_cell_.find(number); cell != index_of_cell_.end()) {
        const std::vector<Index>& some = nodes_of_cell_[static_cast<std::size_t>(cell->second)];
        nodes.insert(some.begin(), some.end());
      } else if (const auto other = nodes_of_other_.find(number); other != nodes_of_other_.end()) {
        for (const std::int64_t node : other->second)
          if (const auto v = index_of_node_.find(node); v != index_of_node_.end()) nodes.insert(v->second);
      }
    }
    return {nodes.begin(), nodes.end()};
  }

  /// Of a set of shell or membrane elements alone.
  std::vector<FaceCorners> faces_of(const Set& set) {
    std::vector<FaceCorners> faces;
    for (const std::int64_t number : set.members) {
      const auto element = nodes_of_other_.find(number);
      if (element == nodes_of_other_.end()) return {};
      const std::size_t size = element->second.size();
      if (size != 3 && size != 4 && size != 6 && size != 8) return {};
      std::vector<Index> corners;
      for (std::size_t a = 0; a < (size == 3 || size == 6 ? 3u : 4u); ++a)
        if (const auto v = index_of_node_.find(element->second[a]); v != index_of_node_.end())
          corners.push_back(v->second);
      if (corners.size() == (size == 3 || size == 6 ? 3u : 4u)) faces.push_back(face_corners(corners));
    }
    return faces;
  }

  Cursor& in_;
  FileMesh& mesh_;
  Row row_;
  std::size_t nodes_expected_ = 0;  // in a row of elements
  std::map<std::int64_t, Index> index_of_node_, index_of_cell_;
  std::vector<std::vector<Index>> nodes_of_cell_;
  std::map<std::int64_t, std::vector<std::int64_t>> nodes_of_other_;  // faces and the like, by element number
  Sets node_sets_, element_sets_;
  std::vector<std::pair<std::string, Row>> nodes_of_elements_;  // node sets that are those of element sets
  std::map<std::string, FileMaterial> materials_;
  std::set<std::string> has_law_;
  FileMaterial* material_ = nullptr;
  std::vector<Row> sections_;
  std::vector<Boundary> boundaries_;
  std::set<std::string> ignored_;
};

}  // namespace

/// \see Abaqus Keywords Reference Guide; CalculiX reads the same.
void read_abaqus(Cursor& in, FileMesh& mesh) {
  AbaqusReader(in, mesh).read();
}

}  // namespace supple
