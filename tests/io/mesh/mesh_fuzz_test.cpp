/// \file Damaged files: whatever a reader meets, it answers with a sound mesh or an InputError, and asks for
/// no more memory than the file can justify.

#include <core/check.hpp>
#include <core/random.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/mesh_reader.hpp>
#include <tests/io/damage.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

/// In every format. \param spec  a built-in mesh.
template <typename Mesh>
std::vector<MeshFile> small_mesh(const char* spec) {
  Mesh mesh = perturbed(std::get<Mesh>(builtin_solid_mesh(spec)), 0.02, 2);
  for (Index e = 0; e < mesh.num_cells(); ++e) mesh.region.push_back(2 * e < mesh.num_cells() ? 1 : 2);
  mesh.region_names = {{1, "left"}, {2, "right"}};
  return in_every_format(mesh);
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
      const SolidMesh any = read_solid_mesh(path, &notes);
      std::visit(
          [&](const auto& mesh) {
            EXPECT_NO_THROW(check_mesh(mesh)) << "file " << k;
            EXPECT_EQ(static_cast<Index>(notes.numbers.node.size()), mesh.num_nodes());
            EXPECT_EQ(static_cast<Index>(notes.numbers.cell.size()), mesh.num_cells());
          },
          any);
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

constexpr auto format_of = [](const auto& test) { return test.param.format; };
INSTANTIATE_TEST_SUITE_P(Mesh, DamagedFile, testing::ValuesIn(small_mesh<TetMesh>("bar:2x1x1")), format_of);
INSTANTIATE_TEST_SUITE_P(HexMesh, DamagedFile, testing::ValuesIn(small_mesh<HexMesh>("hexbox:3x2x2")), format_of);
INSTANTIATE_TEST_SUITE_P(QuadraticTetMesh, DamagedFile,
                         testing::ValuesIn(small_mesh<QuadraticTetMesh>("tet10:bar:2x1x1")), format_of);

}  // namespace
}  // namespace supple::test
