#include <core/check.hpp>
#include <io/surface/surface_reader.hpp>
#include <testing/near.hpp>
#include <tests/io/surface_files.hpp>
#include <tests/support/meshes.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace supple::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// 24 triangles whose coordinates need all their digits.
TriangleMesh sheet() {
  return perturbed(equilateral_grid(4, 3), 0.02, 5);
}
/// The same, of numbers of 32 bits.
TriangleMesh float_sheet() {
  TriangleMesh mesh = sheet();
  mesh.nodes = mesh.nodes.cast<float>().cast<double>();
  return mesh;
}
/// The corners of all triangles, one a row.
Points corners(const TriangleMesh& mesh) {
  Points result(3 * mesh.num_triangles(), 3);
  for (Index t = 0; t < mesh.num_triangles(); ++t)
    for (int k = 0; k < 3; ++k) result.row(3 * t + k) = mesh.nodes.row(mesh.triangles[t][k]);
  return result;
}
bool is_stl(const MeshFile& file) {
  return file.extension == ".stl";
}

TriangleMesh read(const std::string& bytes, const std::string& name, MeshNotes* notes = nullptr) {
  return read_triangle_mesh(write(bytes, test_folder() / name), notes);
}
/// The message with which a file of these bytes is refused; empty if it is read.
std::string refusal(const std::string& bytes, const std::string& name) {
  try {
    read(bytes, name);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

class EverySurfaceFormat : public testing::TestWithParam<std::tuple<MeshFile, MeshFile>> {
 protected:
  const MeshFile& exact() const { return std::get<0>(GetParam()); }   // of sheet()
  const MeshFile& floats() const { return std::get<1>(GetParam()); }  // of float_sheet()
};

TEST_P(EverySurfaceFormat, KeepsEveryBitAndTheOrder) {
  for (const auto& [file, expected] : {std::pair{floats(), float_sheet()}, {exact(), sheet()}}) {
    if (&file != &floats() && file.format.find("float") != std::string::npos &&
        !is_same(expected.nodes, float_sheet().nodes))
      continue;
    MeshNotes notes;
    const TriangleMesh mesh = read_triangle_mesh(write(file, test_folder()), &notes);
    EXPECT_TRUE(is_same(corners(mesh), corners(expected)));
    EXPECT_EQ(mesh.num_nodes(), 20);
    EXPECT_EQ(notes.numbers.node.size(), 20u);
    EXPECT_EQ(notes.numbers.triangle.size(), 24u);
    if (is_stl(file)) {
      EXPECT_THAT(notes.warnings, ElementsAre("72 corners merged to 20 nodes by their exact positions, as STL "
                                              "has none of its own"));
    } else {
      EXPECT_TRUE(is_same(mesh.nodes, expected.nodes));
      EXPECT_EQ(mesh.triangles, expected.triangles);
      EXPECT_THAT(notes.warnings, IsEmpty());
    }
  }
}

TEST_P(EverySurfaceFormat, IsKnownByItsContentWhateverItsName) {
  EXPECT_EQ(read(floats().bytes, "surface.dat").num_triangles(), 24);
}

TEST_P(EverySurfaceFormat, RefusesAFileThatEndsTooEarlyOrLosesWholeFacesOnly) {
  const TriangleMesh expected = float_sheet();
  const std::string& bytes = floats().bytes;
  for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 97) {
    MeshFile cut = floats();
    cut.bytes = bytes.substr(0, size);
    try {  // OBJ does not say how many faces there are
      const TriangleMesh mesh = read_triangle_mesh(write(cut, test_folder()));
      EXPECT_TRUE(cut.extension == ".obj" || mesh.num_triangles() == 24) << size;
      EXPECT_LE(mesh.num_triangles(), 24) << size;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(cut.format)) << size;
    }
  }
}

std::vector<std::tuple<MeshFile, MeshFile>> both_sheets() {
  const std::vector<MeshFile> exact = in_every_format(sheet()), floats = in_every_format(float_sheet());
  std::vector<std::tuple<MeshFile, MeshFile>> result;
  for (std::size_t k = 0; k < exact.size(); ++k) result.emplace_back(exact[k], floats[k]);
  return result;
}
INSTANTIATE_TEST_SUITE_P(Surface, EverySurfaceFormat, testing::ValuesIn(both_sheets()),
                         [](const auto& test) { return std::get<0>(test.param).format; });

