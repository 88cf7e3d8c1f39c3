/// \file Decides for every awkward solid mesh of the collection whether it is read or refused, and with which
/// words.

#include <core/check.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <physics/mesh/tet_mesh.hpp>
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
using testing::IsEmpty;

struct Decision {
  std::string file;
  std::vector<std::string> warnings;  // of a mesh that is read, in order, by a part of each
  std::string refusal = "";           // part of the message with which it is refused; empty: it is read
  double volume = 1;
  Index num_nodes = 27, num_tets = 48;
};

void PrintTo(const Decision& decision, std::ostream* out) {
  *out << decision.file;
}

Decision read(std::string file) {
  return {std::move(file), {}};
}
Decision read(std::string file, std::vector<std::string> warnings, double volume = 1, Index num_nodes = 27,
              Index num_tets = 48) {
  return {std::move(file), std::move(warnings), "", volume, num_nodes, num_tets};
}
Decision refused(std::string file, std::string message) {
  return {std::move(file), {}, std::move(message)};
}

const std::vector<Decision>& decisions() {
  static const std::vector<Decision> table{
      // The same mesh in many formats: each equals fmt_22_ascii.msh.
      read("fmt_22_ascii.msh"), read("fmt_22_bin.msh"), read("fmt_22_bin_bigendian.msh"), read("fmt_41_ascii.msh"),
      read("fmt_41_bin.msh"), read("fmt_41_bin_blocks.msh"), read("fmt_sparse_tags.msh"),
      read("fmt_sparse_tags_41.msh"), read("fmt_physical_groups.msh"), read("fmt_medit.mesh"),
      read("fmt_medit_triangles_first.mesh"), read("fmt_medit_crlf.mesh"), read("fmt_medit_onetoken.mesh"),
      read("fmt_22_crlf.msh"), read("fmt_22_comments.msh"), read("fmt_1based"), read("fmt_0based"),
      read("fmt_tetgen_attrs"), read("fmt_vega.veg"), read("fmt_legacy_ascii.vtk"), read("fmt_legacy_bin.vtk"),
      read("fmt_ascii.vtu"), read("fmt_base64.vtu"), read("fmt_zlib.vtu"), read("fmt_appended.vtu"),
      read("fmt_appended_zlib.vtu"),
      // Scale, place and shape: nothing is judged by absolute sizes.
      read("scale_offset1e6.msh"), read("scale_tiny1e-6.msh", {}, 1e-18), read("scale_huge1e6.msh", {}, 1e18),
      read("scale_anisotropic.msh", {"nearly flat tets"}, 10), read("scale_rotated.msh"),
      read("one_tet.msh", {}, 1.0 / 6, 4, 1),
      // Orientation and quality. A reversed tet is only written in another order; a tangled mesh stays inside
      // out in
      // whatever order, which shows at faces with both tets on one side.
      read("tet_slivers.msh", {"nearly flat tets"}), read("tet_some_reversed.msh", {"3 tets are reversed"}),
      read("tet_all_reversed.mesh", {"48 tets are reversed"}),
      refused("tet_inverted_geometry.msh", "so the mesh is tangled"),
      refused("tet_zero_volume.mesh", "tet 7 has zero volume"),
      refused("tet_repeated_index", "tet 6 names node 2 twice"),
      refused("tet_duplicate_element.msh", "tet 5 and tet 50 have the same nodes"),
      // Topology: what hangs together loosely can be simulated, but may surprise.
      read("topo_duplicate_vertices.msh", {"9 nodes lie where another node is", "2 components"}, 2, 54, 96),
      read("topo_disconnected.mesh", {"2 components"}, 2, 54, 96),
      read("topo_pinched_vertex.msh", {"0 edges and 1 node only"}, 2, 15, 12),
      read("topo_pinched_edge.msh", {"1 edge and 0 nodes only"}, 2, 14, 12),
      refused("topo_face_shared_by_3.msh", "tet 1 and tet 2 overlap"),
      read("topo_unreferenced.msh", {"5 nodes belong to no tet"}),
      read("topo_unreferenced_nan.msh", {"5 nodes belong to no tet"}),
      // Unusable files.
      refused("bad_mixed_base", "bad_mixed_base.ele:2: node 0 does not exist: nodes are numbered 1 … 27"),
      refused("bad_nan.msh", "node 5 has a coordinate that is not finite"),
      refused("bad_inf.mesh", "node 3 has a coordinate that is not finite"),
      refused("bad_index_range.msh", "bad_index_range.msh:83: node 31 does not exist"),
      refused("bad_negative_index", "bad_negative_index.ele:4: node -2 does not exist"),
      refused("bad_truncated_ascii.msh", ":72: expected the number of tags, the file ends"),
      refused("bad_truncated_nodes.msh", ":28: expected a coordinate, the file ends"),
      refused("bad_text_number.msh", ":12: expected a coordinate, found \"0.5x\""),
      refused("bad_count_too_big.msh", ":33: expected a node number, found \"$EndNodes\""),
      refused("bad_count_huge.msh", ":35: announces 4000000000 elements"),
      refused("bad_truncated_bin.msh", "byte 1538: the file ends inside"),
      refused("bad_truncated_bin41.msh", "byte 219: announces 27 nodes"),
      refused("bad_count_huge_bin41.msh", "byte 183: announces 4611686018427387904 nodes"),
      refused("bad_version.msh", ":2: expected Gmsh format version 2.2, 4.0 or 4.1, found 9.9"),
      refused("bad_empty.msh", "the file is empty"), refused("bad_zero_nodes.msh", "holds no tetrahedra"),
      refused("bad_wrong_extension.msh", "triangle surface (OFF)"), refused("bad_base64.vtu", "well-formed XML"),
      refused("bad_medit_2d.mesh", ":2: expected Dimension 3, found 2"),
      // Other elements: solids are never dropped silently.
      refused("mix_tet_hex.msh", "holds 2 hexahedra and 6 tets"), refused("mix_hex_only.msh", "holds 2 hexahedra;"),
      refused("mix_surface_only.msh", "holds no tetrahedra but 48 cells of lower dimension"),
      read("mix_tet10.msh", {"48 tets are of higher order", "98 nodes belong to no tet"})};
  return table;
}

