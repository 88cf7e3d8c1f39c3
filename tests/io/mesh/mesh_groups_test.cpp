// Groups of faces, edges and nodes that files name beside their cells.

#include <core/check.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <io/mesh/node_sets.hpp>
#include <tests/io/mesh_files.hpp>

#include <gmock/gmock.h>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

/// Nodes and faces of a group.
auto is_group(const std::vector<Index>& nodes, const std::vector<FaceCorners>& faces = {}) {
  return NodeGroup{nodes, faces};
}

const char* const two_tets =  // node 9 belongs to no cell and comes first
    "$Nodes\n6\n9 5 5 5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n";

TEST(NodeGroups, AreThePhysicalGroupsOfGmsh2) {
  const TetMesh mesh = read_tet_mesh(
      write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 7 \"left face\"\n3 1 \"body\"\n1 7 \"edge\"\n"
            "$EndPhysicalNames\n" +
                std::string(two_tets) +
                "$Elements\n7\n1 2 2 7 1 1 3 4\n2 2 2 8 1 1 2 3\n3 1 2 7 1 2 3\n4 15 2 5 1 9\n5 15 2 5 1 4\n"
                "6 4 2 1 1 1 2 3 4\n7 4 2 1 1 2 3 4 5\n$EndElements\n",
            test_folder() / "groups.msh"));
  EXPECT_THAT(mesh.node_groups,
              ElementsAre(Pair("edge", is_group({1, 2})), Pair("left face", is_group({0, 2, 3}, {{0, 2, 3, -1}})),
                          Pair("point 5", is_group({3})), Pair("surface 8", is_group({0, 1, 2}, {{0, 1, 2, -1}}))));
  EXPECT_THAT(nodes_of_region(mesh, "left face"), ElementsAre(0, 2, 3));
  EXPECT_THAT(nodes_of_region(mesh, "body"), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(nodes_of_region(mesh, "1"), ElementsAre(0, 1, 2, 3, 4));
  try {
    nodes_of_region(mesh, "right face");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("edge, left face, point 5, surface 8"));
  }
}

TEST(NodeGroups, AreThePhysicalGroupsOfEntitiesInGmsh4) {
  // surface 3 is in the groups 7 and 8, volume 1 in group 1, whose numbers say nothing of each other
  const TetMesh mesh = read_tet_mesh(write(
      "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 7 \"left face\"\n3 7 \"body\"\n$EndPhysicalNames\n"
      "$Entities\n0 0 1 1\n3 0 0 0 0 1 1 2 7 8 0\n3 0 0 0 1 1 1 1 7 1 3\n$EndEntities\n"
      "$Nodes\n1 4 1 4\n3 3 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n$EndNodes\n"
      "$Elements\n2 2 1 2\n2 3 2 1\n1 1 3 4\n3 3 4 1\n2 1 2 3 4\n$EndElements\n",
      test_folder() / "groups41.msh"));
  EXPECT_THAT(mesh.node_groups, ElementsAre(Pair("left face", is_group({0, 2, 3}, {{0, 2, 3, -1}})),
                                            Pair("surface 8", is_group({0, 2, 3}, {{0, 2, 3, -1}}))));
  EXPECT_THAT(mesh.region_names, ElementsAre(Pair(7, "body")));
}

TEST(NodeGroups, AreTheReferencesOfMedit) {
  const TetMesh mesh = read_tet_mesh(
      write("MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 0\n1 0 0 4\n0 1 0 0\n0 0 1 4\nEdges\n1\n1 2 6\n"
            "Triangles\n2\n1 3 4 2\n1 2 3 0\nTetrahedra\n1\n1 2 3 4 1\nEnd\n",
            test_folder() / "groups.mesh"));
  EXPECT_THAT(mesh.node_groups, ElementsAre(Pair("curve 6", is_group({0, 1})), Pair("point 4", is_group({1, 3})),
                                            Pair("surface 2", is_group({0, 2, 3}, {{0, 2, 3, -1}}))));
}

TEST(NodeGroups, AreTheBoundaryMarkersOfTetgen) {
  write("1 4 0\n1 1 2 3 4\n", test_folder() / "groups.ele");
  const TetMesh mesh = read_tet_mesh(
      write("4 3 1 1\n1 0 0 0 0.5 2\n2 1 0 0 0.5 0\n3 0 1 0 0.5 2\n4 0 0 1 0.5 -1\n", test_folder() / "groups.node"));
  EXPECT_THAT(mesh.node_groups, ElementsAre(Pair("marker -1", is_group({3})), Pair("marker 2", is_group({0, 2}))));
}

// Tools drop nodes that no cell has and leave faces that name them.
TEST(NodeGroups, LeaveOutFacesThatNameNoNode) {
  MeshNotes notes;
  const TetMesh mesh =
      read_tet_mesh(write("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + std::string(two_tets) +
                              "$Elements\n3\n1 2 2 7 1 1 3 77\n2 2 2 7 1 1 2 3\n6 4 2 1 1 1 2 3 4\n$EndElements\n",
                          test_folder() / "broken.msh"),
                    &notes);
  EXPECT_THAT(mesh.node_groups, ElementsAre(Pair("surface 7", is_group({0, 1, 2}, {{0, 1, 2, -1}}))));
  EXPECT_THAT(notes.warnings, testing::Contains(HasSubstr("1 elements of groups")));
}

// What other programs write there says nothing of a solid, and refuses none.
TEST(NodeGroups, OfMeditTakeWhatIsAsTheFormatSays) {
  const std::string begin = "MeshVersionFormatted 2\nDimension 3\n",
                    vertices = "Vertices\n4\n0 0 0 0\n1 0 0 0.5\n0 1 0 nan\n0 0 1 1e300\n",
                    tets = "Tetrahedra\n1\n1 2 3 4 1\nEnd\n";
  for (const std::string triangles :
       {"Triangles\n1\n1 2 3\n", "Triangles\n1\n1 2 9 7\n", "Triangles\n1\n1 2 3 0.5\n", "Triangles\n2\n1 2 3 7\n"})
    for (const bool first : {true, false}) {
      const TetMesh mesh = read_tet_mesh(
          write(begin + (first ? triangles + vertices : vertices + triangles) + tets, test_folder() / "odd.mesh"));
      EXPECT_EQ(mesh.num_cells(), 1) << triangles;
      EXPECT_TRUE(mesh.node_groups.empty()) << triangles;
    }
  const TetMesh real =
      read_tet_mesh(write(begin + vertices + "Triangles\n1\n1 2 3 7.0\n" + tets, test_folder() / "real.mesh"));
  EXPECT_THAT(real.node_groups, ElementsAre(Pair("surface 7", is_group({0, 1, 2}, {{0, 1, 2, -1}}))));
}

}  // namespace
}  // namespace supple::test
