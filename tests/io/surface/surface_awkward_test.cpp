/// \file Decides for every awkward surface of the collection whether it is read or refused, and with which
/// words; reads its real models.

#include <core/check.hpp>
#include <io/surface/surface_reader.hpp>
#include <physics/model/discrete_shell.hpp>
#include <testing/near.hpp>
#include <tests/support/shared_meshes.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <set>

namespace supple::test {
namespace {

using testing::HasSubstr;

struct Decision {
  std::string file;
  std::vector<std::string> warnings = {};  // of a mesh that is read, in order, by a part of each
  Index num_nodes = 42, num_triangles = 80;
  std::string refusal = "";  // part of the message with which it is refused; empty: it is read
};

void PrintTo(const Decision& decision, std::ostream* out) {
  *out << decision.file;
}

Decision refused(std::string file, std::string message) {
  return {.file = std::move(file), .refusal = std::move(message)};
}

const std::vector<Decision>& decisions() {
  static const std::vector<Decision> table{
      // The same sphere in many formats: each equals surf_reference.off.
      {"surf_reference.off"},
      {"surf_fmt_plain.obj"},
      {"surf_fmt_ascii.ply"},
      {"surf_fmt_le_float.ply"},
      {"surf_fmt_be_double.ply"},
      {"surf_fmt_bin.stl", {"240 corners merged to 42 nodes"}},
      {"surf_fmt_ascii.stl", {"240 corners merged to 42 nodes"}},
      {"surf_fmt_full.obj"},
      {"surf_fmt_extra_props.ply"},
      {"surf_fmt_coff.off"},
      // Shapes.
      {"surf_quads_ngons.obj", {"7 polygons were cut"}, 10, 16},
      {"surf_open_flat.off", {}, 35, 48},
      {"surf_open_cylinder.obj", {}, 36, 48},
      {"surf_folded_180.off", {"1 node lies where another node is"}, 4, 2},
      {"surf_one_triangle.off", {}, 3, 1},
      {"surf_one_flap.off", {}, 4, 2},
      {"surf_disconnected.off", {"2 components"}, 84, 160},
      {"surf_self_intersecting.off", {"2 components"}, 84, 160},
      {"surf_offset1e6_float.ply"},
      {"surf_offset1e6_double.ply"},
      {"surf_tiny1e-6.off"},
      {"surf_needles.off", {"needles: the worst"}},
      // Topology and orientation.
      refused("surf_nonmanifold_edge.off", "at most two triangles can meet at an edge"),
      {"surf_nonmanifold_vertex.off", {"parts hang together by 1 node only"}, 7, 8},
      refused("surf_duplicate_faces.off", "triangle 0 and triangle 80 have the same three nodes"),
      {"surf_inconsistent_orientation.off", {"3 triangles were turned over"}},
      refused("surf_moebius.off", "only one side, like a Möbius strip"),
      {"surf_unreferenced.off", {"2 nodes belong to no triangle"}},
      // Unusable files.
      refused("surf_degenerate.off", "triangle 80 has zero area"),
      refused("surf_repeated_index.off", "triangle 3 names node"),
      refused("surf_nan.off", "node 3 has a coordinate that is not finite"),
      refused("surf_truncated.ply", "announces 3 entries of a list"),
      refused("surf_truncated.off", "the file ends"),
      refused("surf_bad_index.off", "does not exist"),
      refused("mix_surface_only.msh", "looks like a mesh of solids"),
      refused("fmt_legacy_ascii.vtk", "looks like a mesh of solids")};
  return table;
}

class AwkwardSurface : public testing::TestWithParam<Decision> {};

TEST_P(AwkwardSurface, IsReadOrRefusedAsDecided) {
  SKIP_WITHOUT_MESHES();
  const Decision& decision = GetParam();
  MeshNotes notes;
  TriangleMesh mesh;
  try {
    mesh = read_triangle_mesh(meshes() / "awkward" / decision.file, &notes);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(decision.file));
    ASSERT_FALSE(decision.refusal.empty()) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(decision.refusal));
    return;
  }
  ASSERT_EQ(decision.refusal, "") << "the file was read";
  EXPECT_EQ(mesh.num_nodes(), decision.num_nodes);
  EXPECT_EQ(mesh.num_triangles(), decision.num_triangles);
  ASSERT_EQ(notes.warnings.size(), decision.warnings.size()) << testing::PrintToString(notes.warnings);
  for (std::size_t k = 0; k < notes.warnings.size(); ++k)
    EXPECT_THAT(notes.warnings[k], HasSubstr(decision.warnings[k]));
  EXPECT_NO_THROW(check_mesh(mesh));
  if (decision.file.starts_with("surf_fmt_")) {
    const TriangleMesh reference = read_triangle_mesh(meshes() / "awkward" / "surf_reference.off");
    const bool is_stl = decision.file.ends_with(".stl");
    if (!is_stl) {
      EXPECT_EQ(mesh.triangles, reference.triangles);
    }
    for (Index t = 0; t < mesh.num_triangles(); ++t)
      for (int k = 0; k < 3; ++k)  // files of nine digits or 32 bits
        EXPECT_TRUE(
            is_near(mesh.nodes.row(mesh.triangles[t][k]), reference.nodes.row(reference.triangles[t][k]), 1e-7));
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, AwkwardSurface, testing::ValuesIn(decisions()), [](const auto& test) {
  std::string name = test.param.file;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

TEST(AwkwardSurfaces, AreAllDecided) {
  SKIP_WITHOUT_MESHES();
  std::set<std::string> decided;
  for (const Decision& decision : decisions()) decided.insert(decision.file);
  for (const auto& entry : std::filesystem::directory_iterator(meshes() / "awkward"))
    if (const std::string file = entry.path().filename().string(); file.starts_with("surf_")) {
      EXPECT_TRUE(decided.contains(file)) << file;
    }
}

TEST(AwkwardSurfaces, AsShellsAreFiniteAtRestAndNearIt) {
  SKIP_WITHOUT_MESHES();
  for (const Decision& decision : decisions()) {
    if (!decision.refusal.empty() || decision.num_triangles == 1) continue;
    SCOPED_TRACE(decision.file);
    const DiscreteShell shell(read_triangle_mesh(meshes() / "awkward" / decision.file),
                              {.bending = 1, .stretch = 1, .area = 1});
    for (Index i = 0; i < shell.num_components(); ++i) {
      Local<12> u = Local<12>::Zero();
      EXPECT_EQ(shell.energy(i, u) + 1, 1) << i;
      EXPECT_TRUE(shell.force(i, u).allFinite() && shell.stiffness(i, u).allFinite()) << i;
      u = Local<12>::LinSpaced(-1e-8, 1e-8);
      EXPECT_TRUE(shell.force(i, u).allFinite() && shell.stiffness(i, u).allFinite()) << i;
    }
  }
  EXPECT_THROW(DiscreteShell(read_triangle_mesh(meshes() / "awkward" / "surf_one_triangle.off"),
                             ShellMaterial{.bending = 1, .stretch = 1, .area = 1}),
               std::invalid_argument);
}

TEST(ShellMeshes, HaveTheCountsOfTheirDescription) {
  SKIP_WITHOUT_MESHES();
  struct Shell {
    const char* file;
    Index num_nodes, num_triangles, num_flaps, num_boundary_edges;
  };
  for (const Shell& shell : {Shell{"shell/bunny_35k.ply", 34772, 69540, 104310, 0},
                             {"shell/bunny_stanford_raw.ply", 34834, 69451, 104065, 223},
                             {"shell/chinese_dragon_130k.ply", 130000, 259996, 389994, 0},
                             {"shell/dinosaur_56k.ply", 55994, 111984, 167976, 0},
                             {"shell/vw_beetle_20k.off", 19887, 38656, 57416, 1136},
                             {"botsch_sorkine/bar.off", 6084, 12106, 18129, 60},
                             {"botsch_sorkine/cactus.off", 5261, 10518, 15777, 0},
                             {"botsch_sorkine/cylinder.off", 4802, 9600, 14400, 0},
                             {"botsch_sorkine/plane.off", 40401, 80000, 119600, 800}}) {
    SCOPED_TRACE(shell.file);
    MeshNotes notes;
    const TriangleMesh mesh = read_triangle_mesh(meshes() / shell.file, &notes);
    EXPECT_EQ(mesh.num_nodes(), shell.num_nodes);
    EXPECT_EQ(mesh.num_triangles(), shell.num_triangles);
    EXPECT_EQ(static_cast<Index>(interior_edges(mesh).size()), shell.num_flaps);
    EXPECT_EQ(static_cast<Index>(boundary_edges(mesh).size()), shell.num_boundary_edges);
    EXPECT_EQ(connected_components(mesh).count, 1);
  }
}

}  // namespace
}  // namespace supple::test
