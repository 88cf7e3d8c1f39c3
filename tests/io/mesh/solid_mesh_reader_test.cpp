#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/frames/vtu_writer.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/mesh/elements.hpp>
#include <testing/near.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/shared_meshes.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Cells whose coordinates need all their digits, in two named regions.
template <typename Mesh>
Mesh two_regions(const char* spec) {
  Mesh mesh = perturbed(std::get<Mesh>(builtin_solid_mesh(spec)), 0.02, 1);
  for (Index e = 0; e < mesh.num_cells(); ++e) mesh.region.push_back(1 + (e / 2) % 2);
  mesh.region_names = {{1, "soft"}, {2, "stiff"}};
  return mesh;
}
HexMesh hexahedra() {
  return two_regions<HexMesh>("hexbox:3x2x2");
}
QuadraticTetMesh quadratic_tets() {
  return two_regions<QuadraticTetMesh>("tet10:cube:2");
}

/// The message with which a file of these bytes is refused; empty if it is read.
std::string solid_refusal(const std::string& bytes, const std::string& name) {
  try {
    (void)read_solid_mesh(write(bytes, test_folder() / name));
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

template <typename Mesh>
void expect_kept(const MeshFile& file, const Mesh& expected) {
  MeshNotes notes;
  const SolidMesh read = read_solid_mesh(write(file, test_folder()), &notes);
  ASSERT_TRUE(std::holds_alternative<Mesh>(read));
  const Mesh& mesh = std::get<Mesh>(read);
  EXPECT_TRUE(is_same(mesh.nodes, expected.nodes));
  EXPECT_EQ(mesh.cells, expected.cells);
  EXPECT_EQ(mesh.region, expected.region);
  if (file.format.starts_with("gmsh") || file.format == "vega" || file.format == "abaqus") {
    EXPECT_EQ(mesh.region_names, expected.region_names);
  }
  EXPECT_EQ(notes.numbers.cell.size(), expected.cells.size());
  if (file.format != "vega") {
    EXPECT_THAT(notes.warnings, IsEmpty());
  }
  if (file.format == "abaqus") return;  // which does not say how much it holds
  // cut off anywhere, it is refused, or only what follows the cells is lost
  for (std::size_t size = 0; size < file.bytes.size(); size += 1 + file.bytes.size() / 37) {
    MeshFile cut = file;
    cut.bytes = file.bytes.substr(0, size);
    try {
      EXPECT_EQ(std::get<Mesh>(read_solid_mesh(write(cut, test_folder()))).cells, expected.cells) << size;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(file.format)) << size;
    }
  }
}

class HexFile : public testing::TestWithParam<MeshFile> {};
class QuadraticTetFile : public testing::TestWithParam<MeshFile> {};

TEST_P(HexFile, KeepsEveryBitAndTheRegions) {
  expect_kept(GetParam(), hexahedra());
  try {
    (void)read_tet_mesh(test_folder() / (GetParam().format + GetParam().extension));
    ADD_FAILURE() << "hexahedra were read as tets";
  } catch (const InputError&) {
  }
}
TEST_P(QuadraticTetFile, KeepsEveryBitAndTheRegions) {
  const QuadraticTetMesh expected = quadratic_tets();
  expect_kept(GetParam(), expected);
  MeshNotes notes;  // as tets, of their corners
  const TetMesh tets = read_tet_mesh(write(GetParam(), test_folder()), &notes);
  EXPECT_EQ(tets.num_nodes(), 27);
  for (Index e = 0; e < tets.num_cells(); ++e)
    for (int a = 0; a < 4; ++a)
      EXPECT_EQ(tets.nodes.row(tets.cells[e][a]), expected.nodes.row(expected.cells[e][a])) << e;
  ASSERT_GE(notes.warnings.size(), 2u);
  EXPECT_EQ(notes.warnings[notes.warnings.size() - 2], "48 tets are of higher order: only the corners are used");
}

constexpr auto format_of = [](const auto& test) { return test.param.format; };
INSTANTIATE_TEST_SUITE_P(Mesh, HexFile, testing::ValuesIn(in_every_format(hexahedra())), format_of);
INSTANTIATE_TEST_SUITE_P(Mesh, QuadraticTetFile, testing::ValuesIn(in_every_format(quadratic_tets())), format_of);

/// A file that Gmsh itself made: the order of its mid-edge nodes is not ours to choose.
TEST(ReadSolidMesh, PutsTheMidEdgeNodesOfGmshAmidTheirEdges) {
  SKIP_WITHOUT_MESHES();
  const auto mesh = std::get<QuadraticTetMesh>(read_solid_mesh(meshes() / "awkward" / "mix_tet10.msh"));
  EXPECT_EQ(mesh.num_cells(), 48);
  double volume = 0;
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    volume += cell_volume(mesh, e);
    for (int k = 0; k < 6; ++k) {
      const auto [a, b] = QuadraticTet::edges[k];
      const auto& cell = mesh.cells[e];
      EXPECT_TRUE(is_near(mesh.nodes.row(cell[4 + k]), (mesh.nodes.row(cell[a]) + mesh.nodes.row(cell[b])) / 2, 1e-15));
    }
  }
  EXPECT_NEAR(volume, 1, 1e-13);
}

TEST(ReadSolidMesh, ReadsWhatWriteVtuWrites) {
  const HexMesh hexes = hexahedra();
  write_vtu(test_folder() / "hexes.vtu", hexes.nodes, hexes.cells);
  EXPECT_EQ(std::get<HexMesh>(read_solid_mesh(test_folder() / "hexes.vtu")).cells, hexes.cells);
  const QuadraticTetMesh tets = quadratic_tets();
  write_vtu(test_folder() / "tets.vtu", tets.nodes, tets.cells);
  EXPECT_EQ(std::get<QuadraticTetMesh>(read_solid_mesh(test_folder() / "tets.vtu")).cells, tets.cells);
}

