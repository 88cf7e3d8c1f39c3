#include <core/check.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/frames/vtu_writer.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/mesh/tet_mesh.hpp>
#include <testing/near.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/support/meshes.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

/// 48 tets whose coordinates need all their digits, in two named regions.
TetMesh two_regions() {
  TetMesh mesh = perturbed(builtin_mesh("cube:2"), 0.05, 1);
  for (Index e = 0; e < mesh.num_cells(); ++e) mesh.region.push_back(1 + (e / 6) % 2);
  mesh.region_names = {{1, "soft"}, {2, "stiff"}};
  return mesh;
}

/// The message with which a file of these bytes is refused; empty if it is read.
std::string refusal(const std::string& bytes, const std::string& name) {
  try {
    read_tet_mesh(write(bytes, test_folder() / name));
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

class EveryFormat : public testing::TestWithParam<MeshFile> {};

TEST_P(EveryFormat, KeepsEveryBitAndTheRegions) {
  const TetMesh expected = two_regions();
  MeshNotes notes;
  const TetMesh mesh = read_tet_mesh(write(GetParam(), test_folder()), &notes);
  EXPECT_TRUE(is_same(mesh.nodes, expected.nodes));
  EXPECT_EQ(mesh.cells, expected.cells);
  EXPECT_EQ(mesh.region, expected.region);
  const bool has_names =
      GetParam().format.starts_with("gmsh") || GetParam().format == "vega" || GetParam().format == "abaqus";
  if (has_names) {
    EXPECT_EQ(mesh.region_names, expected.region_names);
  }
  EXPECT_EQ(notes.numbers.node.size(), 27u);
  EXPECT_EQ(notes.numbers.cell.size(), 48u);
  EXPECT_THAT(notes.warnings, IsEmpty());
  if (GetParam().format == "vega" || GetParam().format == "abaqus") {
    EXPECT_EQ(notes.materials.at(1).young, 1e6);
    EXPECT_EQ(notes.materials.at(2).name, "rubber");
  }
}

TEST_P(EveryFormat, IsKnownByItsContentWhateverItsName) {
  if (GetParam().extension == ".node") return;  // TetGen files have no mark of their own
  EXPECT_EQ(read_tet_mesh(write(GetParam().bytes, test_folder() / (GetParam().format + ".dat"))).num_cells(), 48);
}

TEST_P(EveryFormat, RefusesAFileThatEndsTooEarlyOrLosesNothing) {
  if (GetParam().format == "abaqus") GTEST_SKIP() << "files of Abaqus do not say how much they hold";
  const TetMesh expected = two_regions();
  const std::string& bytes = GetParam().bytes;
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97) {
    MeshFile cut = GetParam();
    cut.bytes = bytes.substr(0, size);
    try {  // what follows the cells, such as cell data, may be lost
      const TetMesh mesh = read_tet_mesh(write(cut, test_folder()));
      EXPECT_TRUE(is_same(mesh.nodes, expected.nodes)) << size;
      EXPECT_EQ(mesh.cells, expected.cells) << size;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(cut.format)) << size;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Mesh, EveryFormat, testing::ValuesIn(in_every_format(two_regions())),
                         [](const auto& test) { return test.param.format; });

TEST(ReadTetMesh, FindsTheTetgenPairByEitherNameAndByTheStem) {
  const TetMesh expected = two_regions();
  for (const MeshFile& file : in_every_format(expected))
    if (file.format == "tetgen_from_1") write(file, test_folder());
  for (const char* name : {"tetgen_from_1.node", "tetgen_from_1.ele", "tetgen_from_1"})
    EXPECT_EQ(read_tet_mesh(test_folder() / name).cells, expected.cells) << name;
  std::filesystem::remove(test_folder() / "lonely.ele");
  EXPECT_THAT(refusal("4 3 0 0\n", "lonely.node"), HasSubstr("lonely.ele: cannot be read"));
}

TEST(ReadTetMesh, KeepsTheNumbersOfTheFileWhenNodesAreDropped) {
  MeshNotes notes;
  const TetMesh mesh = read_tet_mesh(write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n"
                                           "50 9 9 9\n40 0 0 0\n30 1 0 0\n7 nan 0 0\n20 0 1 0\n10 0 0 1\n$EndNodes\n"
                                           "$Elements\n1\n77 4 0 40 30 20 10\n$EndElements\n",
                                           test_folder() / "numbers.msh"),
                                     &notes);
  EXPECT_THAT(notes.numbers.node, ElementsAre(40, 30, 20, 10));
  EXPECT_THAT(notes.numbers.cell, ElementsAre(77));
  EXPECT_THAT(notes.warnings, ElementsAre("2 nodes belong to no tet: dropped"));
  EXPECT_THAT(mesh.region, IsEmpty());
  EXPECT_NEAR(tet_volume(mesh, 0), 1.0 / 6, 1e-15);
}

TEST(ReadTetMesh, ReadsSeveralPiecesOfAVtuAsOneMesh) {
  std::string text;
  for (const MeshFile& file : in_every_format(two_regions()))
    if (file.format == "vtu_ascii") text = file.bytes;
  const std::size_t begin = text.find("<Piece"), end = text.find("</UnstructuredGrid>");
  text.insert(end, text.substr(begin, end - begin));
  MeshNotes notes;
  const TetMesh mesh = read_tet_mesh(write(text, test_folder() / "pieces.vtu"), &notes);
  EXPECT_EQ(mesh.num_nodes(), 54);
  EXPECT_EQ(mesh.num_cells(), 96);
  EXPECT_EQ(mesh.region.size(), 96u);
  EXPECT_EQ(notes.numbers.cell.back(), 95);
  EXPECT_THAT(notes.warnings,
              ElementsAre("27 nodes lie where another node is: not merged", "2 components that are not connected"));
}

TEST(ReadTetMesh, ReadsWhatWriteVtuWrites) {
  const TetMesh expected = two_regions();
  RowMatrix region(expected.num_cells(), 1);
  for (Index e = 0; e < expected.num_cells(); ++e) region(e, 0) = expected.region[e];
  const std::filesystem::path path = test_folder() / "written.vtu";
  write_vtu(path, expected.nodes, expected.cells, {.cell_data = {{"region", region}}});
  const TetMesh mesh = read_tet_mesh(path);
  EXPECT_TRUE(is_same(mesh.nodes, expected.nodes));
  EXPECT_EQ(mesh.cells, expected.cells);
  EXPECT_EQ(mesh.region, expected.region);
}

TEST(ReadTetMesh, SkipsAByteOrderMark) {
  const TetMesh expected = two_regions();
  for (MeshFile file : in_every_format(expected)) {
    if (file.format.find("binary") != std::string::npos) continue;
    SCOPED_TRACE(file.format);
    file.bytes.insert(0, "\xef\xbb\xbf");
    if (!file.ele_bytes.empty()) file.ele_bytes.insert(0, "\xef\xbb\xbf");
    const TetMesh mesh = read_tet_mesh(write(file, test_folder()));
    EXPECT_TRUE(is_same(mesh.nodes, expected.nodes));
    EXPECT_EQ(mesh.cells, expected.cells);
  }
}

/// Four nodes of one tet, and the number of its entity as a part.
std::string partitioned(const std::string& volume, const std::string& part) {
  return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 9 \"skin\"\n3 20 \"steel\"\n$EndPhysicalNames\n"
         "$Entities\n0 0 0 1\n1 0 0 0 1 1 1 " +
         volume +
         " 0\n$EndEntities\n$PartitionedEntities\n3\n1\n7 2\n1 0 0 2\n5 3 1 1 1 0 0 0 0\n"
         "3 3 1 1 1 0 0 0 1 1 1 " +
         part + " 1 -4\n4 3 1 2 1 2 0 0 0 1 1 1 " + part +
         " 0\n$EndPartitionedEntities\n$Nodes\n1 4 1 4\n3 3 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
         "$Elements\n1 1 1 1\n3 3 4 1\n1 1 2 3 4\n$EndElements\n";
}

TEST(ReadTetMesh, KnowsThePhysicalGroupsOfPartitionedGmshMeshes) {
  for (const auto& [volume, part] : {std::pair("1 20", "1 20"), std::pair("1 20", "0")}) {  // its own, its parent's
    const TetMesh mesh = read_tet_mesh(write(partitioned(volume, part), test_folder() / "parts.msh"));
    EXPECT_THAT(mesh.region, ElementsAre(20));
    EXPECT_EQ(mesh.region_names.at(20), "steel");
  }
}

/// Two tets; the first is in the groups 20 and 30, the second in 30.
std::string two_groups(const std::string& version) {
  const std::string head = "$MeshFormat\n" + version +
                           " 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 20 \"left\"\n3 30 "
                           "\"everything\"\n$EndPhysicalNames\n";
  if (version == "2.2")
    return head +
           "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -1\n$EndNodes\n$Elements\n3\n"
           "1 4 2 20 1 1 2 3 4\n2 4 2 30 1 1 2 3 4\n3 4 2 30 2 1 3 2 5\n$EndElements\n";
  return head +
         "$Entities\n0 0 0 2\n1 0 0 0 1 1 1 2 20 30 0\n2 0 0 0 1 1 1 1 30 0\n$EndEntities\n$Nodes\n1 5 1 5\n3 1 0 "
         "5\n1\n2\n"
         "3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 -1\n$EndNodes\n$Elements\n2 2 1 2\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 1 "
         "3 2 5\n"
         "$EndElements\n";
}

TEST(ReadTetMesh, KeepsEveryGroupOfCellsThatAreInSeveral) {
  for (const char* version : {"2.2", "4.1"}) {
    SCOPED_TRACE(version);
    const TetMesh mesh = read_tet_mesh(write(two_groups(version), test_folder() / "groups.msh"));
    ASSERT_EQ(mesh.num_cells(), 2);
    EXPECT_THAT(regions_of_tag(mesh, mesh.region[0]), ElementsAre(20, 30));
    EXPECT_THAT(regions_of_tag(mesh, mesh.region[1]), ElementsAre(30));
    EXPECT_THAT(all_regions(mesh), ElementsAre(20, 30));
    EXPECT_EQ(nodes_of_region(mesh, "everything").size(), 5u);
    EXPECT_EQ(nodes_of_region(mesh, "left").size(), 4u);
    EXPECT_EQ(nodes_of_region(mesh, "20").size(), 4u);
  }
}

TEST(ReadTetMesh, KnowsWhereNodesStandInAFileThatListsMore) {
  const std::string text =
      "MeshVersionFormatted 1\nDimension 3\nVertices\n7\n9 9 9 0\n0 0 0 0\n1 0 0 0\n8 8 8 0\n0 1 0 0\n"
      "0 0 1 0\n7 7 7 0\nTetrahedra\n1\n2 3 5 6 0\n";
  const TetMesh mesh = read_tet_mesh(write(text, test_folder() / "more.mesh"));
  EXPECT_THAT(mesh.places.of_node, ElementsAre(1, 2, 4, 5));
  EXPECT_EQ(mesh.places.count, 7);
  EXPECT_EQ(mesh.places.node(4), 2);
  EXPECT_EQ(mesh.places.node(3), -1);
  EXPECT_THAT(read_node_set(mesh.nodes, write("4\n0\n1\n", test_folder() / "list.txt"), mesh.places),
              ElementsAre(0, 2));
  EXPECT_THROW(read_node_set(mesh.nodes, write("7\n", test_folder() / "list.txt"), mesh.places), InputError);
  EXPECT_THROW(read_node_set(mesh.nodes, write("0\n3\n", test_folder() / "list.txt"), mesh.places), InputError);
  const auto labels = write("5\n5\n1\n5\n5\n1\n5\n", test_folder() / "labels.txt");
  EXPECT_THAT(nodes_with_label(mesh.nodes, labels, 5, mesh.places), ElementsAre(0, 2));
  EXPECT_THROW(nodes_with_label(mesh.nodes, write("5\n5\n5\n5\n", test_folder() / "labels.txt"), 5, mesh.places),
               InputError);
  EXPECT_TRUE(two_regions().places.of_node.empty());
}

TEST(ReadTetMesh, FollowsWhatAVegaFileIncludesAndItsMaterials) {
  const std::filesystem::path folder = test_folder() / "vega";
  std::filesystem::create_directories(folder / "sets");
  write("*VERTICES\n5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -1\n", folder / "nodes.txt");
  write("1,\n*INCLUDE deeper.txt # of the same folder\n", folder / "sets/one.txt");
  write("2\n", folder / "sets/deeper.txt");
  const std::string head =
      "*INCLUDE nodes.txt\n*ELEMENTS\nTET\n2 4 0\n1 1 2 3 4\n2 1 3 2 5\n"
      "*MATERIAL hard stuff\nENU, 1800, 2e7, 0.45\n*MATERIAL gum\nMOONEYRIVLIN, 900, 10, 20, 300\n"
      "*MATERIAL odd\nOGDEN, 1, 2, 3\n*SET both of them\n*INCLUDE sets/one.txt\n*SET last\n2\n";
  MeshNotes notes;
  const TetMesh mesh =
      read_tet_mesh(write(head + "*REGION\nboth of them, hard stuff\n*REGION\nlast, gum\n", folder / "a.veg"), &notes);
  EXPECT_THAT(mesh.region, ElementsAre(1, 2));  // later regions win
  EXPECT_EQ(mesh.region_names.at(1), "both of them");
  EXPECT_EQ(notes.materials.at(1).young, 2e7);
  EXPECT_EQ(notes.materials.at(1).poisson, 0.45);
  EXPECT_EQ(notes.materials.at(2).law, "mooney-rivlin");
  EXPECT_EQ(notes.materials.at(2).density, 900);
  EXPECT_EQ(notes.materials.at(2).parameters, (std::map<std::string, double>{{"c01", 10}, {"c10", 20}, {"bulk", 600}}));
  EXPECT_THAT(notes.warnings, ElementsAre(HasSubstr("material odd is of the kind OGDEN")));

  const auto refusal_of = [&](const std::string& text) {
    try {
      read_tet_mesh(write(text, folder / "b.veg"));
      return std::string();
    } catch (const InputError& error) {
      return std::string(error.what());
    }
  };
  EXPECT_THAT(refusal_of(head + "*REGION\nlast, rubber\n"), HasSubstr("the material rubber, which does not exist"));
  EXPECT_THAT(refusal_of(head + "*REGION\nlist, gum\n"), HasSubstr("the set list, which does not exist"));
  EXPECT_THAT(refusal_of("*INCLUDE none.txt\n"), HasSubstr("none.txt"));
  EXPECT_THAT(refusal_of("*INCLUDE b.veg\n"), HasSubstr("include each other"));
}

TEST(ReadTetMesh, TellsRegionsOfRealAttributesApart) {
  const std::string nodes = "5 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 0 0 -1\n";
  const auto read = [&](const std::string& a, const std::string& b) {
    write(nodes, test_folder() / "real.node");
    return read_tet_mesh(write("2 4 1\n1 1 2 3 4 " + a + "\n2 1 3 2 5 " + b + "\n", test_folder() / "real.ele"));
  };
  EXPECT_THAT(read("3", "-2.0").region, ElementsAre(3, -2));
  const TetMesh real = read("1.5", "1");
  EXPECT_THAT(real.region, ElementsAre(2, 1));
  EXPECT_EQ(real.region_names, (std::map<int, std::string>{{1, "1"}, {2, "1.5"}}));
  EXPECT_THAT(read("0.25", "nan").region, ElementsAre(1, 0));
}

TEST(ReadTetMesh, AcceptsWhatNumbersMayLookLike) {
  const auto read = [](const std::string& x) {
    return read_tet_mesh(write("MeshVersionFormatted 1\nDimension 3 Vertices 4 0 0 0 0 " + x +
                                   " 0 0 0 0 1 0 0 0 0 1 0 Tetrahedra 1 1 2 3 4 0",
                               test_folder() / "numbers.mesh"))
        .nodes(1, 0);
  };
  EXPECT_EQ(read("+1.5e0"), 1.5);
  EXPECT_EQ(read("1E-3"), 1e-3);
  EXPECT_EQ(read(".5"), 0.5);
  EXPECT_THROW(read("1.5f"), InputError);
  EXPECT_THROW(read("0x1"), InputError);
  EXPECT_THROW(read("1e400"), InputError);
  EXPECT_THROW(read("1,5"), InputError);
}

TEST(ReadTetMesh, NamesFileAndLineOfWhatItCannotRead) {
  const std::string head = "MeshVersionFormatted 1\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n";
  EXPECT_THAT(refusal(head + "Tetrahedra\n1\n1 2 3 5 0\n", "a.mesh"),
              HasSubstr("a.mesh:11: node 5 does not exist: nodes are numbered 1 … 4"));
  EXPECT_THAT(refusal(head + "Tetrahedra\n1\n1 2 x 4 0\n", "a.mesh"),
              HasSubstr("a.mesh:11: expected a node number, found \"x\""));
  EXPECT_THAT(refusal(head + "Tetrahedra\n99999999999\n1 2 3 4 0\n", "a.mesh"),
              HasSubstr("a.mesh:10: announces 99999999999 tetrahedra, but the 11 bytes that follow cannot hold them"));
  EXPECT_THAT(refusal(head + "Tetrahedra\n-1\n", "a.mesh"), HasSubstr("number of tetrahedra is negative"));
  EXPECT_THAT(refusal(head, "a.mesh"), HasSubstr("a.mesh: holds no tetrahedra"));
  EXPECT_THAT(refusal(head + "Tetrahedra\n1\n1 2 3 3 0\n", "a.mesh"), HasSubstr("tet 1 names node 3 twice"));
  EXPECT_THAT(refusal(head + "Hexahedra\n1\n1 2 3 4 1 2 3 4 0\n", "a.mesh"),
              HasSubstr("holds 1 hexahedron; only tetrahedra"));
}

TEST(ReadTetMesh, NamesFormatsThatItDoesNotRead) {
  EXPECT_THAT(refusal("", "empty.msh"), HasSubstr("the file is empty"));
  EXPECT_THAT(refusal("\x1f\x8b\x08", "mesh.msh.gz"), HasSubstr("compressed (gzip)"));
  EXPECT_THAT(refusal(std::string("\1\0\0\0\3\0\0\0", 8), "mesh.meshb"), HasSubstr("save it as ASCII .mesh"));
  EXPECT_THAT(refusal("$NOD\n4\n", "old.msh"), HasSubstr("Gmsh format 1"));
  EXPECT_THAT(refusal("ply\nformat ascii 1.0\n", "surface.ply"), HasSubstr("triangle surface (ply)"));
  EXPECT_THAT(refusal("hello", "hello.txt"), HasSubstr("Gmsh .msh (2.2, 4.0, 4.1), Abaqus .inp, Medit .mesh"));
  EXPECT_THAT(refusal("<?xml version=\"1.0\"?><VTKFile type=\"PolyData\"/>", "surface.vtu"), HasSubstr("PolyData"));
  EXPECT_THAT(refusal("# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n", "s.vtk"), HasSubstr("POLYDATA"));
  EXPECT_THROW(read_tet_mesh(test_folder() / "absent.msh"), InputError);
  EXPECT_THROW(read_tet_mesh(test_folder()), InputError);
  EXPECT_THROW(read_tet_mesh(std::string(5000, 'a')), InputError);
}

TEST(CheckMesh, AcceptsAMeshWhateverItsScaleAndPlace) {
  for (const double scale : {1e-9, 1.0, 1e9})
    for (const double shift : {0.0, 1e6}) {
      TetMesh mesh = builtin_mesh("cube:2");
      mesh.nodes = (scale * (mesh.nodes.array() + shift)).matrix();
      EXPECT_NO_THROW(check_mesh(mesh)) << scale << " " << shift;
    }
}

}  // namespace
}  // namespace supple::test