class AwkwardMesh : public testing::TestWithParam<Decision> {};

TEST_P(AwkwardMesh, IsReadOrRefusedAsDecided) {
  SKIP_WITHOUT_MESHES();
  const Decision& decision = GetParam();
  const std::filesystem::path path = meshes() / "awkward" / decision.file;
  MeshNotes notes;
  TetMesh mesh;
  try {
    mesh = read_tet_mesh(path, &notes);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr(decision.file));
    ASSERT_FALSE(decision.refusal.empty()) << error.what();
    EXPECT_THAT(error.what(), HasSubstr(decision.refusal));
    return;
  }
  ASSERT_EQ(decision.refusal, "") << "the file was read";
  EXPECT_EQ(mesh.num_nodes(), decision.num_nodes);
  EXPECT_EQ(mesh.num_cells(), decision.num_tets);
  double volume = 0;
  for (Index e = 0; e < mesh.num_cells(); ++e) volume += tet_volume(mesh, e);
  EXPECT_NEAR(volume, decision.volume, 1e-13 * decision.volume);  // 48 terms of rounding 1e-16
  ASSERT_EQ(notes.warnings.size(), decision.warnings.size()) << testing::PrintToString(notes.warnings);
  for (std::size_t k = 0; k < notes.warnings.size(); ++k)
    EXPECT_THAT(notes.warnings[k], HasSubstr(decision.warnings[k]));
  EXPECT_NO_THROW(check_mesh(mesh));
  if (decision.file.starts_with("fmt_")) {
    const TetMesh reference = read_tet_mesh(meshes() / "awkward" / "fmt_22_ascii.msh");
    EXPECT_TRUE(is_same(mesh.nodes, reference.nodes));
    EXPECT_EQ(mesh.cells, reference.cells);
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, AwkwardMesh, testing::ValuesIn(decisions()), [](const auto& test) {
  std::string name = test.param.file;
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
});

TEST(AwkwardMeshes, AreAllDecided) {
  SKIP_WITHOUT_MESHES();
  std::set<std::string> decided;
  for (const Decision& decision : decisions()) decided.insert(decision.file);
  for (const auto& entry : std::filesystem::directory_iterator(meshes() / "awkward")) {
    const std::filesystem::path file = entry.path().filename();
    if (file == "INDEX.md" || file.string().starts_with("surf_")) continue;
    const bool is_tetgen = file.extension() == ".node" || file.extension() == ".ele";
    EXPECT_TRUE(decided.contains(is_tetgen ? file.stem().string() : file.string())) << file;
  }
}

TEST(AwkwardMeshes, PhysicalGroupsBecomeNamedRegions) {
  SKIP_WITHOUT_MESHES();
  const TetMesh mesh = read_tet_mesh(meshes() / "awkward" / "fmt_physical_groups.msh");
  EXPECT_EQ(std::count(mesh.region.begin(), mesh.region.end(), 2), 24);
  EXPECT_EQ(std::count(mesh.region.begin(), mesh.region.end(), 3), 24);
  EXPECT_EQ(mesh.region_names, (std::map<int, std::string>{{2, "soft"}, {3, "stiff part"}}));
}

TEST(SolidMeshes, HaveTheCountsOfTheirDescription) {
  SKIP_WITHOUT_MESHES();
  struct Solid {
    const char* file;
    Index num_nodes, num_tets, num_faces;
    double least_radius_ratio;
  };
  for (const Solid& solid : {Solid{"dragon_92k.msh", 23524, 91877, 32612, 0.00908},
                             {"vertebra_L3_71k.msh", 14916, 70674, 13528, 0.263},
                             {"aneurysm_36k.msh", 8561, 35934, 10198, 0.285},
                             {"aneurysm_36k.vtu", 8561, 35934, 10198, 0.285},
                             {"menger4_L2_6k.msh", 2720, 6144, 5952, 0.717},
                             {"turtle_1k.veg", 347, 1185, 530, 0.164},
                             {"dromedary_37k.msh", 9046, 36716, 10312, 0.121},
                             {"ipc_bar_2523.msh", 886, 2523, 1618, 0.0532}}) {
    SCOPED_TRACE(solid.file);
    MeshNotes notes;
    const TetMesh mesh = read_tet_mesh(meshes() / "solid" / solid.file, &notes);
    EXPECT_EQ(mesh.num_nodes(), solid.num_nodes);
    EXPECT_EQ(mesh.num_cells(), solid.num_tets);
    EXPECT_EQ(static_cast<Index>(boundary_faces(mesh).size()), solid.num_faces);
    double least = 1;
    for (Index e = 0; e < mesh.num_cells(); ++e) least = std::min(least, radius_ratio(mesh, e));
    EXPECT_NEAR(least, solid.least_radius_ratio, 0.005 * solid.least_radius_ratio);  // three digits are given
    const bool is_dromedary = std::string_view(solid.file).starts_with("dromedary");
    EXPECT_EQ(boundary_hinges(mesh).edges, is_dromedary ? 1 : 0);
    EXPECT_EQ(boundary_hinges(mesh).nodes, 0);
  }
}

}  // namespace
}  // namespace supple::test
