#include <io/mesh/mesh_formats.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <numeric>

namespace supple {

namespace {

std::string trimmed(std::string_view line) {
  line = line.substr(0, line.find('#'));
  while (!line.empty() && static_cast<unsigned char>(line.front()) <= ' ') line.remove_prefix(1);
  while (!line.empty() && static_cast<unsigned char>(line.back()) <= ' ') line.remove_suffix(1);
  return std::string(line);
}

/// The rest of the line, or the next one that holds anything.
std::string next_line(Cursor& in) {
  while (true) {
    std::string line = trimmed(in.rest_of_line());
    if (!line.empty() || in.num_left() == 0) return line;
  }
}

constexpr std::string_view include = "*INCLUDE";
bool is_include(std::string_view line) {
  return line.size() >= include.size() && std::ranges::equal(line.substr(0, include.size()), include, {}, [](char c) {
           return static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
         });
}

void expand(const std::filesystem::path& path, std::string_view text, int depth, int& num_included, std::string& all) {
  constexpr int deepest = 16, most = 1000;
  if (depth > deepest || num_included > most)
    throw InputError(path.string() + ": files include each other, " + std::to_string(num_included) + " so far");
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size() - 1) + 1;
    const std::string line = trimmed(text.substr(0, end));
    if (is_include(line)) {
      std::string name = trimmed(std::string_view(line).substr(include.size()));
      if (name.starts_with(',')) name = trimmed(std::string_view(name).substr(name.find('=') + 1));
      if (name.empty()) throw InputError(path.string() + ": *INCLUDE names no file");
      const std::filesystem::path file = path.parent_path() / name;
      try {
        std::error_code unknown;
        if (std::filesystem::exists(file, unknown) && !std::filesystem::is_regular_file(file, unknown))
          throw InputError(file.string() + ": is no regular file");
        expand(file, read_text(file), depth + 1, ++num_included, all);
      } catch (const InputError& error) {
        throw InputError(depth > 0 ? error.what() : path.string() + ": *INCLUDE: " + error.what());
      }
      all += '\n';
    } else {
      all += text.substr(0, end);
    }
    text.remove_prefix(end);
  }
}

/// "ENU, density, E, nu" or "MOONEYRIVLIN, density, mu01, mu10, v1".
FileMaterial read_material(Cursor& in) {
  FileMaterial material;
  material.name = next_line(in);
  const std::string kind(in.word());
  if (kind != "ENU" && kind != "MOONEYRIVLIN") {
    material.law = kind;
    in.rest_of_line();
    return material;
  }
  material.density = in.real("a density");
  if (kind == "ENU") {
    material.young = in.real("Young's modulus");
    material.poisson = in.real("Poisson's ratio");
  } else {
    material.law = "mooney-rivlin";
    material.parameters["c01"] = in.real("mu01");
    material.parameters["c10"] = in.real("mu10");
    material.parameters["bulk"] = 2 * in.real("v1");  // v1 (J - 1)² there
  }
  return material;
}

bool is_read(const FileMaterial& material) {
  return material.law.empty() || material.law == "mooney-rivlin";
}

}  // namespace

std::string with_includes(const std::filesystem::path& path, std::string_view text) {
  std::string all;
  all.reserve(text.size());
  int num_included = 0;
  expand(path, text, 0, num_included, all);
  return all;
}

