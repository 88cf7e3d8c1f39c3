/// \file Damaged files: whatever a reader meets, it answers with a sound mesh or an InputError, and asks for
/// no more memory than the file can justify.

#include <core/check.hpp>
#include <core/random.hpp>
#include <io/builtin_meshes.hpp>
#include <io/mesh_reader.hpp>
#include <tests/io/damage.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

TetMesh small_mesh() {
  TetMesh mesh = perturbed(builtin_mesh("bar:2x1x1"), 0.05, 2);
  for (Index e = 0; e < mesh.num_tets(); ++e) mesh.region.push_back(1 + static_cast<int>(e) / 6);
  mesh.region_names = {{1, "left"}, {2, "right"}};
  return mesh;
}

class DamagedFile : public testing::TestWithParam<MeshFile> {};

TEST_P(DamagedFile, GivesASoundMeshOrAnInputError) {
  constexpr int num_files = 400;
  const std::filesystem::path folder = test_folder();
  Random random(7);
  int num_refused = 0;
  for (int k = 0; k < num_files; ++k) {
    MeshFile file = GetParam();
    const bool is_ele = file.extension == ".node" && k % 2 == 0;
    std::string& bytes = is_ele ? file.ele_bytes : file.bytes;
    bytes = damaged(std::move(bytes), random);
    const std::filesystem::path path = write(file, folder);
    forget_requests();
    try {
      MeshNotes notes;
      const TetMesh mesh = read_tet_mesh(path, &notes);
      EXPECT_NO_THROW(check_mesh(mesh)) << "file " << k;
      EXPECT_EQ(static_cast<Index>(notes.numbers.node.size()), mesh.num_nodes());
      EXPECT_EQ(static_cast<Index>(notes.numbers.tet.size()), mesh.num_tets());
    } catch (const InputError&) {
      ++num_refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "file " << k << ": " << error.what();
    }
    // Deflated data may unfold a thousandfold, anything else to a number for each byte or two.
    EXPECT_LT(largest_request(), 1100 * (file.bytes.size() + file.ele_bytes.size()) + 100000) << "file " << k;
  }
  EXPECT_GT(num_refused, num_files / 4);  // the damage does damage
  EXPECT_LT(num_refused, num_files);      // and not only at the door
}

INSTANTIATE_TEST_SUITE_P(Mesh, DamagedFile, testing::ValuesIn(in_every_format(small_mesh())),
                         [](const auto& test) { return test.param.format; });

}  // namespace
}  // namespace supple::test