TEST(ReadTriangleMesh, KeepsTheNumbersOfTheFileWhenNodesAreDropped) {
  MeshNotes notes;
  const std::string obj = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv nan 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 5 6\n";
  const TriangleMesh mesh = read(obj, "numbers.obj", &notes);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_THAT(notes.numbers.node, ElementsAre(2, 3, 5, 6));
  EXPECT_THAT(notes.numbers.triangle, ElementsAre(1, 1));
  EXPECT_THAT(notes.warnings,
              ElementsAre("1 polygon was cut into fans of triangles", "2 nodes belong to no triangle: dropped"));
  EXPECT_THAT(refusal(obj + "f 3 2 1\n", "numbers.obj"), IsEmpty());
  EXPECT_THAT(refusal(obj + "f 6 5 4\n", "numbers.obj"), HasSubstr("node 4 has a coordinate that is not finite"));
}

TEST(ReadTriangleMesh, CutsConcavePolygonsFromACornerThatSeesThemAll) {
  // an arrow head: only the reflex corner (1, 1) sees all
  const TriangleMesh mesh = read("OFF\n5 1 0\n0 0 0\n2 0 0\n2 2 0\n1 1 0\n0 2 0\n5 0 1 2 3 4\n", "arrow.off");
  double area = 0;
  for (Index t = 0; t < 3; ++t) area += triangle_area(mesh, t);
  EXPECT_NEAR(area, 3, 1e-15);
  // a comb, of which no corner sees all
  EXPECT_THAT(
      refusal("OFF\n8 1 0\n0 0 0\n5 0 0\n5 3 0\n4 1 0\n3 3 0\n2 1 0\n1 3 0\n0 1 0\n8 0 1 2 3 4 5 6 7\n", "comb.off"),
      HasSubstr("comb.off: face 0 has 8 corners, and from none"));
}

TEST(ReadTriangleMesh, TurnsTrianglesBackAndRefusesMoebiusStrips) {
  MeshNotes notes;
  const TriangleMesh mesh =
      read("OFF\n5 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 1 0\n3 0 1 2\n3 0 3 2\n3 1 4 2\n", "turned.off", &notes);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {1, 4, 2}}));
  EXPECT_THAT(notes.warnings, ElementsAre("1 triangle was turned over against the others: turned back"));
  // five triangles in a ring with a half twist: the smallest Möbius strip
  EXPECT_THAT(refusal("OFF\n5 5 0\n1 0 0\n0 1 1\n-1 0 0.3\n0 -1 1\n0.3 0.2 -1\n"
                      "3 0 1 2\n3 1 2 3\n3 2 3 4\n3 3 4 0\n3 4 0 1\n",
                      "moebius.off"),
              HasSubstr("moebius.off: the surface has only one side"));
}

TEST(ReadTriangleMesh, TellsOfWhatMaySurprise) {
  MeshNotes notes;
  read(
      "OFF\n10 4 0\n0 0 0\n1 0 0\n0 1 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n5 0 0\n6 0 0\n5 1e-5 0\n"
      "3 0 1 2\n3 3 5 4\n3 5 3 6\n3 7 8 9\n2 0 1\n",
      "soup.off", &notes);
  EXPECT_THAT(notes.warnings,
              ElementsAre("2 nodes lie where another node is: not merged", "3 components that are not connected",
                          HasSubstr("needles: the worst, triangle 3, has radius ratio")));
  read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv -1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 5\nl 1 2\np 3\nf 1 2\n", "pinched.obj", &notes);
  EXPECT_THAT(notes.warnings,
              ElementsAre("1 face has fewer than three corners: left out", "2 lines and points left out",
                          "parts hang together by 1 node only, about which they turn freely"));
}

