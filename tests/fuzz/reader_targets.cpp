#include <core/output_file.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <io/picture/image.hpp>
#include <io/surface/surface_reader.hpp>
#include <io/table/csv.hpp>
#include <io/table/matrix_file.hpp>
#include <io/text/index_file.hpp>
#include <io/text/json_fields.hpp>
#include <tests/fuzz/fuzz_target.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/io/surface_files.hpp>
#include <tests/support/meshes.hpp>

#include <algorithm>
#include <cmath>
#include <unistd.h>

namespace supple::fuzz {

namespace {

using test::MeshFile;
namespace fs = std::filesystem;

// ---------------------------------------------------------------------------------------------------------------------
// Meshes and surfaces

/// Between the .node and the .ele file of TetGen.
constexpr char next_file = '\f';

template <typename Mesh>
void add_solids(const char* spec, std::vector<MeshFile>& files) {
  Mesh mesh = test::perturbed(std::get<Mesh>(builtin_solid_mesh(spec)), 0.02, 2);
  for (Index e = 0; e < mesh.num_cells(); ++e) mesh.region.push_back(2 * e < mesh.num_cells() ? 1 : 2);
  mesh.region_names = {{1, "left"}, {2, "right"}};
  std::ranges::move(test::in_every_format(mesh), std::back_inserter(files));
}

std::vector<MeshFile> solid_files() {
  std::vector<MeshFile> files;
  add_solids<TetMesh>("bar:1x1x1", files);
  add_solids<HexMesh>("hexbox:2x1x1", files);
  add_solids<QuadraticTetMesh>("tet10:bar:1x1x1", files);
  return files;
}

std::vector<MeshFile> surface_files() {
  return test::in_every_format(test::perturbed(test::equilateral_grid(2, 1), 0.01, 4));
}

/// The files whose formats are called so.
std::vector<std::string> seeds_of(const std::vector<MeshFile>& files, const std::string& format) {
  std::vector<std::string> seeds;
  for (const MeshFile& file : files)
    if (file.format.starts_with(format))
      seeds.push_back(file.extension == ".node" ? file.bytes + next_file + file.ele_bytes : file.bytes);
  return seeds;
}

template <typename Mesh>
void demand_sound(const Mesh& mesh, const MeshNotes& notes, std::size_t num_cells,
                  const std::vector<std::int64_t>& cells) {
  check_mesh(mesh);  // throws
  demand(notes.numbers.node.size() == static_cast<std::size_t>(mesh.num_nodes()), "nodes without a number");
  demand(cells.size() == num_cells, "cells without a number");
}

Target solids(const std::string& format, const std::string& extension, std::size_t memory_per_byte = 100) {
  const auto read = [=](const std::string& bytes, const fs::path& folder) {
    const std::size_t first = extension == ".node" ? std::min(bytes.find(next_file), bytes.size()) : bytes.size();
    const fs::path path = put(folder / ("mesh" + extension), bytes.substr(0, first));
    if (extension == ".node") put(folder / "mesh.ele", bytes.substr(std::min(first + 1, bytes.size())));
    return answer_of(extension == ".node" ? folder / "mesh" : path, [&] {
      MeshNotes notes;
      const SolidMesh any = read_solid_mesh(path, &notes);
      std::visit([&](const auto& mesh) { demand_sound(mesh, notes, mesh.cells.size(), notes.numbers.cell); }, any);
    });
  };
  return {format, [=] { return seeds_of(solid_files(), format); }, read, memory_per_byte};
}

Target surfaces(const std::string& format) {
  const auto read = [=](const std::string& bytes, const fs::path& folder) {
    const fs::path path = put(folder / ("surface." + format), bytes);
    return answer_of(path, [&] {
      MeshNotes notes;
      const TriangleMesh mesh = read_triangle_mesh(path, &notes);
      demand_sound(mesh, notes, mesh.triangles.size(), notes.numbers.triangle);
    });
  };
  return {format, [=] { return seeds_of(surface_files(), format); }, read};
}

// ---------------------------------------------------------------------------------------------------------------------
// Node sets, matrices, tables, JSON, pictures

constexpr Index num_listed = 12;

Answer read_node_sets(const std::string& bytes, const fs::path& folder) {
  const Points nodes = Points::Zero(num_listed, 3);
  const fs::path path = put(folder / "nodes.txt", bytes);
  const auto demand_nodes = [](const std::vector<Index>& set) {
    demand(!set.empty() && set.front() >= 0 && set.back() < num_listed, "a node that does not exist");
    demand(std::ranges::adjacent_find(set, std::greater_equal()) == set.end(), "nodes that do not ascend");
  };
  const Answer set = answer_of(path, [&] { demand_nodes(read_node_set(nodes, path)); });
  const Answer labels = answer_of(path, [&] { demand_nodes(nodes_with_label(nodes, path, 2)); });
  return set == Answer::Sound ? set : labels;
}

std::string npy(const std::string& type, const std::string& order, const std::string& shape, std::size_t num_bytes) {
  std::string header = "{'descr': '" + type + "', 'fortran_order': " + order + ", 'shape': " + shape + ", }";
  header.resize(117, ' ');
  std::string numbers(num_bytes, '\0');
  for (std::size_t k = 7; k < num_bytes; k += 8) numbers[k] = '\x3f';
  return std::string("\x93NUMPY\1\0\x76\0", 10) + header + '\n' + numbers;
}

std::vector<std::string> matrix_seeds() {
  return {npy("<f8", "False", "(2, 3)", 48),
          npy(">f4", "True", "(4, 2)", 32),
          npy("<i2", "False", "(5,)", 10),
          npy("|b1", "False", "(1, 6)", 6),
          "%%MatrixMarket matrix array real general\n% two\n2 3\n1\n2.5\n3\n-4e-3\n5\n6\n",
          "%%MatrixMarket matrix array integer symmetric\n3 3\n1\n2\n3\n4\n5\n6\n",
          "%%MatrixMarket matrix coordinate real skew-symmetric\n3 3 2\n2 1 1.5\n3 2 1e5\n",
          "%%MatrixMarket matrix coordinate pattern general\n3 4 2\n2 1\n3 4\n"};
}

Answer read_matrices(const std::string& bytes, const fs::path& folder) {
  const fs::path path = put(folder / "matrix", bytes);
  const auto demand_numbers = [](const Matrix& values) {
    demand(values.size() > 0 && values.allFinite(), "a number that is not finite, or none");
  };
  const Answer matrix = answer_of(path, [&] { demand_numbers(read_matrix(path)); });
  const Answer vector = answer_of(path, [&] { demand_numbers(read_vector(path)); });
  return matrix == Answer::Sound ? matrix : vector;
}

Answer read_tables(const std::string& bytes, const fs::path& folder) {
  const fs::path path = put(folder / "table.csv", bytes);
  return answer_of(path, [&] {
    const CsvTable table = read_csv(path);
    for (const CsvTable::Column& column : table.columns()) {
      demand(static_cast<Index>(table.texts(column.name).size()) == table.num_rows(), "a cell is missing");
      (void)answer_of(path, [&] { (void)table.numbers(column.name); });
    }
    write_csv(folder / "again.csv", table);
    demand(read_csv(folder / "again.csv").num_rows() == table.num_rows(), "rows get lost on the way");
  });
}

constexpr const char* json_seed =
    R"({"text": "käse \u00e9", "flag": true, "integer": 12, "length": "2.5 mm", "angle": "30 deg",
 "stiffness": "3 kN/m", "points": [[1, 2, 3]], "point": [1, "2 cm", -3e-2], "numbers": [1, 2.5, 1e300], "texts": ["a", "b"],
 "integers": [1, 5, 2], "choice": "b", "object": {"number": 1, "object": {"number": 2}}, "objects": [{"number": 1}, {"number": 2}]})";

