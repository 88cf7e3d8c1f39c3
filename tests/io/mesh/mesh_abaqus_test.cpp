#include <core/check.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <tests/io/mesh_files.hpp>

#include <gmock/gmock.h>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Pair;

/// Two tets that share a face, and a triangle on one of them.
const std::string mesh_part =
    "*HEADING\nTwo tets\n**\n*NODE, NSET=Nall\n1, 0, 0, 0\n2, 1., 0, 0\n3, 0, 1, 0\n4, 0, 0, 1.e0\n7, +1, 1, 1\n"
    "*ELEMENT, TYPE=C3D4, ELSET=lower\n11, 1, 2, 3, 4\n*Element, type=C3D4H, elset=Upper\n12, 2, 3, 4, 7\n"
    "*ELEMENT, TYPE=S3, ELSET=Skin\n20, 1, 2, 3\n";

TetMesh read_inp(const std::string& text, MeshNotes* notes = nullptr) {
  return read_tet_mesh(write(text, test_folder() / "mesh.inp"), notes);
}
std::string inp_refusal(const std::string& text) {
  try {
    read_inp(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Abaqus, GivesRegionsMaterialsGroupsAndSupports) {
  MeshNotes notes;
  const TetMesh mesh =
      read_inp(mesh_part +
                   "*NSET, NSET=Corner\n1, 7\n*NSET, NSET=Run, GENERATE\n2, 4, 2\n*NSET, NSET=Both\nCORNER, Run, 3\n"
                   "*NSET, NSET=Face, ELSET=Skin\n*ELSET, ELSET=All\nlower, UPPER\n"
                   "*SOLID SECTION, ELSET=LOWER, MATERIAL=Steel\n,\n*SOLID SECTION, ELSET=upper, MATERIAL=rubber\n"
                   "*MATERIAL, NAME=STEEL\n*ELASTIC\n210e9, 0.3\n*DENSITY\n7850.\n"
                   "*MATERIAL, NAME=Rubber\n*HYPERELASTIC, MOONEY-RIVLIN\n1e5, 2e4, 1e-6\n*DENSITY\n1100\n"
                   "*BOUNDARY\nCorner, 1, 2\n4, ENCASTRE\n3, 3, 6\n2, ZSYMM\n",
               &notes);
  EXPECT_EQ(notes.format, "Abaqus");
  EXPECT_EQ(mesh.num_cells(), 2);
  EXPECT_THAT(notes.numbers.node, ElementsAre(1, 2, 3, 4, 7));
  EXPECT_THAT(notes.numbers.cell, ElementsAre(11, 12));
  EXPECT_THAT(mesh.region, ElementsAre(1, 2));
  EXPECT_THAT(mesh.region_names, ElementsAre(Pair(1, "lower"), Pair(2, "Upper")));
  EXPECT_THAT(mesh.node_groups,
              ElementsAre(Pair("All", NodeGroup{{0, 1, 2, 3, 4}, {}}), Pair("Both", NodeGroup{{0, 1, 2, 3, 4}, {}}),
                          Pair("Corner", NodeGroup{{0, 4}, {}}), Pair("Face", NodeGroup{{0, 1, 2}, {}}),
                          Pair("Nall", NodeGroup{{0, 1, 2, 3, 4}, {}}), Pair("Run", NodeGroup{{1, 3}, {}}),
                          Pair("Skin", NodeGroup{{0, 1, 2}, {{0, 1, 2, -1}}})));
  EXPECT_EQ(notes.materials.at(1).young, 210e9);
  EXPECT_EQ(notes.materials.at(1).poisson, 0.3);
  EXPECT_EQ(notes.materials.at(1).density, 7850);
  EXPECT_EQ(notes.materials.at(2).law, "mooney-rivlin");
  EXPECT_THAT(notes.materials.at(2).parameters, ElementsAre(Pair("bulk", 2e6), Pair("c01", 2e4), Pair("c10", 1e5)));
  const std::vector<HeldAxes> held{{0, 3}, {1, 4}, {2, 4}, {3, 7}, {4, 3}};
  EXPECT_EQ(notes.held, held);
  EXPECT_THAT(notes.warnings, IsEmpty());
}

TEST(Abaqus, FollowsIncludesAndIsKnownWithoutItsExtension) {
  write("*ELASTIC\n1e6, 0.4\n*Density\n900,\n", test_folder() / "rubber.txt");
  MeshNotes notes;
  const std::string text = mesh_part +
                           "*Elset, elset=all\nlower, upper\n*Solid Section, elset=all, material=m\n*Material, "
                           "name=m\n*Include, Input=rubber.txt\n";
  const TetMesh mesh = read_tet_mesh(write(text, test_folder() / "mesh.dat"), &notes);
  EXPECT_EQ(notes.materials.at(1).density, 900);
  EXPECT_THAT(mesh.region, ElementsAre(1, 1));
}

TEST(Abaqus, WarnsOfWhatItDoesNotRead) {
  MeshNotes notes;
  read_inp(mesh_part +
               "*MATERIAL, NAME=m\n*ELASTIC, TYPE=ORTHOTROPIC\n1, 2\n*ELSET, ELSET=a\nlower, upper\n"
               "*SOLID SECTION, ELSET=a, MATERIAL=m\n*STEP\n*STATIC\n*CLOAD\n7, 1, 100\n*BOUNDARY\n7, 1, 1, 0.5\n*END "
               "STEP\n",
           &notes);
  EXPECT_THAT(notes.warnings, testing::Contains(HasSubstr("ORTHOTROPIC is not read")));
  EXPECT_THAT(notes.warnings, testing::Contains(HasSubstr("*CLOAD is not read")));
  EXPECT_THAT(notes.warnings, testing::Contains(HasSubstr("*BOUNDARY with displacements is not read")));
  EXPECT_THAT(notes.materials, IsEmpty());
  EXPECT_THAT(notes.held, IsEmpty());
}

TEST(Abaqus, RefusesWhatItCannotTakeWithTheLine) {
  EXPECT_THAT(inp_refusal(mesh_part + "*NODE\n1, 0, 0, 0\n"), HasSubstr("mesh.inp:17: node 1 is there twice"));
  EXPECT_THAT(inp_refusal(mesh_part + "*ELEMENT, TYPE=C3D4\n11, 1, 2, 3, 7\n"), HasSubstr("element 11 is there twice"));
  EXPECT_THAT(inp_refusal(mesh_part + "*ELEMENT, TYPE=C3D4\n13, 1, 2, 3\n"), HasSubstr("4 nodes of C3D4"));
  EXPECT_THAT(inp_refusal(mesh_part + "*ELEMENT, TYPE=C3D4\n13, 1, 2, 3, 99\n"), HasSubstr("there is no node 99"));
  EXPECT_THAT(inp_refusal(mesh_part + "*ELEMENT, TYPE=C3D20\n13, 1, 2, 3, 4\n"), HasSubstr("elements of kind C3D20"));
  EXPECT_THAT(inp_refusal(mesh_part + "*ELEMENT\n13, 1, 2, 3, 4\n"), HasSubstr("expected TYPE="));
  EXPECT_THAT(inp_refusal(mesh_part + "*NSET, NSET=a\nnowhere\n"), HasSubstr("names the set nowhere"));
  EXPECT_THAT(inp_refusal(mesh_part + "*NSET, NSET=a, GENERATE\n1, 7, 0\n"), HasSubstr("first, last and step"));
  EXPECT_THAT(inp_refusal(mesh_part + "*BOUNDARY\nnowhere, 1\n"), HasSubstr("there is no node set nowhere"));
  EXPECT_THAT(inp_refusal(mesh_part + "*BOUNDARY\n1, left\n"), HasSubstr("expected a degree of freedom"));
  EXPECT_THAT(inp_refusal(mesh_part + "*SOLID SECTION, ELSET=lower, MATERIAL=m\n"),
              HasSubstr("there is no material m"));
  EXPECT_THAT(inp_refusal(mesh_part + "*ELASTIC\n1, 2\n"), HasSubstr("belongs to no *MATERIAL"));
  EXPECT_THAT(inp_refusal("*NODE\n1, 0, zero, 0\n"), HasSubstr("mesh.inp:2: expected a coordinate, found \"zero\""));
  EXPECT_THAT(inp_refusal("*HEADING\nnothing\n"), HasSubstr("expected a section *NODE"));
  EXPECT_THAT(inp_refusal("*PART, NAME=p\n" + mesh_part + "*INSTANCE, NAME=i, PART=p\n1, 0, 0\n*END INSTANCE\n"),
              HasSubstr("the instance is moved"));
}

}  // namespace
}  // namespace supple::test
