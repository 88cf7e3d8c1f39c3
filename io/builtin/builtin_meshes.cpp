#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/builtin/builtin_spec.hpp>
#include <io/builtin/isosurface_stuffing.hpp>
#include <io/builtin/octopus.hpp>

#include <algorithm>

namespace supple {
namespace {

/// The kept cells of a box lattice, six tets each: one for every order in which a path along the axes leads
/// from the lowest to the highest corner of a cell. Node (i, j, k) lies at (i, j, k) / divisor.
template <typename Keep>
TetMesh kuhn_mesh(const std::array<Index, 3>& cells, Index divisor, const Keep& is_kept) {
  const Index nx = cells[0], ny = cells[1], nz = cells[2];
  const auto lattice_node = [&](const std::array<Index, 3>& at) {
    return (at[0] * (ny + 1) + at[1]) * (nz + 1) + at[2];
  };
  static constexpr int paths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  TetMesh mesh;
  std::vector<Index> node((nx + 1) * (ny + 1) * (nz + 1), -1);
  for (Index i = 0; i < nx; ++i)
    for (Index j = 0; j < ny; ++j)
      for (Index k = 0; k < nz; ++k) {
        if (!is_kept(i, j, k)) continue;
        for (const auto& path : paths) {
          std::array<Index, 3> at{i, j, k};
          Tet tet{lattice_node(at)};
          for (int step = 0; step < 3; ++step) {
            ++at[path[step]];
            tet[step + 1] = lattice_node(at);
          }
          if (path[1] != (path[0] + 1) % 3) std::swap(tet[2], tet[3]);  // an odd order
          mesh.cells.push_back(tet);
          for (const Index v : tet) node[v] = 0;
        }
      }
  Index count = 0;
  for (Index& v : node)
    if (v == 0) v = count++;
  mesh.nodes.resize(count, 3);
  for (Index i = 0; i <= nx; ++i)
    for (Index j = 0; j <= ny; ++j)
      for (Index k = 0; k <= nz; ++k)
        if (const Index v = node[lattice_node({i, j, k})]; v >= 0)
          mesh.nodes.row(v) << static_cast<double>(i) / static_cast<double>(divisor),
              static_cast<double>(j) / static_cast<double>(divisor),
              static_cast<double>(k) / static_cast<double>(divisor);
  for (Tet& tet : mesh.cells)
    for (Index& v : tet) v = node[v];
  return mesh;
}

TetMesh bar(const BuiltinSpec& spec) {
  const std::vector<Index> cells = spec.numbers(3, 'x', "bar:NXxNYxNZ with numbers of cells ≥ 1, such as bar:80x20x10");
  spec.expect_size(6 * product(cells));
  return kuhn_mesh({cells[0], cells[1], cells[2]}, *std::max_element(cells.begin(), cells.end()),
                   [](Index, Index, Index) { return true; });
}

TetMesh cube(const BuiltinSpec& spec) {
  const Index n = spec.numbers(1, ',', "cube:N with N ≥ 1 cells a side, such as cube:10")[0];
  spec.expect_size(6 * product({n, n, n}));
  return kuhn_mesh({n, n, n}, n, [](Index, Index, Index) { return true; });
}

TetMesh menger(const BuiltinSpec& spec) {
  const std::string expectation = "menger:BASE,LEVEL,SUB with BASE ≥ 3, LEVEL ≥ 1, SUB ≥ 1, such as menger:3,3,1";
  const std::vector<Index> numbers = spec.numbers(3, ',', expectation);
  const Index base = numbers[0], level = numbers[1], sub = numbers[2];
  if (base < 3) spec.fail("expected " + expectation);
  spec.expect_size(product(numbers));  // so that nothing below overflows
  Index side = sub;
  double num_tets = 6 * product({sub, sub, sub});
  for (Index l = 0; l < level; ++l) {
    side *= base;
    const auto b = static_cast<double>(base), middle = b - 2;
    num_tets *= b * b * b - 3 * middle * middle * 2 - middle * middle * middle;
    spec.expect_size(product({side, side, side}));
  }
  spec.expect_size(num_tets);
  return kuhn_mesh({side, side, side}, side, [=](Index i, Index j, Index k) {
    i /= sub, j /= sub, k /= sub;
    for (Index l = 0; l < level; ++l) {
      const auto is_middle = [&](Index cell) { return cell % base > 0 && cell % base < base - 1; };
      if (is_middle(i) + is_middle(j) + is_middle(k) >= 2) return false;
      i /= base, j /= base, k /= base;
    }
    return true;
  });
}

TetMesh ball(const BuiltinSpec& spec) {
  const std::vector<Index> cells = spec.numbers(1, ',', "ball:N with 4 … 130 cells across, such as ball:20");
  if (cells[0] < 4 || cells[0] > 130) spec.fail("expected 4 … 130 cells across");
  const Point corner = Point::Constant(0.5);
  return stuff_isosurface([](const Point& x) { return 0.5 - x.norm(); }, {-corner, corner},
                          1 / static_cast<double>(cells[0]));
}

TetMesh octopus(const BuiltinSpec& spec) {
  Index cells = 44;
  const std::string expectation = "octopus or octopus:N with 30 … 200 cells a metre";
  if (spec.name.size() < spec.text.size()) cells = spec.numbers(1, ',', expectation)[0];
  if (cells < 30 || cells > 200) spec.fail("expected " + expectation);
  const Octopus creature;
  return stuff_isosurface([&](const Point& x) { return creature.depth(x); }, creature.box(),
                          1 / static_cast<double>(cells));
}

struct BuiltinMesh {
  std::string_view name;
  TetMesh (*make)(const BuiltinSpec&);
};
constexpr BuiltinMesh known_meshes[] = {
    {"bar", bar}, {"cube", cube}, {"menger", menger}, {"ball", ball}, {"octopus", octopus}};

const BuiltinMesh* find_mesh(std::string_view name) {
  for (const BuiltinMesh& builtin : known_meshes)
    if (builtin.name == name) return &builtin;
  return nullptr;
}

constexpr std::string_view hexahedral = "hexbox", quadratic = "tet10";

HexMesh hexbox(const BuiltinSpec& spec) {
  const std::vector<Index> cells =
      spec.numbers(3, 'x', "hexbox:NXxNYxNZ with numbers of cells ≥ 1, such as hexbox:40x10x10");
  spec.expect_size(product(cells));
  const Point size = Eigen::Map<const Eigen::Matrix<Index, 3, 1>>(cells.data()).cast<double>();
  return hex_box(cells[0], cells[1], cells[2], size / size.maxCoeff());
}

}  // namespace

bool is_builtin(std::string_view text) {
  const std::string_view name = BuiltinSpec(text).name;
  return find_mesh(name) || name == hexahedral || name == quadratic;
}

TetMesh builtin_mesh(std::string_view text) {
  const BuiltinSpec spec(text);
  const BuiltinMesh* builtin = find_mesh(spec.name);
  if (!builtin) spec.fail("is no built-in mesh of tets; expected one of\n" + std::string(builtin_mesh_help));
  return builtin->make(spec);
}

SolidMesh builtin_solid_mesh(std::string_view text) {
  const BuiltinSpec spec(text);
  if (spec.name == hexahedral) return hexbox(spec);
  if (spec.name != quadratic) return builtin_mesh(text);
  if (!find_mesh(BuiltinSpec(spec.parameters).name))
    spec.fail("expected tet10: and a built-in mesh of tets, such as tet10:bar:20x5x5");
  return quadratic_mesh(builtin_mesh(spec.parameters));
}

}  // namespace supple