TEST(ReadSolidMesh, ReordersReversedCells) {
  HexMesh hexes = hexahedra();
  QuadraticTetMesh tets = quadratic_tets();
  for (const int e : {1, 5}) hexes.cells[e] = reversed(hexes.cells[e]);
  for (auto& cell : tets.cells) cell = reversed(cell);
  MeshNotes notes;
  write_vtu(test_folder() / "hexes.vtu", hexes.nodes, hexes.cells);
  EXPECT_EQ(std::get<HexMesh>(read_solid_mesh(test_folder() / "hexes.vtu", &notes)).cells, hexahedra().cells);
  EXPECT_THAT(notes.warnings, ElementsAre("2 hexahedra are reversed: nodes reordered in each"));
  write_vtu(test_folder() / "tets.vtu", tets.nodes, tets.cells);
  EXPECT_EQ(std::get<QuadraticTetMesh>(read_solid_mesh(test_folder() / "tets.vtu", &notes)).cells,
            quadratic_tets().cells);
  EXPECT_THAT(notes.warnings, ElementsAre("48 tets are reversed: nodes reordered in each"));
}

/// A Gmsh file of the unit cube's corners and the cells that are given.
std::string gmsh_cube(const std::string& elements, int count) {
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n10 0 0 0\n11 1 0 0\n12 1 1 0\n13 0 1 0\n14 0 0 1\n15 1 0 1\n"
         "16 1 1 1\n17 0 1 1\n$EndNodes\n$Elements\n" +
         std::to_string(count) + "\n" + elements + "$EndElements\n";
}

TEST(ReadSolidMesh, RefusesOtherAndMixedCellsWithTheirCounts) {
  const std::string hex = "1 5 0 10 11 12 13 14 15 16 17\n", tet = "2 4 0 10 11 13 14\n",
                    prism = "3 6 0 10 11 12 14 15 16\n";
  EXPECT_EQ(solid_refusal(gmsh_cube(hex, 1), "hex.msh"), "");
  EXPECT_THAT(solid_refusal(gmsh_cube(hex + tet, 2), "mixed.msh"),
              HasSubstr("mixed.msh: holds 1 hexahedron and 1 tet; expected"));
  EXPECT_THAT(solid_refusal(gmsh_cube(hex + prism, 2), "mixed.msh"),
              HasSubstr("holds 1 prisms, 1 hexahedron; expected"));
  EXPECT_THAT(
      solid_refusal(gmsh_cube("1 17 0 10 11 12 13 14 15 16 17 10 10 10 10 10 10 10 10 10 10 10 10\n", 1), "20.msh"),
      HasSubstr("holds 1 hexahedra of higher order"));
  EXPECT_THAT(solid_refusal(gmsh_cube("1 1 0 10 11\n", 1), "line.msh"),
              HasSubstr("holds no tetrahedra or hexahedra but 1 cell"));
}

TEST(ReadSolidMesh, NamesBadHexahedraByTheNumbersOfTheFile) {
  const auto hexes = [](const std::string& elements, int count) {
    return solid_refusal(gmsh_cube(elements, count), "bad.msh");
  };
  EXPECT_THAT(hexes("7 5 0 10 11 12 13 14 15 16 16\n", 1), HasSubstr("hex 7 names node 16 twice"));
  EXPECT_THAT(hexes("7 5 0 10 11 12 13 14 15 17 16\n", 1),
              AllOf(HasSubstr("hex 7 is tangled: det J is"), HasSubstr("at its corner, node ")));
  EXPECT_THAT(hexes("7 5 0 10 11 12 13 14 15 16 17\n8 5 0 10 11 12 13 14 15 16 17\n", 2),
              HasSubstr("hex 7 and hex 8 have the same nodes"));
  EXPECT_THAT(hexes("7 5 0 10 11 12 13 14 15 16 19\n", 1), HasSubstr("node 19 does not exist"));
}

TEST(BuiltinSolidMesh, MakesBoxesOfHexahedraAndQuadraticTets) {
  const auto hexes = std::get<HexMesh>(builtin_solid_mesh("hexbox:8x2x3"));
  EXPECT_EQ(hexes.num_cells(), 48);
  EXPECT_EQ(bounding_box(hexes.nodes).extent(), Point(1, 0.25, 0.375));
  EXPECT_NO_THROW(check_mesh(hexes));
  const auto tets = std::get<QuadraticTetMesh>(builtin_solid_mesh("tet10:ball:6"));
  EXPECT_NO_THROW(check_mesh(tets));
  EXPECT_EQ(tets.num_cells(), builtin_mesh("ball:6").num_cells());
  EXPECT_TRUE(std::holds_alternative<TetMesh>(builtin_solid_mesh("bar:2x1x1")));
  for (const char* spec : {"hexbox:2x2", "hexbox", "tet10", "tet10:plate:3x3", "tet10:hexbox:1x1x1", "tet10:bar:1"})
    EXPECT_THROW((void)builtin_solid_mesh(spec), InputError) << spec;
  EXPECT_THROW((void)builtin_mesh("hexbox:2x2x2"), InputError);
}

TEST(NodesOfRegion, AreThoseOfItsHexahedra) {
  HexMesh mesh = hex_box(3, 1, 1, {3, 1, 1});
  mesh.region = {4, 4, 9};
  mesh.region_names[9] = "tip";
  EXPECT_THAT(nodes_of_region(mesh, "tip"), ElementsAre(2, 3, 6, 7, 10, 11, 14, 15));
}

}  // namespace
}  // namespace supple::test