/// All kinds of fields, each asked for by itself, since the first that is wrong ends the reading.
Answer read_json(const std::string& bytes, const fs::path& folder) {
  const fs::path path = folder / "fields.json";  // named only: reading it takes longer than parsing it
  Answer some = Answer::Refused;
  const auto ask = [&](const auto& field) {
    if (answer_of(path, [&] { field(JsonFields::parse(bytes, path.string())); }) == Answer::Sound) some = Answer::Sound;
  };
  const auto demand_finite = [](double value) { demand(std::isfinite(value), "a number that is not finite"); };
  ask([](const JsonFields& fields) { (void)fields.text("text"), (void)fields.flag_or("flag", false); });
  ask([&](const JsonFields& fields) { demand_finite(fields.number("length", positive, "m")); });
  ask([&](const JsonFields& fields) { demand_finite(fields.number("angle", any_number, "rad")); });
  ask([&](const JsonFields& fields) { demand_finite(fields.number("stiffness", positive, "N/m")); });
  ask([&](const JsonFields& fields) {
    const Index value = fields.integer("integer", between(-100, 100));
    demand(value >= -100 && value <= 100, "a number out of range");
  });
  ask([](const JsonFields& fields) {
    demand(fields.point("point").allFinite() && fields.numbers("numbers", JsonFields::any_size).allFinite(),
           "a number that is not finite");
  });
  ask([](const JsonFields& fields) {
    for (const Index i : fields.integers("integers", between(0, 9))) demand(i >= 0 && i <= 9, "a number out of range");
  });
  ask([](const JsonFields& fields) {
    (void)fields.texts("texts"), (void)fields.choice("choice", {"a", "b"});
    for (const JsonFields& object : fields.objects_if("objects")) (void)object.number("number");
    if (const auto object = fields.object_if("object")) (void)object->object("object").number("number");
    fields.finish();
  });
  return some;
}