TEST(ReadTriangleMesh, RefusesWithFilePlaceAndExpectation) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  EXPECT_THAT(refusal("", "a.off"), HasSubstr("a.off: the file is empty; expected a surface"));
  EXPECT_THAT(refusal("hello", "a.txt"), HasSubstr("not known"));
  EXPECT_THAT(refusal("$MeshFormat\n2.2 0 8\n", "a.msh"), HasSubstr("looks like a mesh of solids"));
  EXPECT_THAT(refusal("\x1f\x8b and so on", "a.ply"), HasSubstr("compressed"));
  // OBJ
  EXPECT_THAT(refusal(square, "a.obj"), HasSubstr("a.obj: holds no triangles"));
  EXPECT_THAT(refusal(square + "f 1 2 9\nf 1 2 3", "a.obj"), HasSubstr("a.obj:5: node 9 does not exist"));
  EXPECT_THAT(refusal(square + "f 1 2 -5\n", "a.obj"), HasSubstr("a.obj:5: node -5 does not exist"));
  EXPECT_THAT(refusal(square + "f 1 2 0\n", "a.obj"), HasSubstr("a.obj:5: expected a corner such as"));
  EXPECT_THAT(refusal(square + "f 1 2 x/1\n", "a.obj"), HasSubstr("found \"x/1\""));
  EXPECT_THAT(refusal("v 0 0\nf 1 1 1\n", "a.obj"), HasSubstr("a.obj:1: expected a coordinate"));
  EXPECT_THAT(refusal(square + "f 1 2 3\nf 4 2 3\nf 1 2 3\n", "a.obj"),
              HasSubstr("triangle 1 and triangle 3 have the same three nodes (numbers as in the file)"));
  EXPECT_THAT(refusal("f 1 2 3\n" + square, "a.obj"), IsEmpty()) << "nodes may follow the faces";
  // OFF
  EXPECT_THAT(refusal("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off"),
              HasSubstr("a.off:6: node 3 does not exist: nodes are numbered 0 … 2"));
  EXPECT_THAT(refusal("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n", "a.off"),
              HasSubstr("a.off:4: expected a coordinate, the line ends"));
  EXPECT_THAT(refusal("OFF\n99999999 1 0\n0 0 0\n", "a.off"), HasSubstr("announces 99999999 vertices"));
  EXPECT_THAT(refusal("4OFF\n3 1 0\n", "a.off"), HasSubstr("three dimensions"));
  EXPECT_THAT(refusal("OFF BINARY\n", "a.off"), HasSubstr("binary OFF"));
  // PLY
  const std::string vertices = "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  const std::string head = "ply\nformat ascii 1.0\n";
  const std::string body = "end_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n";
  EXPECT_THAT(refusal(head + vertices + faces + body, "a.ply"), IsEmpty());
  EXPECT_THAT(refusal(head + vertices + faces, "a.ply"), HasSubstr("expected end_header, the file ends"));
  EXPECT_THAT(refusal("ply\nformat text 1.0\n", "a.ply"), HasSubstr("a.ply:2: expected format ascii"));
  EXPECT_THAT(refusal(head + "element vertex 3\nproperty real x\n", "a.ply"), HasSubstr("expected a type"));
  EXPECT_THAT(refusal(head + "element vertex 3\nproperty float x\n" + faces + body, "a.ply"),
              HasSubstr("a.ply: element vertex has no number y"));
  EXPECT_THAT(refusal(head + vertices + "element face 1\nproperty int i\n" + body, "a.ply"),
              HasSubstr("no list of whole numbers vertex_indices"));
  EXPECT_THAT(refusal(head + vertices + "element tristrips 1\nproperty list int int vertex_indices\n" + body, "a.ply"),
              HasSubstr("holds no triangles"));
  EXPECT_THAT(refusal(head + "element vertex 4611686018427387904\nproperty float x\nend_header\n", "a.ply"),
              HasSubstr("announces 4611686018427387904 elements vertex"));
  EXPECT_THAT(refusal(head + vertices + faces + "end_header\n0 0 0 1 0 0 0 1 0 3 0 1 -2\n", "a.ply"),
              HasSubstr("node -2 does not exist"));
  // STL
  EXPECT_THAT(refusal("solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nendloop", "a.stl"),
              HasSubstr("a.stl:5: expected vertex, found \"endloop\""));
  EXPECT_THAT(refusal(std::string(80, ' ') + std::string("\3\0\0\0", 4) + std::string(50, '\0'), "a.stl"),
              HasSubstr("announces 3 facets"));
  EXPECT_THAT(refusal("too short", "a.stl"), HasSubstr("expected a header of 80 bytes"));
  EXPECT_THAT(refusal("solid empty\nendsolid empty\n", "a.stl"), HasSubstr("holds no triangles"));
}