/// \see Sin, Schroeder and Barbič 2013, "Vega: Non-Linear FEM Deformable Object Simulator", and the .veg
/// manual.
void read_vega(Cursor& in, FileMesh& mesh) {
  mesh.format = "VegaFEM";
  Index num_nodes = -1;
  std::int64_t first_node = 1, first_cell = 1;
  std::map<std::string, std::vector<std::int64_t>> sets;
  std::map<std::string, FileMaterial> materials;
  struct Region {
    std::string set, material;
    std::size_t position;
  };
  std::vector<Region> regions;
  bool skip_rows = false;  // elements of another kind

  for (std::string_view keyword = in.word(); !keyword.empty(); keyword = in.word()) {
    if (keyword == "*VERTICES") {
      if (num_nodes >= 0) in.fail("a second section *VERTICES");
      num_nodes = in.count("vertices", 7);
      if (in.integer("the dimension") != 3) in.fail("expected dimension 3");
      in.rest_of_line();
      mesh.nodes.resize(num_nodes);
      for (Index v = 0; v < num_nodes; ++v) {
        const std::int64_t number = in.integer("a vertex number");
        if (v == 0) first_node = number;
        if (number != first_node + v || first_node < 0 || first_node > 1)
          in.fail("expected vertices numbered in turn from 0 or 1");
        for (double& coordinate : mesh.nodes[v]) coordinate = in.real("a coordinate");
      }
    } else if (keyword == "*ELEMENTS") {
      if (num_nodes < 0) in.fail("expected *VERTICES before *ELEMENTS");
      const std::string type(in.word());
      const Index count = in.count("elements", 9);
      const std::int64_t nodes_per_element = in.integer("the nodes of an element");
      in.rest_of_line();
      const bool is_hexahedron = type == "CUBIC";
      if (type != "TET" && type != "TETS" && !is_hexahedron) {
        skip_rows = true;
        mesh.other_solid["elements of kind " + type.substr(0, 20)] += count;
        continue;
      }
      const int size = is_hexahedron ? 8 : 4;
      if (nodes_per_element != size)
        in.fail("expected " + std::to_string(size) + " nodes a " + (is_hexahedron ? "cube" : "tet") + ", found " +
                std::to_string(nodes_per_element));
      for (Index e = 0; e < count; ++e) {
        const std::int64_t number = in.integer("an element number");
        if (mesh.num_cells() == 0) first_cell = number;
        mesh.numbers.cell.push_back(number);
        std::array<Index, 8> nodes{};
        for (int a = 0; a < size; ++a) nodes[a] = node_at(in, in.integer("a vertex number"), first_node, num_nodes);
        if (is_hexahedron)
          mesh.add_hexahedron(nodes);
        else
          mesh.add_tet(std::span(nodes).first(4));
      }
    } else if (keyword == "*MATERIAL") {
      FileMaterial material = read_material(in);
      materials[material.name] = std::move(material);
    } else if (keyword == "*REGION") {
      const std::size_t position = in.position();
      const std::string line = next_line(in);
      const std::size_t comma = line.find(',');
      regions.push_back({trimmed(line.substr(0, comma)),
                         comma == std::string::npos ? "" : trimmed(line.substr(comma + 1)), position});
    } else if (keyword == "*SET") {
      auto& members = sets[next_line(in)];
      for (std::string_view next = in.peek(); !next.empty() && next[0] != '*'; next = in.peek())
        members.push_back(in.integer("an element number"));
    } else if (skip_rows && !keyword.starts_with('*')) {
      in.rest_of_line();
    } else {
      in.fail("expected a section such as *VERTICES, found \"" + std::string(keyword.substr(0, 40)) + "\"");
    }
  }
  if (num_nodes < 0) in.fail("expected a section *VERTICES");
  mesh.numbers.node.resize(num_nodes);
  std::iota(mesh.numbers.node.begin(), mesh.numbers.node.end(), first_node);

  const Index num_cells = mesh.num_cells();
  if (!regions.empty()) mesh.region.assign(num_cells, 0);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    const int tag = static_cast<int>(r) + 1;
    mesh.region_names[tag] = regions[r].set;
    if (regions[r].set == "allElements") {
      mesh.region.assign(num_cells, tag);
    } else if (const auto set = sets.find(regions[r].set); set != sets.end()) {
      for (const std::int64_t number : set->second) {
        if (number < first_cell || number - first_cell >= num_cells)
          in.fail("set " + set->first + " names element " + std::to_string(number) + ", which does not exist");
        mesh.region[number - first_cell] = tag;
      }
    } else {
      in.set_position(regions[r].position);
      in.fail("the region names the set " + regions[r].set + ", which does not exist");
    }
    if (regions[r].material.empty()) continue;
    const auto material = materials.find(regions[r].material);
    if (material == materials.end()) {
      in.set_position(regions[r].position);
      in.fail("the region names the material " + regions[r].material + ", which does not exist");
    }
    if (is_read(material->second)) mesh.materials[tag] = material->second;
  }
  for (const auto& [name, material] : materials)
    if (!is_read(material))
      mesh.warnings.push_back("material " + name + " is of the kind " + material.law +
                              ", expected ENU or MOONEYRIVLIN: not read");
}

}  // namespace supple