std::vector<std::string> picture_seeds() {
  const fs::path path = fs::temp_directory_path() / ("supple_seed_" + std::to_string(::getpid()) + ".png");
  Image image(5, 3);
  image.set(1, 2, {1, 0, 0});
  write_png(path, image);
  const std::string bytes = read_file(path);
  fs::remove(path);
  return {bytes};
}

Answer read_pictures(const std::string& bytes, const fs::path& folder) {
  const fs::path path = put(folder / "picture.png", bytes);
  return answer_of(path, [&] {
    const Image image = read_png(path);
    demand(image.width > 0 && image.height > 0, "no pixels");
    demand(image.pixels.size() == 3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
           "pixels of another number than the size says");
  });
}

}  // namespace

std::vector<Target> reader_targets() {
  constexpr std::size_t deflated = 1100;  // zlib unfolds up to 1032 times
  return {solids("gmsh", ".msh"),
          solids("tetgen", ".node"),
          solids("medit", ".mesh"),
          solids("abaqus", ".inp"),
          solids("vega", ".veg"),
          solids("vtk", ".vtk"),
          solids("vtu", ".vtu", deflated),
          surfaces("obj"),
          surfaces("off"),
          surfaces("ply"),
          surfaces("stl"),
          {"node_sets",
           [] {
             return std::vector<std::string>{"# some\n3\n0 11\n7", "1 2 2 1 2\n0 0 0 # six\n5 6 7 8\n"};
           },
           read_node_sets},
          {"matrices", matrix_seeds, read_matrices, /*memory_per_byte=*/2000, /*memory=*/9'000'000},
          {"tables",
           [] { return std::vector<std::string>{"time [s],\"a, \"\"b\"\"\",c\n0,1e-3,x\r\n1,2,\"two\nlines\"\n"}; },
           read_tables},
          {"json", [] { return std::vector<std::string>{json_seed}; }, read_json},
          {"pictures", picture_seeds, read_pictures, 26 * deflated}};
}

}  // namespace supple::fuzz