TEST(ReadTriangleMesh, GoesOnBehindABackslashOfAnObjGluedOrNot) {
  const std::string tail = "v 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4\\\n 3\nf 2 1 \\\r\n\\\n 5\n";
  for (const std::string head : {"v 0 0 0\nv 1 \\\n 0 0\n", "v\\\n0 0 0\nv 1 0\\\r\n 0\n"}) {
    const TriangleMesh mesh = read(head + tail + "v 0 -1 0\n", "a.obj");
    EXPECT_EQ(mesh.num_triangles(), 3);
    EXPECT_EQ(mesh.num_nodes(), 5);
    EXPECT_EQ(mesh.nodes(1, 0), 1);
    EXPECT_EQ(mesh.triangles[2], (Triangle{1, 0, 4}));
  }
  // a comment does not go on: paths of another system may end so
  EXPECT_EQ(read("# C:\\objects\\\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "b.obj").num_nodes(), 3);
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1\n2 3\n", "c.obj"), HasSubstr("c.obj:5: expected a keyword"));
  EXPECT_THAT(refusal("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 x\n", "d.obj"), HasSubstr("d.obj:5: expected a corner"));
}

TEST(ReadTriangleMesh, SkipsAByteOrderMark) {
  for (const MeshFile& file : in_every_format(float_sheet())) {
    if (file.format.find("binary") != std::string::npos) continue;
    SCOPED_TRACE(file.format);
    const TriangleMesh mesh = read("\xef\xbb\xbf" + file.bytes, "with_mark.dat");
    EXPECT_TRUE(is_same(corners(mesh), corners(float_sheet())));
  }
}

TEST(ReadTriangleMesh, ReadsBinaryStlThatBeginsWithSolidOrGoesOn) {
  for (const MeshFile& file : in_every_format(float_sheet())) {
    if (!is_stl(file) || file.format.find("binary") == std::string::npos) continue;
    for (const std::string_view head : {"solid made by a program", "exported"})
      for (const std::string& tail : {std::string(), std::string("\n"), std::string(70, 'x')}) {
        std::string bytes = file.bytes + tail;
        bytes.replace(0, head.size(), head);
        MeshNotes notes;
        const TriangleMesh mesh = read(bytes, "solid.stl", &notes);
        EXPECT_TRUE(is_same(corners(mesh), corners(float_sheet())));
        EXPECT_EQ(notes.warnings.size(), tail.empty() ? 1u : 2u);
        if (!tail.empty()) {
          EXPECT_THAT(notes.warnings, testing::Contains(HasSubstr(std::to_string(tail.size()) + " bytes follow")));
        }
      }
  }
}

TEST(ReadTriangleMesh, ReadsSeveralSolidsOfAnStlAsOneMesh) {
  MeshNotes notes;
  const std::string facet = "FACET NORMAL 0 0 1 OUTER LOOP VERTEX 0 0 0 VERTEX 1 0 0 VERTEX ";
  const TriangleMesh mesh = read("SOLID one\n" + facet + "0 1 0 ENDLOOP ENDFACET\nENDSOLID one\n" +  //
                                     "solid two\n" + facet + "-0 -1 0 ENDLOOP ENDFACET\nendsolid\n",
                                 "two.stl", &notes);
  EXPECT_EQ(mesh.num_nodes(), 4);
  EXPECT_EQ(mesh.num_triangles(), 2);
  EXPECT_THAT(notes.numbers.triangle, ElementsAre(1, 2));
  EXPECT_EQ(notes.format, "STL, ASCII");
}

}  // namespace
}  // namespace supple::test
